"""How many matches of a suite tell submissions apart.

    python -m benchmarks.strength.power --rounds 8 --picture out/power.png

lets agents play the same battles, in rounds of ten that are kept in a file of results for each suite, and
plays what is not there yet. Then it draws n of the matches of a pair again and again: its power is the share
of draws in which the 95 % interval of the paired difference (Student's) leaves out 0, on the right side.
"""

import itertools
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from benchmarks.strength.supplies_and_fights import FIRST_SEED, MAPS, ROBOT, matches_of, play
from numpy.typing import NDArray

from wildscav_training.trials import student

RESULTS = Path(__file__).parents[1] / "results" / "battles"
AGENTS = {
    "commando": "commando",
    "learned-commando": "learned-commando",
    "hunter": "hunter",
    "scavenger": "scavenger",
    "fighter": f"{ROBOT}fighter",
    "gunner": "benchmarks/strength/gunner",
}
STUDENT = {matches: student(matches - 1) for matches in (5, 10, 20, 40, 80)}  # standard errors
OFFICIAL, AIM = 20, 0.9  # matches of an evaluation, and the power that they should have ...
GAP = 0.25  # ... for a pair of which one has this share less than the other
DRAWS = 4000


class Pair(NamedTuple):
    """Two agents of a suite, the better one first."""

    names: tuple[str, str]
    means: tuple[float, float]
    power: tuple[float, ...]  # by the numbers of matches in ``STUDENT``
    played: int  # matches

    @property
    def gap(self) -> float:
        """How much less the second has, as a share of what the first has."""
        return 1.0 - self.means[1] / self.means[0]


def results_of(where: str) -> dict[str, dict[str, Any]]:
    """Return the supplies, kills and deaths in each match, by the round's seed and the agent."""
    path = RESULTS / f"{where}.json"
    return json.loads(path.read_text("utf-8")) if path.exists() else {}


def play_round(where: str, seed: int, name: str) -> None:
    """Let an agent play a round and keep it, unless it is there."""
    kept = results_of(where)
    if name not in kept.setdefault(str(seed), {}):
        specs = matches_of("battle", where, MAPS, seed)
        kept[str(seed)][name] = [[*play(AGENTS[name], spec)[:3]] for spec in specs]
        RESULTS.mkdir(parents=True, exist_ok=True)
        (RESULTS / f"{where}.json").write_text(json.dumps(kept) + "\n", "utf-8")


def power_of(ahead: NDArray[np.float64], matches: int) -> float:
    """Return how often so many of the differences of a pair show that the first is better."""
    drawn = np.random.default_rng(matches).choice(ahead, (DRAWS, matches))
    reach = STUDENT[matches] * drawn.std(axis=1, ddof=1) / np.sqrt(matches)
    return float((drawn.mean(axis=1) > reach).mean())


def pairs_of(where: str) -> list[Pair]:
    """Return all pairs that played the same matches, those with the greatest gap first."""
    found, played = [], results_of(where).values()
    for pair in itertools.combinations(AGENTS, 2):
        rounds = [one for one in played if set(pair) <= set(one)]
        if rounds:
            score = {name: np.array([match[0] for one in rounds for match in one[name]]) for name in pair}
            one, other = sorted(pair, key=lambda name: -score[name].mean())
            power = tuple(power_of(score[one] - score[other], matches) for matches in STUDENT)
            means = score[one].mean(), score[other].mean()
            found.append(Pair((one, other), means, power, len(score[one])))
    return sorted(found, key=lambda pair: -pair.gap)


def print_table(where: str, pairs: Sequence[Pair]) -> None:
    """Print the power of each pair in Markdown."""
    print(
        f"\n| `{where}` | played | supplies | less | {' | '.join(map(str, STUDENT))} |\n|---"
        + "|---" * 8
        + "|"
    )
    for (one, other), (more, less), power, count in pairs:
        cells = " | ".join(f"{100.0 * share:.0f} %" for share in power)
        gap = f"{100.0 * (1 - less / more):.0f} %"
        print(f"| `{one}`, `{other}` | {count} | {more:.0f}, {less:.0f} | {gap} | {cells} |")


def draw(found: dict[str, list[Pair]], picture: Path) -> None:
    """Draw the power of each pair whose gap counts, and their median."""
    from matplotlib import pyplot as plt

    figure, (panels,) = plt.subplots(
        1, len(found), figsize=(8.0, 3.4), sharey=True, layout="constrained", squeeze=False
    )
    for axes, (where, pairs) in zip(panels, found.items(), strict=True):
        curves = 100.0 * np.array([pair.power for pair in pairs if pair.gap >= GAP])
        axes.plot([*STUDENT], curves.T, color="tab:blue", alpha=0.3, linewidth=1.0)
        axes.plot([*STUDENT], np.median(curves, axis=0), color="tab:blue", linewidth=2.5, marker="o")
        axes.axhline(100.0 * AIM, color="gray", linestyle=":")
        axes.axvline(OFFICIAL, color="gray", linestyle=":")
        axes.set_xscale("log")
        axes.set_xticks([*STUDENT], [*STUDENT])
        axes.minorticks_off()
        axes.set_title(f"{where}: {len(curves)} pairs and their median", fontsize=10)
        axes.set_xlabel("matches")
    panels[0].set_ylabel("told apart, % of draws")
    figure.savefig(picture, dpi=110)


def main(
    suites: Annotated[str, typer.Option(help="Suites, separated by commas.")] = "fair,wild",
    agents: Annotated[str, typer.Option(help="Agents to add, separated by commas.")] = ",".join(AGENTS),
    seed: Annotated[int, typer.Option(help="Of the first round.")] = FIRST_SEED,
    rounds: Annotated[int, typer.Option(help="Rounds of each suite to play.")] = 8,
    picture: Annotated[Path | None, typer.Option(help="File for the picture.")] = None,
) -> None:
    """Play what is missing; print the tables of all that is there."""
    names = suites.split(",")
    for number, where, name in itertools.product(range(seed, seed + rounds), names, agents.split(",")):
        play_round(where, number, name)
    found = {where: pairs_of(where) for where in names}
    for where, pairs in found.items():
        print_table(where, pairs)
    if picture is not None:
        draw(found, picture)


if __name__ == "__main__":
    typer.run(main)
