"""PPO of RLlib for a team of four learners with one policy. The batch size counts the steps of all four."""

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.env.wrappers.pettingzoo_env import ParallelPettingZooEnv
from ray.tune.registry import register_env

from wildscav_engine.envs import parallel_env

register_env("gathering", lambda options: ParallelPettingZooEnv(parallel_env("gathering", **options)))
options = {"agents": 4, "teams": (0, 0, 0, 0), "level": "easy", "flat": True, "time_limit": 30.0}
options |= {"action_mode": "multidiscrete"}
config = (
    PPOConfig()
    .environment("gathering", env_config=options)
    .multi_agent(policies={"everybody"}, policy_mapping_fn=lambda *_, **__: "everybody")
    .env_runners(num_env_runners=0)
    .training(train_batch_size_per_learner=600, minibatch_size=400, num_epochs=4, lr=3e-4)
)
algorithm = config.build_algo()
for _ in range(250):
    print(algorithm.train()["env_runners"].get("episode_return_mean"))
