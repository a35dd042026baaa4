"""Teach a trained fighter to aim as ``commando`` does, and leave alone where it walks.

    python -m benchmarks.learning.aiming out/commando-again --out out/commando-aims

The policy plays battles of the suite ``wild``, three copies in each. At every step, a marksman, who follows
the rules of ``wildscav.skills.aiming``, says how to turn and look, whether to shoot and whether to reload. A
second network beside the first learns from all that was said so far, and the next battles are played with
both. This is DAgger (Ross, Gordon and Bagnell 2011). Whatever else the first network decides stays as it
is. Afterwards,

    python -m benchmarks.strength.supplies_and_fights --track battle --where wild out/commando-aims hunter

measures it beside another.
"""

import json
import shutil
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import torch
import typer
from benchmarks.learning.imitation import Steps, agreement, joined, learn
from benchmarks.strength.supplies_and_fights import matches_of
from numpy.typing import NDArray
from rich.progress import track as progress
from torch import Tensor, nn

from wildscav import Action, Agent, MatchInfo, Observation, VisibleAgent
from wildscav.policy import PolicyAgent
from wildscav.skills.aiming import aim_at, enemies_in_sight, look_around, velocity_of, will_hit
from wildscav.skills.fighting import wants_reload
from wildscav_engine.maps.cache import map_of
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_training.opponents.submission import SubmissionOpponent

FIRST_SEED = 10_000  # of the rounds that are learned from; others are measured
WALKS, AIMS = ("directions", "speeds"), ("turns", "looks")  # dimensions of the action space, in this order
SAID = ("shoot", "reload")  # flags that the marksman decides


@dataclass(frozen=True)
class Lessons:
    """How it learns to aim."""

    rounds: int = 4  # of playing and learning
    matches: int = 80  # in each round
    copies: int = 3  # of the policy in a match
    peace: float = 0.25  # share of the steps without an enemy in sight that is learned from
    epochs: int = 6  # passes over all steps in each round; in the last, twice as many
    minibatch: int = 512
    learning_rate: float = 1e-3  # of Adam; it falls to 0 in a straight line in each round
    width: int = 192  # of both layers of the second network
    seed: int = 0


class Pupil(Agent):
    """Lets a policy's agent play, and notes what a marksman would have done in its place."""

    def __init__(self, agent: PolicyAgent, description: Mapping[str, Any], noted: list[Any]) -> None:
        self.agent, self.noted = agent, noted
        self.turns, self.looks = (np.array(description["actions"][name]) for name in AIMS)
        self.seen: NDArray[np.float32] | None = None
        self.network = agent.policy.network
        agent.policy.network = self._shown

    def _shown(self, observation: Any) -> NDArray[Any]:
        self.seen = observation
        return self.network(observation)

    def reset(self, match: MatchInfo) -> None:
        """Begin a match."""
        self.match = match
        self.agent.reset(match)

    def act(self, observation: Observation) -> Action:
        """Return what the policy does."""
        action = self.agent.act(observation)
        if observation.alive:
            enemies = enemies_in_sight(observation, self.match.team)
            self.noted.append((self.seen, self.said(observation, enemies, action), bool(enemies)))
        return action

    def said(
        self, observation: Observation, enemies: Sequence[VisibleAgent], action: Action
    ) -> tuple[int, int, bool, bool]:
        """Return the numbers of the turn and of the look, and whether to shoot and to reload."""
        frames = self.match.frames_per_action
        reload = wants_reload(observation, self.match.clip_size, bool(enemies))
        velocity = velocity_of(action.walk_direction, action.walk_speed)
        aim = look_around(observation, frames)
        if enemies:
            aim = aim_at(observation, enemies[0], velocity, frames)
        turn, look = int(abs(self.turns - aim.turn).argmin()), int(abs(self.looks - aim.look).argmin())
        shoot = bool(enemies) and will_hit(
            observation, enemies[0], velocity, frames, float(self.turns[turn]), float(self.looks[look])
        )
        return turn, look, shoot, reload


class Pupils(SubmissionOpponent):
    """Plays a submission with a trained policy, and notes what a marksman would do."""

    def __init__(self, folder: Path) -> None:
        self.noted: list[Any] = []
        self.description = json.loads((folder / "policy.json").read_text("utf-8"))["environment"]
        super().__init__(folder)

    def _load(self, manifest: Mapping[str, Any]) -> Callable[[], Agent]:
        make = super()._load(manifest)

        def pupil() -> Agent:
            agent = make()
            if not isinstance(agent, PolicyAgent):
                raise TypeError(f"{self.folder} does not play a policy")
            return Pupil(agent, self.description, self.noted)

        return pupil


def play(folder: Path, spec: MatchSpec, lessons: Lessons) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
    """Let copies of a policy play one match, and return what they saw and what the marksman said."""
    fighters = [seat for seat, name in enumerate(spec.seats) if name == "fighter"]
    seats = np.array([spec.seats.index(SUBMISSION), *fighters[: lessons.copies - 1]])
    names = [SUBMISSION if seat in seats else name for seat, name in enumerate(spec.seats)]
    spec = spec.model_copy(update={"seats": tuple(names)})
    batch, pupils, match = Batch([spec], [map_of(spec.map)]), Pupils(folder), np.zeros(len(seats), np.int64)
    pupils.begin(batch, match, seats)
    actions = no_actions(len(spec.seats))[None]
    while not batch.state.matches.over[0]:
        actions[0, seats] = pupils.act(batch, match, seats)
        batch.step(actions)
    random = np.random.default_rng(spec.seed)
    kept = [one for one in pupils.noted if one[2] or random.random() < lessons.peace]
    seen, done = (np.array([one[place] for one in kept]) for place in (0, 1))
    return seen.astype(np.float32), done.astype(np.int64)


def play_round(folder: Path, number: int, lessons: Lessons) -> Steps:
    """Let a policy play the matches of a round, in one process per core."""
    specs = matches_of("battle", "wild", lessons.matches, FIRST_SEED + number * lessons.matches)
    with ProcessPoolExecutor(mp_context=get_context("spawn")) as pool:
        waiting = [pool.submit(play, folder, spec, lessons) for spec in specs]
        played = [one.result() for one in progress(waiting, f"round {number + 1}: playing")]
    return joined([Steps(*map(torch.from_numpy, columns)) for columns in played])


class Marksman(nn.Module):
    """A second network beside that of a policy, whose layers it also sees, and which it does not change."""

    def __init__(self, first: Mapping[str, NDArray[np.float32]], width: int, choices: int) -> None:
        super().__init__()
        names = ("weight_0", "bias_0", "weight_1", "bias_1")
        self.first = [torch.tensor(first[name]) for name in names]
        outputs, inputs = self.first[0].shape
        self.layers = nn.ModuleList(
            (nn.Linear(inputs, width), nn.Linear(outputs + width, width), nn.Linear(outputs + width, choices))
        )

    def forward(self, seen: Tensor) -> Tensor:
        """Return (N, choices) the scores for (N, n) observations."""
        weight_0, bias_0, weight_1, bias_1 = self.first
        theirs = torch.tanh(seen @ weight_0.T + bias_0)
        own = torch.tanh(self.layers[0](seen))
        both = torch.cat((theirs, own), dim=1)
        theirs, own = torch.tanh(theirs @ weight_1.T + bias_1), torch.tanh(self.layers[1](both))
        return self.layers[2](torch.cat((theirs, own), dim=1))  # type: ignore[no-any-return]


def one_network(
    first: Mapping[str, NDArray[np.float32]], marksman: Marksman, rows: Sequence[int]
) -> dict[str, NDArray[np.float32]]:
    """Return both networks as one; the second one's outputs replace these rows of the first one's."""
    weights = [layer.weight.detach().numpy() for layer in marksman.layers]
    biases = [layer.bias.detach().numpy() for layer in marksman.layers]
    own = len(biases[0])
    blank = np.zeros((len(first["weight_1"]), own), np.float32)
    last = np.hstack((first["weight_2"], np.zeros((len(first["weight_2"]), own), np.float32)))
    bias = first["bias_2"].copy()
    last[rows], bias[rows] = weights[2], biases[2]
    return {
        "weight_0": np.vstack((first["weight_0"], weights[0])),
        "weight_1": np.vstack((np.hstack((first["weight_1"], blank)), weights[1])),
        "weight_2": last,
        "bias_0": np.concatenate((first["bias_0"], biases[0])),
        "bias_1": np.concatenate((first["bias_1"], biases[1])),
        "bias_2": bias,
    }


def outputs_of(actions: Mapping[str, Any]) -> tuple[list[int], list[int]]:
    """Return the number of choices in each dimension that the marksman decides, and their outputs."""
    sizes = {name: len(actions[name]) for name in (*WALKS, *AIMS)} | dict.fromkeys(actions["flags"], 2)
    starts = dict(zip(sizes, np.cumsum([0, *sizes.values()]).tolist(), strict=False))
    decided = (*AIMS, *SAID)
    outputs = [starts[name] + choice for name in decided for choice in range(sizes[name])]
    return [sizes[name] for name in decided], outputs


def write_deterministic(path: Path) -> None:
    """Let a policy always take its likeliest action."""
    described = json.loads(path.read_text("utf-8"))
    path.write_text(json.dumps({**described, "choose": "deterministic"}, indent=1) + "\n", "utf-8")


def main(
    policy: Annotated[Path, typer.Argument(help="The folder of a submission that `wildscav train` wrote.")],
    out: Annotated[Path, typer.Option(help="Folder to create: the submission that aims.")],
    rounds: Annotated[int, typer.Option(help="Of playing and learning.", min=1)] = Lessons.rounds,
    matches: Annotated[int, typer.Option(help="In each round.", min=1)] = Lessons.matches,
) -> None:
    """Teach it, and write the submission."""
    if out.exists():
        raise typer.BadParameter(f"{out} exists already", param_hint="--out")
    if missing := [name for name in ("network.npz", "policy.json") if not (policy / name).is_file()]:
        raise typer.BadParameter(f"{policy / missing[0]} is missing", param_hint="POLICY")
    torch.set_num_threads(1)
    lessons = Lessons(rounds=rounds, matches=matches)
    torch.manual_seed(lessons.seed)
    with np.load(policy / "network.npz") as arrays:
        first = dict(arrays)
    description = json.loads((policy / "policy.json").read_text("utf-8"))["environment"]
    sizes, rows = outputs_of(description["actions"])
    marksman = Marksman(first, lessons.width, sum(sizes))
    shutil.copytree(policy, out)
    write_deterministic(out / "policy.json")
    began, heard = time.monotonic(), []
    for number in range(lessons.rounds):
        said = play_round(out, number, lessons)
        found = agreement(marksman, said, sizes)
        heard.append(said)
        epochs = lessons.epochs * (2 if number == lessons.rounds - 1 else 1)
        rates = {"minibatch": lessons.minibatch, "learning_rate": lessons.learning_rate}
        learn(marksman, joined(heard), sizes, epochs=epochs, **rates)
        np.savez(out / "network.npz", **one_network(first, marksman, rows))
        sys.stdout.write(f"round {number + 1}: {len(said.seen):,} steps, agreement before {found}\n")
        sys.stdout.flush()
    about = {"lessons": asdict(lessons), "agreement": found, "seconds": round(time.monotonic() - began)}
    sys.stdout.write(json.dumps(about) + "\n")


if __name__ == "__main__":
    typer.run(main)
