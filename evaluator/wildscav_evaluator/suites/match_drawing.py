"""Drawing the matches of the suites on each track: everything except their maps and seeds."""

from collections.abc import Callable
from typing import TypeVar

from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.seats import battle_seats, shuffled

Choice = TypeVar("Choice")


def choose(dice: RandomStream, choices: tuple[Choice, ...]) -> Choice:
    """Return one of the choices, with equal probability."""
    return choices[dice.integer(0, len(choices) - 1)]


def navigation(time_limit: float) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of navigation; they differ only in map and seed."""
    return lambda _: MatchSpec(track="navigation", time_limit=time_limit)


def gathering(
    time_limit: float, offset: float, radii: tuple[float, ...], spacings: tuple[float, ...]
) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches with one wave of supplies near the middle of the map.

    The centre's x and z are each -offset, 0 or offset, m. Of the radii, m, each is a standard deviation of
    the heat map; the spacings, m, are of the outdoor grid.
    """

    def draw(dice: RandomStream) -> MatchSpec:
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
) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of one submission against robots, with one refresh of supplies.

    The first heat map is around the middle of the map, with a standard deviation of ``radius``, m. The
    refresh, ``refresh_time`` s into the match, is around a random indoor place, with one of the
    ``refresh_radii``.
    """

    def draw(dice: RandomStream) -> MatchSpec:
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


def capture(time_limit: float, robots: int) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches in which one submission and seekers look for a hidden target."""
    seats = (SUBMISSION, *("seeker",) * robots)
    return lambda _: MatchSpec(track="capture", time_limit=time_limit, seats=seats)


def royale(time_limit: float, robots: int) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of one submission against robots, each on its own."""
    return lambda dice: MatchSpec(track="royale", time_limit=time_limit, seats=battle_seats(dice, robots))


def track_defaults(track: str, time_limit: float, robots: int) -> Callable[[RandomStream], MatchSpec]:
    """Return a function that draws matches of one submission against a track's robots, in random seats.

    Where the track's own defaults are less, time limit and robots are those.
    """

    def draw(dice: RandomStream) -> MatchSpec:
        kind = TRACKS[track]
        seats = (SUBMISSION, *(kind.robot,) * min(robots, kind.opponents))
        return MatchSpec(
            track=track, time_limit=min(time_limit, kind.time_limit), seats=shuffled(dice, seats)
        )

    return draw
