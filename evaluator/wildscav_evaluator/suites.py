"""Suites: the seeded lists of matches that evaluate a submission on a track.

A suite is made from (track, suite name, seed) without making any map, and is the same for every
submission: all play the same matches, so that their scores can be compared match by match.

Map seeds with the top bit set (2**63 and above) are kept for evaluation. Training draws its map seeds
below 2**63, so no agent has trained on a map of a suite.
"""

from collections.abc import Callable
from hashlib import blake2b
from typing import NamedTuple, TypeVar

from wildscav_engine.rng import Dice, Stream
from wildscav_engine.spec import SUBMISSION, MapConfig, MapSpec, MatchSpec, SupplyConfig, SupplyWave
from wildscav_evaluator.seating import battle_seats

Choice = TypeVar("Choice")

EVALUATION_MAPS = 1 << 63  # the bit that marks a map seed as kept for evaluation


class Course(NamedTuple):
    """What a suite asks on one track."""

    maps: int
    episodes: int  # on each map
    draw: Callable[[Dice], MatchSpec]  # everything of a match but its map and seed


class Suite(NamedTuple):
    """A way to evaluate: what kind of maps, and a course for every track."""

    title: str
    map_config: Callable[[Dice], MapConfig]
    courses: dict[str, Course]


def suite(track: str, name: str, seed: int) -> tuple[MatchSpec, ...]:
    """Return the matches that evaluate a submission on a track.

    Args:
        track: A name in ``wildscav_engine.tracks.TRACKS``.
        name: A name in ``SUITES``.
        seed: Any whole number; each gives other maps and matches.

    Raises:
        ValueError: There is no such suite, or it does not have the track.
    """
    if name not in SUITES:
        raise ValueError(f"there is no suite {name!r}; the suites are {', '.join(SUITES)}")
    chosen = SUITES[name]
    if track not in chosen.courses:
        raise ValueError(f"suite {name} has no track {track!r}; it has {', '.join(chosen.courses)}")
    course = chosen.courses[track]
    dice = _dice(track, name, seed)
    specs = []
    for _ in range(course.maps):
        game_map = MapSpec(config=chosen.map_config(dice), seed=EVALUATION_MAPS | dice.word())
        for _ in range(course.episodes):
            match = course.draw(dice)
            specs.append(match.model_copy(update={"map": game_map, "seed": dice.word()}))
    return tuple(specs)


def _dice(track: str, name: str, seed: int) -> Dice:
    """Return dice that no other track, suite or seed shares."""
    digest = blake2b(f"{name}/{track}/{seed}".encode(), digest_size=8).digest()
    return Dice(int.from_bytes(digest, "little"), Stream.SUITE)


def choose(dice: Dice, choices: tuple[Choice, ...]) -> Choice:
    """Return one of the choices, all equally likely."""
    return choices[dice.integer(0, len(choices) - 1)]


def navigation(time_limit: float) -> Callable[[Dice], MatchSpec]:
    """Start and target are random outdoor places of the map; nothing else is drawn."""
    return lambda _: MatchSpec(track="navigation", time_limit=time_limit)


def gathering(
    time_limit: float, offset: float, radii: tuple[float, ...], spacings: tuple[float, ...]
) -> Callable[[Dice], MatchSpec]:
    """One wave around a place near the middle of the map.

    Args:
        time_limit: Seconds of game time.
        offset: The centre's x and z are each -offset, 0 or offset metres.
        radii: Metres; standard deviations of the heat map.
        spacings: Metres, of the outdoor grid.
    """

    def draw(dice: Dice) -> MatchSpec:
        offsets = (-offset, 0.0, offset)
        wave = SupplyWave(
            center=(choose(dice, offsets), choose(dice, offsets)),
            radius=choose(dice, radii),
            outdoor_richness=choose(dice, (10.0, 20.0, 30.0)),
            indoor_richness=choose(dice, (50.0, 70.0, 90.0)),
        )
        supplies = SupplyConfig(waves=(wave,), spacing=choose(dice, spacings))
        return MatchSpec(track="gathering", time_limit=time_limit, supplies=supplies)

    return draw


def battle(
    time_limit: float, robots: int, radius: float, refresh_time: float, refresh_radii: tuple[float, ...]
) -> Callable[[Dice], MatchSpec]:
    """One submission against robots, with one refresh around a random indoor place.

    Args:
        time_limit: Seconds of game time.
        robots: Opponents.
        radius: Metres; standard deviation of the first heat map, around the middle of the map.
        refresh_time: Seconds into the match.
        refresh_radii: Metres; standard deviations of the second heat map.
    """

    def draw(dice: Dice) -> MatchSpec:
        outdoor, indoor = choose(dice, (10.0, 20.0, 30.0)), choose(dice, (70.0, 80.0, 90.0))
        first = SupplyWave(center=(0.0, 0.0), radius=radius, outdoor_richness=outdoor, indoor_richness=indoor)
        refresh = SupplyWave(
            time=refresh_time,
            center=None,
            radius=choose(dice, refresh_radii),
            outdoor_richness=outdoor,
            indoor_richness=indoor,
        )
        supplies = SupplyConfig(waves=(first, refresh), spacing=5.0)
        seats = battle_seats(dice, robots)
        return MatchSpec(track="battle", time_limit=time_limit, seats=seats, supplies=supplies)

    return draw


def capture(time_limit: float, robots: int) -> Callable[[Dice], MatchSpec]:
    """A hidden target, looked for by one submission and seekers, as one team.

    Args:
        time_limit: Seconds of game time.
        robots: Teammates.
    """
    seats = (SUBMISSION, *("seeker",) * robots)
    return lambda _: MatchSpec(track="capture", time_limit=time_limit, seats=seats)


def royale(time_limit: float, robots: int) -> Callable[[Dice], MatchSpec]:
    """One submission against robots, each alone; supplies and safe zone are the track's own.

    Args:
        time_limit: Seconds of game time.
        robots: Opponents.
    """
    return lambda dice: MatchSpec(track="royale", time_limit=time_limit, seats=battle_seats(dice, robots))


def _small_map(dice: Dice) -> MapConfig:
    size = choose(dice, (60, 80, 100))
    return MapConfig(
        size=size,
        # On 60 m of steep country there is not always room for more.
        houses=dice.integer(2, 3) if size > 60 else 1,
        density="high" if dice.integer(0, 1) else "low",
        storeys=(1, 2),
        relief=choose(dice, (0.5, 0.8, 1.1)),
        ruggedness=choose(dice, (0.1, 0.4, 0.8)),
        water=choose(dice, (0.0, 0.06)),
        vegetation=choose(dice, (0.2, 0.4)),
    )


def _large_map(dice: Dice) -> MapConfig:
    """A map like the original's large ones: 500 m, 12 to 15 houses of two or three storeys.

    The land itself is anything from smooth downs to rugged mountains.
    """
    return MapConfig(
        size=500,
        houses=dice.integer(12, 15),
        density="high" if dice.integer(0, 1) else "low",
        storeys=(2, 3),
        relief=choose(dice, (0.5, 1.0, 1.5, 2.0)),
        ruggedness=choose(dice, (0.1, 0.4, 0.7, 1.0)),
        water=choose(dice, (0.04, 0.08, 0.12)),
        vegetation=choose(dice, (0.2, 0.4, 0.6)),
    )


SUITES: dict[str, Suite] = {
    "quick": Suite(
        title="a look at an agent in a minute or two: few short matches on small maps",
        map_config=_small_map,
        courses={
            "navigation": Course(maps=5, episodes=1, draw=navigation(60.0)),
            "gathering": Course(maps=4, episodes=1, draw=gathering(60.0, 10.0, (10.0, 30.0), (5.0, 10.0))),
            "capture": Course(maps=3, episodes=1, draw=capture(60.0, 3)),
            "battle": Course(maps=3, episodes=1, draw=battle(60.0, 5, 40.0, 40.0, (10.0, 20.0))),
            "royale": Course(maps=3, episodes=1, draw=royale(60.0, 5)),
        },
    ),
    # Counts, limits and supplies of the original competition.
    "official": Suite(
        title="the competition's evaluation: its counts, time limits and supplies, on large maps",
        map_config=_large_map,
        courses={
            "navigation": Course(maps=10, episodes=10, draw=navigation(300.0)),
            "gathering": Course(
                maps=10,
                episodes=10,
                draw=gathering(600.0, 20.0, (10.0, 30.0, 50.0, 70.0), (5.0, 10.0, 15.0, 20.0)),
            ),
            "battle": Course(maps=10, episodes=1, draw=battle(900.0, 9, 100.0, 600.0, (30.0, 50.0, 70.0))),
            # Not in the original competition; as long as its nearest kin there.
            "capture": Course(maps=10, episodes=10, draw=capture(300.0, 3)),
            "royale": Course(maps=10, episodes=1, draw=royale(900.0, 9)),
        },
    ),
}
