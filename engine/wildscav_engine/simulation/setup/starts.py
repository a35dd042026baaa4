"""The starts of a match and its target: given by its spec, or drawn from its seed."""

from typing import NamedTuple
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import integer_in
from wildscav_engine.geometry.clearance import CLEARANCE, is_free
from wildscav_engine.geometry.sweep import SKIN, sweep_world
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.walk import is_reached, leads_out
from wildscav_engine.motion.body_motion import move
from wildscav_engine.motion.collision import Bodies
from wildscav_engine.simulation.setup.drawn_starts import (
    ALL_PLACED,
    TARGET,
    draw_place,
    draw_starts,
    draw_starts_near,
    draw_target,
)
from wildscav_engine.specs.body import BODY_HEIGHT, EDGE_MARGIN
from wildscav_engine.specs.match_spec import MatchSpec, Position

MAX_FALL = 1000  # frames within which every body comes to rest
LIFT = 2.0 * SKIN  # m by which a given start is lifted off a floor on which it may lie exactly
HIDDEN_DISTANCE = 30.0  # m, least distance from the first start to a hidden target, if the map has one there
LEAST_DETOUR = 1.5  # least length of the way to a hidden target, in straight lines, if the map has one there
CACHED_PLACES = 256  # valid given places that are remembered for each map


class MatchSetupError(ValueError):
    """A match cannot be set up from its spec; the message says what is wrong and what is allowed."""


class GivenPlace(NamedTuple):
    """A start or target that a spec gives."""

    place: Position
    name: str  # for messages
    reach: float | None  # m, distance at which a target counts as reached; None for a start


_valid_places: WeakKeyDictionary[GameMap, dict[GivenPlace, NDArray[np.float64]]] = WeakKeyDictionary()


def choose_starts(
    spec: MatchSpec, game_map: GameMap, *, has_target: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return (A, 3) m the starts of a match, and (3,) m its target or None, or raise MatchSetupError."""
    starts, is_placed = _given_starts(spec, game_map)
    seed, spawns = np.uint64(spec.seed), game_map.world.spawns
    target = None
    if spec.target is not None:
        target = _checked(game_map, GivenPlace(spec.target, "target", spec.rules.target_distance))
    if spec.start_range is not None:
        target = spawns[draw_place(spawns, seed)] if target is None else target
        reach = spec.rules.target_distance
        no_bodies = Bodies(np.zeros((0, 3)), np.zeros(0, np.int32), -1)
        spread = spec.start_range
        unplaced = draw_starts_near(game_map.world, no_bodies, target, reach, spread, seed, is_placed, starts)
    else:
        unplaced = draw_starts(spawns, seed, is_placed, starts)
        if has_target and target is None:
            target = _draw_target(game_map, seed, starts[0])
    if unplaced != ALL_PLACED:
        raise MatchSetupError(
            f"{len(starts)} seats are too many for this map: it has {len(spawns)} places, "
            f"and none of them has space for seat {unplaced}"
        )
    return starts, target


def _draw_target(game_map: GameMap, seed: np.uint64, start: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (3,) m the target of a match: one that is hidden a long way round, if the map has any."""
    spawns = game_map.world.spawns
    if len(game_map.targets) == 0:
        return np.asarray(spawns[draw_target(spawns, seed, start)])
    nearest = int(np.argmin(((spawns - start) ** 2).sum(axis=1)))
    detours = game_map.detours[:, nearest]
    offsets = game_map.targets - start
    away = offsets[:, 0] * offsets[:, 0] + offsets[:, 2] * offsets[:, 2]
    is_far = (detours >= LEAST_DETOUR) & (away >= HIDDEN_DISTANCE * HIDDEN_DISTANCE)
    if not is_far.any():
        return np.asarray(game_map.targets[np.argmax(detours)])
    choices = np.nonzero(is_far)[0]
    return np.asarray(game_map.targets[choices[integer_in(0, len(choices) - 1, seed, TARGET, 0, 1, 0)]])


def usable_place(game_map: GameMap, place: Position, reach: float | None) -> Position:
    """Return a start, or a target with its reach in m, if a spec may give it, else the nearest place."""
    try:
        _checked(game_map, GivenPlace(place, "place", reach))
    except MatchSetupError:
        offsets = game_map.world.spawns - np.array(place)
        x, y, z = game_map.world.spawns[np.argmin((offsets * offsets).sum(axis=1))].tolist()
        return x, y, z
    return place


def _given_starts(spec: MatchSpec, game_map: GameMap) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    """Return (A, 3) m the starts that the spec gives, and (A,) which seats have one."""
    seats = len(spec.seats)
    starts, is_placed = np.zeros((seats, 3)), np.zeros(seats, np.bool_)
    if spec.start is None and spec.starts is None:
        return starts, is_placed
    for seat, place in enumerate(spec.start_of_seats):
        if place is not None:
            name = f"start of seat {seat}" if seat else "start"
            starts[seat] = _checked(game_map, GivenPlace(place, name, None))
            is_placed[seat] = True
    return starts, is_placed


def _checked(game_map: GameMap, given: GivenPlace) -> NDArray[np.float64]:
    """Return (3,) m a place of the spec, put on the ground; valid places are cached for each map."""
    valid = _valid_places.setdefault(game_map, {})
    if given not in valid:
        place = _standing_place(given, game_map)
        _check_connected(given, game_map, place)
        if len(valid) >= CACHED_PLACES:
            valid.clear()
        valid[given] = place
    return valid[given]


def _standing_place(given: GivenPlace, game_map: GameMap) -> NDArray[np.float64]:
    """Return (3,) m a place of the spec, lifted onto the ground or onto a floor just above it.

    Agents may start wherever a body can get, so no more space is required than a body needs.
    """
    x, y, z = given.place
    limit = game_map.config.size / 2 - EDGE_MARGIN
    if max(abs(x), abs(z)) > limit:
        raise MatchSetupError(f"{given.name} is at x = {x}, z = {z}: outside the map, which spans ±{limit} m")
    standing = max(y, ground_at(game_map.world, x, z).height)
    soles = standing + LIFT
    if not is_free(game_map.world, x, soles + CLEARANCE, soles + BODY_HEIGHT, z, 0.0):
        raise MatchSetupError(f"{_named(given)}: inside something")
    return np.array([x, _onto_floor(game_map.world, x, soles, z) if given.reach is None else standing, z])


def _onto_floor(world: World, x: float, soles: float, z: float) -> float:
    """Return the height in m of the soles of a body, lifted out of solids that reach up to CLEARANCE into it.

    A body that is already inside a floor would fall through it, for example from a start that was rounded to
    centimetres.
    """
    if is_free(world, x, soles, soles + CLEARANCE, z, 0.0):
        return soles
    down = sweep_world(world, x, soles + CLEARANCE, z, 0.0, -CLEARANCE, 0.0)
    return float(soles + CLEARANCE * (1.0 - down.fraction))


def _check_connected(given: GivenPlace, game_map: GameMap, place: NDArray[np.float64]) -> None:
    """Refuse a start or a target that is disconnected from the rest of the map.

    Random places need no check, because all of the map's places can be reached from each other.
    """
    if given.reach is None:
        if not leads_out(game_map.graph, _come_to_rest(game_map.world, place)):
            raise MatchSetupError(f"{_named(given)}: there is no way from there to the rest of the map")
    elif not is_reached(game_map.graph, place, given.reach):
        raise MatchSetupError(f"{_named(given)}: there is no way to it from the rest of the map")


def _come_to_rest(world: World, start: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (3,) m the place where a body that starts in the air or on a steep slope comes to rest."""
    body = Bodies(start[np.newaxis].copy(), np.zeros(0, np.int32), 0)
    place: NDArray[np.float64] = body.position[0]
    rise, on_ground = 0.0, False
    for _ in range(MAX_FALL):
        moved = move(world, body, rise, on_ground, 0.0, 0.0, False, 1.0)
        rests = moved.on_ground and (moved.x, moved.y, moved.z) == tuple(place)
        place[:] = moved.x, moved.y, moved.z
        rise, on_ground = moved.rise, moved.on_ground
        if rests:
            break
    return place


def _named(given: GivenPlace) -> str:
    x, y, z = given.place
    return f"{given.name} is at x = {x}, y = {y}, z = {z}"
