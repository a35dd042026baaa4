"""PPO of RLlib for one learner. It reports no return before the first episode has ended."""

from ray.rllib.algorithms.ppo import PPOConfig

options = {"level": "easy", "flat": True, "action_mode": "multidiscrete", "time_limit": 30.0}
config = (
    PPOConfig()
    .environment("wildscav_engine:WildScav/Navigation-v1", env_config=options)
    .env_runners(num_env_runners=0, num_envs_per_env_runner=16, gym_env_vectorize_mode="vector_entry_point")
    .training(train_batch_size_per_learner=4800, minibatch_size=512, num_epochs=5, lr=3e-4)
)
algorithm = config.build_algo()
for _ in range(250):
    print(algorithm.train()["env_runners"].get("episode_return_mean"))
