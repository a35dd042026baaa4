"""Who beats whom: the table of robots in benchmarks/results/baselines.md, played in process.

Each row is one kind of match, in which sides of robots of one kind each meet. Sides are teams, or everybody
is alone: then a side wins a battle by the supplies of all its seats, and a royale by its share of those in
first place. Matches of battle, royale and gathering are those of the suite ``wild``, but with these robots;
the other tracks use random maps. The seats are dealt anew for each match.
"""

import functools
from collections.abc import Callable, Iterator
from typing import Annotated, NamedTuple

import numpy as np
import typer

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.maps import MapError, generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import no_actions
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.seats import shuffled
from wildscav_evaluator.suites.wild import WILD, meeting_ground
from wildscav_training.trials import wilson

MAPS = 20  # of each kind
TOGETHER = 40  # matches in a batch


class Row(NamedTuple):
    """One row of the table: matches in which sides meet."""

    question: str
    draw: Callable[[RandomStream], MatchSpec]  # all but the map, the seats and the seed
    country: str  # a name in COUNTRIES
    sides: tuple[tuple[str, ...], ...]  # the robots of each; the row is about the first
    teams: bool = True  # whether each side is a team; otherwise everybody is alone
    wanted: str = ""

    @property
    def seats(self) -> int:
        """The number of seats."""
        return sum(map(len, self.sides))


class Played(NamedTuple):
    """What the first side of a row achieved."""

    matches: int
    share: float  # of the matches won by it; a draw counts as a part
    low: float  # of the 95 % interval
    high: float
    note: str


def search(track: str, time_limit: float) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws races to a target."""
    return lambda _: MatchSpec(track=track, time_limit=time_limit)


def level_country(level: str) -> Callable[[RandomStream], MapConfig]:
    """Return a function that gives the config of a level."""
    return lambda _: LEVELS[level]  # type: ignore[index]


COUNTRIES: dict[str, Callable[[RandomStream], MapConfig]] = {
    "wild": meeting_ground,
    "normal": level_country("normal"),
    "hard": level_country("hard"),
}


gathering, battle, royale = (WILD.tracks[track].draw for track in ("gathering", "battle", "royale"))


def levels(kind: str) -> tuple[str, str, str]:
    """Return the names of a kind of robot from easy to hard."""
    return f"{kind}-easy", kind, f"{kind}-hard"


def rows() -> Iterator[Row]:
    """Yield the rows of the table."""
    for suffix in ("", "-hard"):
        sides = ((f"fighter{suffix}",) * 5, (f"gatherer{suffix}",) * 5)
        yield Row("fighters beat gatherers, as teams", battle, "wild", sides, wanted="≥ 60 %")
        yield Row("fighters beat gatherers, each alone", battle, "wild", sides, False, "≥ 60 %")
    for suffix in ("-easy", "", "-hard"):
        kinds = [f"{kind}{suffix}" for kind in ("walker", "gatherer", "fighter")]
        sides3 = tuple((kind,) * 3 for kind in kinds)
        yield Row("a walker wins a royale", royale, "wild", sides3, False, "< 33 %")
    for better, worse in ((1, 0), (2, 1)):
        for track, draw, country, kind, size in (
            ("navigation", search("navigation", 120.0), "hard", "seeker", 1),
            ("gathering", gathering, "wild", "gatherer", 5),
            ("capture", search("capture", 180.0), "normal", "seeker", 4),
            ("battle", battle, "wild", "fighter", 5),
            ("royale", royale, "wild", "fighter", 5),
        ):
            names = levels(kind)
            sides2 = ((names[better],) * size, (names[worse],) * size)
            yield Row(f"the harder beats the easier: {track}", draw, country, sides2, wanted="> 50 %")
    for suffix in ("", "-hard"):
        sides2 = ((f"hunter-squad{suffix}",) * 5, (f"fighter{suffix}",) * 5)
        yield Row("a squad beats as many fighters", battle, "wild", sides2, wanted="> 50 %")


@functools.cache
def maps(country: str) -> tuple[GameMap, ...]:
    """Return the maps of a kind of country."""
    dice, found = RandomStream(0, Stream.SUITE), list[GameMap]()
    while len(found) < MAPS:
        try:
            found.append(generate_map(COUNTRIES[country](dice), dice.word() >> 1))
        except MapError:
            continue
    return tuple(found)


def specs_of(row: Row, matches: int) -> list[MatchSpec]:
    """Return the matches of a row, with the seats dealt anew for each."""
    specs = []
    for number in range(matches):
        dice = RandomStream(number, Stream.SUITE)
        of_seats = [(side, name) for side, names in enumerate(row.sides) for name in names]
        order = shuffled(dice, [str(index) for index in range(row.seats)])
        dealt = [of_seats[int(index)] for index in order]
        teams = tuple(side for side, _ in dealt) if row.teams else tuple(range(row.seats))
        changes = {
            "seats": tuple(name for _, name in dealt),
            "teams": teams,
            "seed": dice.word(),
            "map": maps(row.country)[number % MAPS].spec,
        }
        spec = row.draw(dice)
        specs.append(MatchSpec.model_validate({**dict(spec), **changes}))
    return specs


def play(row: Row, matches: int) -> Played:
    """Play the matches of a row."""
    specs, wins, more = specs_of(row, matches), 0.0, np.zeros(3)
    for first in range(0, matches, TOGETHER):
        part = specs[first : first + TOGETHER]
        chosen = [maps(row.country)[number % MAPS] for number in range(first, first + len(part))]
        batch = Batch(part, chosen)
        actions = np.stack([no_actions(row.seats)] * len(part))
        while not batch.state.matches.over.all():
            batch.step(actions)
        for number, spec in enumerate(part):
            wins += _won(row, batch, number, spec)
        agents = batch.state.agents
        more += agents.kills.sum(), agents.deaths.sum(), agents.supplies.sum()
    share, note = wins / matches, f"deaths a match {more[1] / matches:.1f}, supplies {more[2] / matches:.0f}"
    return Played(matches, share, *wilson(share, matches), note)


def _won(row: Row, batch: Batch, number: int, spec: MatchSpec) -> float:
    """Return which part of a match's win belongs to the first side: 1, 0, or a share of a draw."""
    sides = [[seat for seat, name in enumerate(spec.seats) if name in names] for names in row.sides]
    if batch.track.has_zone and not row.teams:
        first = _first_seats(batch, number)
        return len(set(first) & set(sides[0])) / len(first)
    scores = [_score(batch, number, seats) for seats in sides]
    return (scores[0] == max(scores)) / scores.count(max(scores))


def _first_seats(batch: Batch, number: int) -> list[int]:
    """Return the seats that share the first place of a royale."""
    placement = batch.state.agents.placement[number]
    # The placement of those who are left at the end is still 0.
    return np.flatnonzero(placement == placement.min()).tolist()


def _score(batch: Batch, number: int, seats: list[int]) -> float:
    """Return the score of a side; more is better."""
    agents = batch.state.agents
    if batch.track.has_zone:
        return -float(agents.placement[number, seats].min())
    if batch.track.has_target:
        return float(agents.reached[number, seats].any())
    return float(agents.supplies[number, seats].sum())


def described(row: Row) -> str:
    """Return the sides of a row as text."""
    return " : ".join(f"{len(side)} `{side[0]}`" for side in row.sides)


def main(
    matches: Annotated[int, typer.Option(help="Matches in each row.")] = 200,
    only: Annotated[str, typer.Option(help="Part of the rows' questions or robots.")] = "",
) -> None:
    """Play and print the rows of the table in Markdown."""
    print("| question | who | country | matches | first side wins | 95 % interval | wanted | |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows():
        if only in row.question + " " + described(row):
            played = play(row, matches)
            print(
                f"| {row.question} | {described(row)} | {row.country} | {played.matches} "
                f"| {played.share:.1%} | {played.low:.1%}–{played.high:.1%} | {row.wanted} | {played.note} |",
                flush=True,
            )


if __name__ == "__main__":
    typer.run(main)
