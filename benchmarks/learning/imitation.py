"""Learning to do what somebody did."""

from collections.abc import Sequence
from typing import NamedTuple

import torch
from rich.progress import track
from torch import Tensor, nn


class Steps(NamedTuple):
    """Steps of an agent: what it saw, and what it did or was told to do."""

    seen: Tensor  # (N, n)
    done: Tensor  # (N, D) the number of the choice in each dimension


def joined(parts: Sequence[Steps]) -> Steps:
    """Return the steps of all parts."""
    return Steps(*(torch.cat(column) for column in zip(*parts, strict=True)))


def learn(
    network: nn.Module,
    steps: Steps,
    sizes: Sequence[int],
    *,
    epochs: int,
    minibatch: int,
    learning_rate: float,
) -> None:
    """Learn what was done, by Adam with a rate that falls to 0 in a straight line.

    The loss is the negative logarithm of the probability of the actions, which are independent of each other.
    """
    adam = torch.optim.Adam(network.parameters())
    for epoch in track(range(epochs), "learning"):
        for group in adam.param_groups:
            group["lr"] = learning_rate * (1.0 - epoch / epochs)
        for place in torch.randperm(len(steps.seen)).split(minibatch):
            parts = network(steps.seen[place]).split(list(sizes), dim=1)
            losses = [
                nn.functional.cross_entropy(part, steps.done[place, index])
                for index, part in enumerate(parts)
            ]
            adam.zero_grad()
            torch.stack(losses).sum().backward()
            adam.step()


@torch.no_grad()
def agreement(network: nn.Module, steps: Steps, sizes: Sequence[int]) -> list[float]:
    """Return the share of steps in which the likeliest choice is what was done, for each dimension."""
    parts = network(steps.seen).split(list(sizes), dim=1)
    likeliest = torch.stack([part.argmax(dim=1) for part in parts], dim=1)
    return [round(share, 4) for share in (likeliest == steps.done).float().mean(dim=0).tolist()]
