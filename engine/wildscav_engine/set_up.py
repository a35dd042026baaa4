"""Setting a match up: from its spec and its map to the state before the first step."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.body import EDGE_MARGIN
from wildscav_engine.geometry.clearance import is_clear
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.locations import keep_apart
from wildscav_engine.maps.walk import is_reached, leads_out
from wildscav_engine.rng import Dice, Stream, philox
from wildscav_engine.robots import ROBOTS
from wildscav_engine.rules import FRAMES_PER_SECOND
from wildscav_engine.spec import SUBMISSION, MatchSpec, SupplyConfig, SupplyWave
from wildscav_engine.state import State
from wildscav_engine.systems.motion import Bodies, move
from wildscav_engine.systems.supplies import choose_indoor, choose_outdoor, fill_boxes
from wildscav_engine.systems.zone import plan_zone
from wildscav_engine.tracks import TRACKS

LONGEST_FALL = 1000  # frames until a body rests, wherever it starts
SPARE_SLOTS = 4  # a seat: free slots for boxes dropped at deaths, beside those of boxes already taken
LIFT = 2.0 * SKIN  # m, of a given start, off a floor that it may lie on exactly
START_TRIES = 64  # draws for starts apart from each other before any place will do
START_DISTANCE = 3.0  # m between two starts, where the map has room
INDOOR_SPACING = 5.0  # m at least between the indoor points of supplies, so that they are few
TARGET_DISTANCE = 10.0  # m at least from start to target, where the map has room


class MatchSetupError(ValueError):
    """A match cannot be set up from its spec; the message says what, and what is allowed."""


class Boxes(NamedTuple):
    """Supply boxes of a wave at one kind of place."""

    places: NDArray[np.float64]  # (N, 3) m
    quantity: tuple[int, int]  # least and greatest
    appears: int  # frame


class WaveInfo(NamedTuple):
    """What is known in advance of a wave of supplies."""

    time: float  # s
    center: tuple[float, float]  # m, x and z
    radius: float  # m


class Setup(NamedTuple):
    """Everything about a match that is decided before its first step."""

    spec: MatchSpec
    starts: NDArray[np.float64]  # (A, 3) m
    target: NDArray[np.float64] | None  # (3,) m
    boxes: tuple[Boxes, ...]
    waves: tuple[WaveInfo, ...]
    zone: NDArray[np.float64]  # (Z, 9) as in Matches.zone

    @property
    def slots(self) -> int:
        """Slots for supply boxes that the match needs."""
        if not self.boxes:
            return 0
        return sum(len(boxes.places) for boxes in self.boxes) + SPARE_SLOTS * len(self.starts)


def plan_match(spec: MatchSpec, game_map: GameMap) -> Setup:
    """Decide starts, target and supplies of a match.

    Raises:
        MatchSetupError: A start or target is outside the map or inside something, or there is no way from the
            start, or none to the target.
    """
    track = TRACKS[spec.track]
    starts = _choose_starts(spec, game_map)
    target = _choose_target(spec, game_map, starts[0]) if track.has_target else None
    _check_ways(spec, game_map, starts[0], target)
    config = track.supplies(spec)
    boxes, waves = _choose_boxes(spec, game_map, config) if config else ((), ())
    zone = plan_zone(track.zone(spec), game_map.config.size, spec.seed)
    return Setup(spec, starts, target, boxes, waves, zone)


def _choose_starts(spec: MatchSpec, game_map: GameMap) -> NDArray[np.float64]:
    """Return (A, 3) m: random spawns apart from each other, the spec's start for the first seat."""
    dice = Dice(spec.seed, Stream.STARTS)
    spawns = game_map.world.spawns
    starts = np.empty((len(spec.seats), 3))
    for seat in range(len(spec.seats)):
        if seat == 0 and spec.start is not None:
            starts[seat] = _standing_place(spec.start, game_map, "start")
            starts[seat, 1] += LIFT
            continue
        for _ in range(START_TRIES):
            starts[seat] = spawns[dice.integer(0, len(spawns) - 1)]
            if all(_apart(starts[seat], other) >= START_DISTANCE for other in starts[:seat]):
                break
    return starts


def _choose_target(spec: MatchSpec, game_map: GameMap, start: NDArray[np.float64]) -> NDArray[np.float64]:
    if spec.target is not None:
        return _standing_place(spec.target, game_map, "target")
    dice = Dice(spec.seed, Stream.TARGET)
    spawns = game_map.world.spawns
    target: NDArray[np.float64] = start
    for _ in range(START_TRIES):
        target = spawns[dice.integer(0, len(spawns) - 1)]
        if _apart(start, target) >= TARGET_DISTANCE:
            break
    return target


def _apart(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    dx, dz = one[0] - other[0], one[2] - other[2]
    return float(np.sqrt(dx * dx + dz * dz))


def _standing_place(place: tuple[float, float, float], game_map: GameMap, name: str) -> NDArray[np.float64]:
    """Return a place of the spec, lifted onto the ground.

    Raises:
        MatchSetupError: It is outside the map, or inside something.
    """
    x, y, z = place
    limit = game_map.config.size / 2 - EDGE_MARGIN
    if max(abs(x), abs(z)) > limit:
        raise MatchSetupError(f"{name} is at x = {x}, z = {z}: outside the map, which spans ±{limit} m")
    standing = max(y, ground_at(game_map.world, x, z).height)
    if not is_clear(game_map.world, x, standing + LIFT, z):
        raise MatchSetupError(f"{name} is at {_named(place)}: inside something")
    return np.array([x, standing, z])


def _check_ways(
    spec: MatchSpec, game_map: GameMap, start: NDArray[np.float64], target: NDArray[np.float64] | None
) -> None:
    """Refuse a start and a target of the spec's own that would make the match impossible.

    Places that are chosen at random need no check: a map's places can all be reached from each other.

    Raises:
        MatchSetupError: One does not get away from the start, or not to the target.
    """
    if spec.start is not None and not leads_out(game_map.graph, _come_to_rest(game_map.world, start)):
        raise MatchSetupError(
            f"start is at {_named(spec.start)}: there is no way from there to the rest of the map"
        )
    if spec.target is None or target is None:
        return
    if not is_reached(game_map.graph, target, spec.rules.target_distance):
        raise MatchSetupError(
            f"target is at {_named(spec.target)}: there is no way to it from the rest of the map"
        )


def _come_to_rest(world: World, start: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (3,) m where a body comes to stand that starts in the air or on a steep slope."""
    body = Bodies(start[np.newaxis].copy(), np.ones(1, np.int32), 0)
    place: NDArray[np.float64] = body.position[0]
    rise, on_ground = 0.0, False
    for _ in range(LONGEST_FALL):
        moved = move(world, body, rise, on_ground, 0.0, 0.0, False, 1.0)
        rests = moved.on_ground and (moved.x, moved.y, moved.z) == tuple(place)
        place[:] = moved.x, moved.y, moved.z
        rise, on_ground = moved.rise, moved.on_ground
        if rests:
            break
    return place


def _named(place: tuple[float, float, float]) -> str:
    return f"x = {place[0]}, y = {place[1]}, z = {place[2]}"


def _choose_boxes(
    spec: MatchSpec, game_map: GameMap, config: SupplyConfig
) -> tuple[tuple[Boxes, ...], tuple[WaveInfo, ...]]:
    boxes, waves = [], []
    seed = np.uint64(spec.seed)
    indoor_points = keep_apart(game_map.indoor, INDOOR_SPACING)
    for number, wave in enumerate(sorted(config.waves, key=lambda wave: wave.time)):
        x, z = _center_of(spec, game_map, wave, number)
        waves.append(WaveInfo(wave.time, (x, z), wave.radius))
        appears = round(wave.time * FRAMES_PER_SECOND)
        outdoor = choose_outdoor(
            game_map.outdoor, config.spacing, x, z, wave.radius, wave.outdoor_richness, seed, number
        )
        indoor = choose_indoor(len(indoor_points), wave.indoor_richness, seed, number)
        boxes.append(Boxes(game_map.outdoor[outdoor], config.outdoor_quantity, appears))
        boxes.append(Boxes(indoor_points[indoor], config.indoor_quantity, appears))
    return tuple(boxes), tuple(waves)


def _center_of(spec: MatchSpec, game_map: GameMap, wave: SupplyWave, number: int) -> tuple[float, float]:
    """Return a wave's center: as given, or a random indoor location (outdoor on a map without houses)."""
    if wave.center is not None:
        return wave.center
    places = game_map.indoor if len(game_map.indoor) else game_map.outdoor
    place = places[Dice(spec.seed, Stream.WAVE_CENTER, agent=number).integer(0, len(places) - 1)]
    return float(place[0]), float(place[2])


def place_match(state: State, match: int, setup: Setup) -> None:
    """Write a match's first state into its row of a batch; the agents are yet to be equipped."""
    agents, supplies, matches = state
    spec, track = setup.spec, TRACKS[setup.spec.track]
    matches.seats[match] = len(spec.seats)
    matches.slots[match] = setup.slots
    matches.seed[match] = spec.seed
    matches.frame_limit[match] = spec.frame_limit
    matches.digest[match] = spec.seed
    if setup.target is not None:
        matches.has_target[match] = True
        matches.target[match] = setup.target
    matches.respawns[match] = track.respawns
    matches.supply_goal[match] = spec.supply_goal or 0
    matches.phases[match] = len(setup.zone)
    matches.zone[match, : len(setup.zone)] = setup.zone
    teams = spec.team_of_seats
    agents.team[match, : len(teams)] = teams
    matches.teams[match] = matches.teams_left[match] = max(teams) + 1
    matches.members_left[match, : len(teams)] = np.bincount(teams, minlength=len(teams))
    for seat, filled_by in enumerate(spec.seats):
        agents.present[match, seat] = True
        agents.knows_target[match, seat] = track.has_target and not track.hides_target
        agents.robot[match, seat] = 0 if filled_by == SUBMISSION else ROBOTS[filled_by].number
        agents.position[match, seat] = setup.starts[seat]
    first = 0
    for boxes in setup.boxes:
        fill_boxes(
            boxes.places,
            *boxes.quantity,
            boxes.appears,
            np.uint64(spec.seed),
            first,
            supplies.position[match],
            supplies.quantity[match],
            supplies.appears[match],
        )
        first += len(boxes.places)
    matches.next_serial[match] = first
    supplies.serial[match, :first] = _serials(spec.seed, first)


def _serials(seed: int, count: int) -> NDArray[np.int64]:
    """Return (count,) the numbers from 0 on, shuffled: a box's number must not tell where others lie."""
    words = [philox(np.uint64(seed), Stream.BOX_SERIAL, 0, 0, slot)[0] for slot in range(count)]
    return np.argsort(np.argsort(np.array(words, np.uint64), kind="stable"), kind="stable")


def seed_of_seat(spec: MatchSpec, seat: int) -> int:
    """Return a seat's private random seed, 63 bits; it tells nothing of the match's own seed."""
    return int(philox(np.uint64(spec.seed), Stream.AGENT_SEED, 0, seat, 0)[0]) >> 1
