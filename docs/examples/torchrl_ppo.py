"""PPO of TorchRL for one learner."""

import torch
from tensordict.nn import TensorDictModule
from torchrl.collectors import Collector
from torchrl.envs import GymEnv
from torchrl.modules import MLP, OneHotCategorical, ProbabilisticActor, ValueOperator
from torchrl.objectives import ClipPPOLoss
from torchrl.objectives.value import GAE

env = GymEnv("wildscav_engine:WildScav/Navigation-v1", level="easy", flat=True, action_mode="baseline")
scores = TensorDictModule(MLP(env.observation_spec["observation"].shape[-1], 8), ["observation"], ["logits"])
actor = ProbabilisticActor(scores, ["logits"], distribution_class=OneHotCategorical, return_log_prob=True)
critic = ValueOperator(MLP(env.observation_spec["observation"].shape[-1], 1), in_keys=["observation"])
advantage, loss = GAE(gamma=0.99, lmbda=0.95, value_network=critic), ClipPPOLoss(actor, critic)
adam = torch.optim.Adam(loss.parameters(), lr=3e-4)
for batch in Collector(env, actor, frames_per_batch=2048, total_frames=1_000_000):
    for _ in range(10):
        sum(value for name, value in loss(advantage(batch)).items() if name.startswith("loss_")).backward()
        adam.step(), adam.zero_grad()
    print(batch["next", "reward"].sum().item())
