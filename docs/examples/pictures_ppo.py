"""PPO of Stable-Baselines3 on colour pictures: a convolutional network sees the last two.

``wildscav init seeing-agent --from-policy seeing.zip --track navigation`` with
``--option 'sensors={"camera": {"width": 64, "height": 36}}'`` makes a submission, which runs on ONNX Runtime.
"""

from stable_baselines3 import PPO
from stable_baselines3.common.vec_env import VecFrameStack, VecMonitor

from wildscav_engine.envs import StableVector

sensors = {"camera": {"width": 64, "height": 36}}
rewards = {"target_reached": 1.0, "approach": 0.01}
options = {
    "level": "easy",
    "sensors": sensors,
    "action_mode": "multidiscrete",
    "rewards": rewards,
}
envs = VecMonitor(VecFrameStack(StableVector("navigation", 16, **options), 2))
model = PPO("MultiInputPolicy", envs, n_steps=256, batch_size=512, device="cpu", seed=0)
model.learn(1_000_000)
model.save("seeing")
