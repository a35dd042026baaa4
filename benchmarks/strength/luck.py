"""Where the luck of a suite's matches comes from, and how many of them tell two entrants apart.

    python -m benchmarks.strength.luck --suite fair

lets robots play in the submission's seat: on each map in several worlds (boxes, starts and dice, which the
match's seed gives), in each world from several seats, and from each seat against the same opponents in other
seats. A nested analysis of variance gives the share of each; what the order of the opponents changes is
chance. Pairs of entrants play the same matches, so that differences are paired.
"""

import itertools
import math
from collections.abc import Callable, Sequence
from typing import Annotated, NamedTuple

import numpy as np
import typer
from numpy.typing import NDArray
from rich.progress import track as progress

from wildscav_engine.maps.cache import map_of
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.suites.suite import suite
from wildscav_training.trials import SURE

MAPS, WORLDS, SEATS, ORDERS = 10, 2, 4, 2
SHARES = ("map", "world", "seat", "chance")
TOGETHER = 20  # matches in a batch
POWER = 0.84  # standard errors beyond those of a 95 % interval: 80 % of the differences are found
KILL = 20  # supplies that a kill counts as much as, in points


class Outcome(NamedTuple):
    """What the submission's seat reached in a match."""

    supplies: float
    kills: float
    picked_up: float
    better_than: float  # other seats by supplies, a draw as half of one

    @property
    def points(self) -> float:
        """Supplies, and each kill as some of them."""
        return self.supplies + KILL * self.kills


METRICS: dict[str, Callable[[Outcome], float]] = {
    "supplies at the end": lambda one: one.supplies,
    "supplies picked up": lambda one: one.picked_up,
    "place by supplies": lambda one: one.better_than,
    "kills": lambda one: one.kills,
    f"supplies + {KILL} × kills": lambda one: one.points,
}


def specs_of(name: str, track: str, seed: int) -> list[MatchSpec]:
    """Return matches of a suite with the submission in other seats and its opponents in other orders."""
    drawn = suite(track, name, seed)
    specs = []
    for number, spec in enumerate(drawn[: MAPS * WORLDS]):
        home = spec.seats.index(SUBMISSION)
        others = [seat for seat in spec.seats if seat != SUBMISSION]
        for turn, order in itertools.product(range(SEATS), range(ORDERS)):
            seat = (home + turn * len(spec.seats) // SEATS) % len(spec.seats)
            shift = order * (1 + number % (len(others) - 1))
            seats = [*others[shift:], *others[:shift]]
            seats.insert(seat, SUBMISSION)
            specs.append(spec.model_copy(update={"seats": tuple(seats)}))
    return specs


def play(specs: Sequence[MatchSpec], robot: str) -> list[Outcome]:
    """Let a robot play in the submission's seat of some matches."""
    batch = Batch([_with_robot(spec, robot) for spec in specs], [map_of(spec.map) for spec in specs])
    actions = np.stack([no_actions(len(specs[0].seats))] * len(specs))
    while not batch.state.matches.over.all():
        batch.play(actions)
    agents, outcomes = batch.state.agents, []
    for match, spec in enumerate(specs):
        seat, supplies = spec.seats.index(SUBMISSION), agents.supplies[match]
        own = supplies[seat]
        better_than = (supplies < own).sum() + ((supplies == own).sum() - 1) / 2
        facts = own, agents.kills[match, seat], agents.picked_up[match, seat], better_than
        outcomes.append(Outcome(*map(float, facts)))
    return outcomes


def _with_robot(spec: MatchSpec, robot: str) -> MatchSpec:
    seats = tuple(robot if seat == SUBMISSION else seat for seat in spec.seats)
    return spec.model_copy(update={"seats": seats})


def shares_of(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the shares of the variance of (MAPS, WORLDS, SEATS, ORDERS) values, as ``SHARES`` names them.

    The components of a balanced nested design with random effects (Searle, Casella & McCulloch, "Variance
    Components", 1992, ch. 3); a negative estimate counts as 0.
    """
    means = [values.mean(axis=tuple(range(level, 4))) for level in (1, 2, 3)] + [values]
    counts = np.cumprod((ORDERS, SEATS, WORLDS))[::-1]  # values in each mean of the first three levels
    squares = [counts[0] * means[0].var(ddof=1)]
    for level, inner in ((1, WORLDS), (2, SEATS), (3, ORDERS)):
        off = means[level] - means[level - 1][..., None]
        freedom = off.size // inner * (inner - 1)
        squares.append((off**2).sum() * (counts[level] if level < 3 else 1) / freedom)
    components = [(squares[level] - squares[level + 1]) / counts[level] for level in range(3)]
    parts = np.maximum([*components, squares[3]], 0.0)
    return np.asarray(parts / max(parts.sum(), 1e-12))


def matches_to_tell_apart(ahead: NDArray[np.float64]) -> float:
    """Return how many matches it takes to tell two entrants apart by their paired differences."""
    effect = abs(ahead.mean()) / max(ahead.std(ddof=1), 1e-12)
    return math.inf if effect == 0.0 else ((SURE + POWER) / effect) ** 2


def main(
    suite_name: Annotated[str, typer.Option("--suite", help="Its name.")] = "fair",
    track: Annotated[str, typer.Option(help="gathering or battle.")] = "battle",
    entrants: Annotated[str, typer.Option(help="Robots, separated by commas.")] = (
        "fighter-hard,fighter,fighter-easy,gatherer-hard"
    ),
    seed: Annotated[int, typer.Option(help="Of the suite.")] = 100,
) -> None:
    """Play, and print the two tables in Markdown."""
    specs, names = specs_of(suite_name, track, seed), entrants.split(",")
    played: dict[str, list[Outcome]] = {name: [] for name in names}
    for first in progress(range(0, len(specs), TOGETHER), suite_name):
        for name in names:
            played[name] += play(specs[first : first + TOGETHER], name)
    table = {
        metric: {name: np.array([measure(one) for one in played[name]]) for name in names}
        for metric, measure in METRICS.items()
    }
    print(f"| {track}, {suite_name} | {' | '.join(SHARES)} |\n|---|" + "---|" * len(SHARES))
    for metric, values in table.items():
        varied = [one.reshape(MAPS, WORLDS, SEATS, ORDERS) for one in values.values() if one.std() > 0]
        parts = np.mean([shares_of(one) for one in varied], axis=0)
        print(f"| {metric} | {' | '.join(f'{100 * part:.0f} %' for part in parts)} |")
    pairs = list(itertools.combinations(names, 2))
    print(f"\n| matches to tell apart | {' | '.join(f'{one}, {other}' for one, other in pairs)} |")
    print("|---|" + "---|" * len(pairs))
    for metric, values in table.items():
        needed = [matches_to_tell_apart(values[one] - values[other]) for one, other in pairs]
        ahead = [values[one].mean() > values[other].mean() for one, other in pairs]
        cells = [f"{n:.0f} {'>' if more else '<'}" for n, more in zip(needed, ahead, strict=True)]
        print(f"| {metric} | {' | '.join(cells)} |")


if __name__ == "__main__":
    typer.run(main)
