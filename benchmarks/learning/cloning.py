"""A clone of the baseline ``mapper``: a small network that does what it did in 1,000 matches.

    python -m benchmarks.learning.cloning --out out/cloned-navigator

plays the matches on maps of the level hard as ``wildscav dataset`` does, unless that data set is there
already, trains the network on nine episodes in ten, says how well it foretells what ``mapper`` does in the
others, and writes it as a submission. Minari keeps its data sets in ``MINARI_DATASETS_PATH``. Afterwards,

    wildscav baselines homing mapper out/cloned-navigator --level hard

measures it beside others.
"""

import json
import sys
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from itertools import pairwise
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any

import minari
import numpy as np
import torch
import typer
from benchmarks.learning.imitation import Steps, agreement, joined, learn
from torch import nn

from wildscav.cli.init import write_files
from wildscav.policy.networks import Choose
from wildscav_training.cli.dataset import dataset
from wildscav_training.export import policy_tables, read_model, submission_files

AGENT, TRACK, MATCHES, DATA = "mapper", "navigation", 1000, "navigation/mapper-hard-v0"
SEEN: dict[str, Any] = {
    "flat": True,
    "action_mode": "multidiscrete",
    "sensors": {"depth": {"width": 10, "height": 10}, "lidar": {"channels": 2, "azimuths": 32}},
}
OPTIONS: dict[str, Any] = {"level": "hard", "random_maps": 200, "time_limit": 120, **SEEN}


@dataclass(frozen=True)
class Cloning:
    """How the network learns."""

    epochs: int = 20  # passes over the steps
    minibatch: int = 256
    learning_rate: float = 1e-3  # of Adam; it falls to 0 in a straight line
    layers: tuple[int, ...] = (128, 128)  # width of each
    held_out: int = 10  # one episode in so many is not learned from
    seed: int = 0


def played() -> tuple[list[Steps], list[int]]:
    """Return the steps of each match, and the number of choices in each dimension (D,)."""
    if DATA not in minari.list_local_datasets():
        options = [f"{name}={json.dumps(value)}" for name, value in OPTIONS.items()]
        dataset(DATA, agent=AGENT, track=TRACK, matches=MATCHES, option=options)
    data = minari.load_dataset(DATA)
    sizes: list[int] = data.action_space.nvec.tolist()  # type: ignore[attr-defined]
    episodes = [
        Steps(torch.tensor(episode.observations[:-1]), torch.tensor(episode.actions))
        for episode in data.iterate_episodes()
    ]
    return episodes, sizes


def network_of(inputs: int, layers: Sequence[int], choices: int) -> nn.Sequential:
    """Return a network that knows nothing."""
    widths = (inputs, *layers)
    hidden = [part for before, after in pairwise(widths) for part in (nn.Linear(before, after), nn.Tanh())]
    return nn.Sequential(*hidden, nn.Linear(widths[-1], choices))


def cloned(steps: Steps, sizes: Sequence[int], cloning: Cloning) -> nn.Sequential:
    """Return a network that has learned what was done in the steps."""
    torch.manual_seed(cloning.seed)
    network = network_of(steps.seen.shape[1], cloning.layers, sum(sizes))
    rates = {"minibatch": cloning.minibatch, "learning_rate": cloning.learning_rate}
    learn(network, steps, sizes, epochs=cloning.epochs, **rates)
    return network


def files_of(network: nn.Sequential, name: str, choose: Choose) -> dict[str, bytes]:
    """Return the files of a submission that plays the network, by name."""
    linear = [layer for layer in network if isinstance(layer, nn.Linear)]
    arrays = {f"weight_{place}": layer.weight.detach().numpy() for place, layer in enumerate(linear)}
    arrays |= {f"bias_{place}": layer.bias.detach().numpy() for place, layer in enumerate(linear)}
    with TemporaryDirectory() as folder:
        path = Path(folder) / "policy.npz"
        np.savez(path, **arrays)
        trained = read_model(path)
    return submission_files(trained, policy_tables(trained, TRACK, {**SEEN, "version": 1}), name, choose)


def main(
    out: Annotated[Path, typer.Option(help="Folder to create: the submission.")],
    choose: Annotated[Choose, typer.Option(help="How it selects actions.")] = Choose.SAMPLED,
    epochs: Annotated[int, typer.Option(help="Passes over the steps.", min=1)] = Cloning.epochs,
    seed: Annotated[int, typer.Option(help="Seed of the network and of the order of steps.")] = 0,
) -> None:
    """Clone the agent, and write the submission."""
    torch.set_num_threads(1)
    cloning = Cloning(epochs=epochs, seed=seed)
    episodes, sizes = played()
    known = [one for place, one in enumerate(episodes) if place % cloning.held_out]
    began = time.process_time()
    network = cloned(joined(known), sizes, cloning)
    about = {
        "agent": AGENT,
        "track": TRACK,
        "options": OPTIONS,
        "matches": len(episodes),
        "steps": sum(len(one.seen) for one in episodes),
        "cloning": asdict(cloning),
        "agreement": agreement(network, joined(episodes[:: cloning.held_out]), sizes),
    }
    sys.stdout.write(f"{time.process_time() - began:.0f} CPU s, {json.dumps(about)}\n")
    content = files_of(network, out.resolve().name, choose)
    write_files(out, {**content, "training.json": (json.dumps(about, indent=1) + "\n").encode()})


if __name__ == "__main__":
    typer.run(main)
