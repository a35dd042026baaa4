"""Behaviour cloning: a policy learns what the agent of a data set does.

The data set is the first one of ``docs/datasets.md``, which also makes a submission of the policy.
"""

import minari
import numpy as np
import torch
from torch import nn

data = minari.load_dataset("navigation/mapper-v0")
episodes = list(data.iterate_episodes())
seen = torch.tensor(np.concatenate([episode.observations[:-1] for episode in episodes]))
done = torch.tensor(np.concatenate([episode.actions for episode in episodes]))
sizes = data.action_space.nvec.tolist()

torch.manual_seed(0)
torch.set_num_threads(1)
layers = [nn.Linear(seen.shape[1], 64), nn.Tanh(), nn.Linear(64, 64), nn.Tanh(), nn.Linear(64, sum(sizes))]
network = nn.Sequential(*layers)
adam = torch.optim.Adam(network.parameters(), lr=1e-3)
for epoch in range(20):
    losses = []
    for rows in torch.randperm(len(seen)).split(256):
        scores = network(seen[rows]).split(sizes, dim=1)
        parts = [nn.functional.cross_entropy(part, done[rows, place]) for place, part in enumerate(scores)]
        loss = torch.stack(parts).sum()
        adam.zero_grad()
        loss.backward()
        adam.step()
        losses.append(loss.item())
    print(epoch, len(seen), np.mean(losses))

linear = [layer for layer in layers if isinstance(layer, nn.Linear)]
arrays = {f"weight_{n}": layer.weight.detach().numpy() for n, layer in enumerate(linear)}
arrays |= {f"bias_{n}": layer.bias.detach().numpy() for n, layer in enumerate(linear)}
np.savez("clone.npz", **arrays)
