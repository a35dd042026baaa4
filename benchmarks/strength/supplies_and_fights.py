"""How much the baselines of supplies and fights gather, and who outlives whom.

    python -m benchmarks.strength.supplies_and_fights --track battle commando hunter

plays the same matches of a suite with each agent in the submission's seat, in this process, and compares the
first with each of the others, match by match. ``robot:fighter`` is the robot of that name.
"""

import contextlib
import math
import statistics
from collections.abc import Callable
from operator import attrgetter
from typing import Annotated, Literal, NamedTuple

import typer
from rich.console import Console
from rich.progress import track as progress

from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_evaluator.suites.suite import suite
from wildscav_training.opponents import submission
from wildscav_training.trials import half_width, play_out

FIRST_SEED = 100  # of the suite's rounds
MAPS = 10  # matches of each round, one on each map
ROBOT = "robot:"


class Played(NamedTuple):
    """What an agent achieved in one match."""

    supplies: int
    kills: int
    deaths: int
    place: int  # in a royale, 1 for the last one alive
    act_time: float  # s a step, that the agent took with its sensors
    slowest: float  # s, its slowest step


def matches_of(track_name: str, where: str, count: int, seed: int = FIRST_SEED) -> list[MatchSpec]:
    """Return matches of a suite: one on each map, from rounds with this seed, the next one and so on."""
    specs: list[MatchSpec] = []
    while len(specs) < count:
        drawn = suite(track_name, where, seed)
        specs += drawn[:: max(1, len(drawn) // MAPS)]
        seed += 1
    return specs[:count]


def play(name: str, spec: MatchSpec) -> Played:
    """Let an agent or a robot play in the submission's seat."""
    seat = spec.seats.index(SUBMISSION)
    if name.startswith(ROBOT):
        seats = (*spec.seats[:seat], name.removeprefix(ROBOT), *spec.seats[seat + 1 :])
        spec = spec.model_copy(update={"seats": seats})
    players = [] if name.startswith(ROBOT) else [(submission(name), [seat])]
    batch, times = play_out(players, spec, [seat])
    agents = batch.state.agents
    placement = int(agents.placement[0, seat])
    return Played(
        supplies=int(agents.supplies[0, seat]),
        kills=int(agents.kills[0, seat]),
        deaths=int(agents.deaths[0, seat]),
        place=placement or 1,  # the placement of those who are left at the end is still 0
        act_time=statistics.fmean(times),
        slowest=max(times),
    )


def interval(values: list[float]) -> str:
    """Return a mean with its 95 % interval, which has no bounds after one match."""
    reach = half_width(values) if len(values) > 1 else math.inf
    return f"{statistics.fmean(values):.1f} ± {reach:.1f}"


def row(name: str, played: list[Played], first: list[Played], measure: Callable[[Played], float]) -> str:
    """Return an agent's row of the table."""

    def mean(of: Callable[[Played], float]) -> float:
        return statistics.fmean(map(of, played))

    def lead(of: Callable[[Played], float]) -> str:
        ahead = [of(ours) - of(theirs) for ours, theirs in zip(first, played, strict=True)]
        return "" if played is first else interval(ahead)

    cells = [
        f"`{name}`",
        str(len(played)),
        interval(list(map(measure, played))),
        lead(measure),
        f"{mean(lambda one: one.kills):.1f}",
        lead(lambda one: one.kills),
        f"{mean(lambda one: one.deaths):.1f}",
        f"{1000.0 * mean(lambda one: one.act_time):.2f}",
        f"{1000.0 * max(one.slowest for one in played):.0f}",
    ]
    return f"| {' | '.join(cells)} |"


def main(
    agents: Annotated[list[str], typer.Argument(help="Submissions or robots; the first is compared.")],
    track: Annotated[Literal["gathering", "battle", "royale"], typer.Option(help="The track.")],
    where: Annotated[str, typer.Option(help="The suite.")] = "official",
    matches: Annotated[int, typer.Option(help="Matches of each agent.")] = 100,
    seed: Annotated[int, typer.Option(help="Of the suite's first round.")] = FIRST_SEED,
) -> None:
    """Play and print a table in Markdown. Interrupted, it prints the matches so far."""
    specs = matches_of(track, where, matches, seed)
    rounds: list[list[Played]] = []
    with contextlib.suppress(KeyboardInterrupt):
        for spec in progress(specs, track, console=Console(stderr=True)):
            rounds.append([play(name, spec) for name in agents])  # noqa: PERF401 (kept when interrupted)
    print_table(track, where, agents, [list(played) for played in zip(*rounds, strict=True)])


def print_table(track: str, where: str, agents: list[str], played: list[list[Played]]) -> None:
    """Print the table of what each agent played."""
    what = "place" if track == "royale" else "supplies"
    measure = attrgetter(what)
    lead = f"lead of `{agents[0]}`"
    shown = f"{what} | {lead} | kills | lead in kills | deaths | ms a step | slowest, ms"
    print(f"| {track}, {where} | matches | {shown} |")
    print("|---|---|---|---|---|---|---|---|---|")
    for name, own in zip(agents, played, strict=True):
        print(row(name, own, played[0], measure), flush=True)


if __name__ == "__main__":
    typer.run(main)
