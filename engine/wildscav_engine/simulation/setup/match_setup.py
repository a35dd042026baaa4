"""The setup of a match: from its spec and its map to the state before the first step."""

import functools
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream, Word, philox
from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.locations import OUTDOOR_SPACING
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.simulation.setup.starts import MatchSetupError, choose_starts
from wildscav_engine.simulation.state import EQUIPMENT, State
from wildscav_engine.simulation.systems.hot_spot import NONE as NO_HOT_SPOT
from wildscav_engine.simulation.systems.hot_spot import choose_around, plan_hot_spot
from wildscav_engine.simulation.systems.supplies import choose_indoor, choose_outdoor, fill_boxes
from wildscav_engine.simulation.systems.zone import COLUMNS as ZONE_COLUMNS
from wildscav_engine.simulation.systems.zone import plan_zone
from wildscav_engine.simulation.track import TRACKS
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave

__all__ = [
    "Boxes",
    "MatchSetupError",
    "Setup",
    "WaveInfo",
    "place_match",
    "plan_match",
    "room_for",
    "seed_of_seat",
]

SPARE_SLOTS = 4  # per seat, for boxes dropped on death, in addition to slots of boxes that are taken
NO_ZONE = np.zeros((0, ZONE_COLUMNS))


class Boxes(NamedTuple):
    """The outdoor or the indoor supply boxes of one wave."""

    places: NDArray[np.float64]  # (N, 3) m
    quantity: tuple[int, int]  # least and greatest
    appears: int  # the frame from which on they are present


class WaveInfo(NamedTuple):
    """What is announced in advance about a wave of supplies."""

    time: float  # s
    center: tuple[float, float]  # m, x and z
    radius: float  # m


class Setup(NamedTuple):
    """Everything that is decided before the first step of a match."""

    spec: MatchSpec
    starts: NDArray[np.float64]  # (A, 3) m
    target: NDArray[np.float64] | None  # (3,) m
    boxes: tuple[Boxes, ...]
    waves: tuple[WaveInfo, ...]
    zone: NDArray[np.float64]  # (Z, 9) as in Matches.zone
    hot_spots: NDArray[np.float64]  # (H, 3) as in Matches.hot_spots
    wave_centers: NDArray[np.float64]  # (W, 3) as in Matches.wave_centers

    @property
    def slots(self) -> int:
        """The number of slots for supply boxes that the match needs."""
        if not self.boxes:
            return 0
        return sum(len(boxes.places) for boxes in self.boxes) + SPARE_SLOTS * len(self.starts)


def room_for(setups: Sequence[Setup]) -> tuple[int, int, int, int]:
    """Return the numbers of box slots, zone phases, places of the hot spot, and waves to have room for."""
    return (
        max(setup.slots for setup in setups),
        max(len(setup.zone) for setup in setups),
        max(len(setup.hot_spots) for setup in setups),
        max(len(setup.wave_centers) for setup in setups),
    )


def plan_match(spec: MatchSpec, game_map: GameMap) -> Setup:
    """Decide the starts, the target, the supplies and the safe zone of a match."""
    track = TRACKS[spec.track]
    starts, target = choose_starts(spec, game_map, has_target=track.has_target)
    config = track.supplies(spec)
    boxes, waves = _choose_boxes(spec, game_map, config) if config else ((), ())
    zone = plan_zone(track.zone(spec), game_map.config.size, spec.seed) if track.has_zone else NO_ZONE
    if config is None or config.hot_spot is None:
        return Setup(spec, starts, target, boxes, waves, zone, NO_HOT_SPOT, _rows_of(waves))
    places = plan_hot_spot(config.hot_spot, game_map.world.spawns, zone, spec.seed)
    more_boxes, announced = _boxes_around(places, config.hot_spot, game_map, spec.seed)
    all_waves = tuple(sorted(waves + announced, key=lambda wave: wave.time))
    return Setup(spec, starts, target, boxes + more_boxes, all_waves, zone, places, _rows_of(all_waves))


def _choose_boxes(
    spec: MatchSpec, game_map: GameMap, config: SupplyConfig
) -> tuple[tuple[Boxes, ...], tuple[WaveInfo, ...]]:
    boxes, waves = [], []
    seed = np.uint64(spec.seed)
    indoor_points = game_map.supply_points
    # A grid as fine as the spacing of the map's locations has more points than there are locations.
    is_fine = config.spacing <= OUTDOOR_SPACING
    outdoor_points = game_map.ground_points if is_fine else game_map.outdoor
    for number, wave in enumerate(sorted(config.waves, key=lambda wave: wave.time)):
        x, z = _center_of(spec, game_map, wave, number)
        waves.append(WaveInfo(wave.time, (x, z), wave.radius))
        appears = round(wave.time * FRAMES_PER_SECOND)
        outdoor = choose_outdoor(
            outdoor_points, config.spacing, x, z, wave.radius, wave.outdoor_richness, seed, number
        )
        indoor = choose_indoor(len(indoor_points), wave.indoor_richness, seed, number)
        boxes.append(Boxes(outdoor_points[outdoor], config.outdoor_quantity, appears))
        boxes.append(Boxes(indoor_points[indoor], config.indoor_quantity, appears))
    return tuple(boxes), tuple(waves)


def _rows_of(waves: Sequence[WaveInfo]) -> NDArray[np.float64]:
    """Return (W, 3) the frames and centres of waves, as in ``Matches.wave_centers``."""
    rows = [(round(wave.time * FRAMES_PER_SECOND), *wave.center) for wave in waves]
    return np.array(rows, np.float64).reshape(len(rows), 3)


def _boxes_around(
    places: NDArray[np.float64], config: HotSpot, game_map: GameMap, seed: int
) -> tuple[tuple[Boxes, ...], tuple[WaveInfo, ...]]:
    """Return the boxes at all places of a hot spot, and what is announced about them."""
    boxes, waves = [], []
    for number, (frame, x, z) in enumerate(places.tolist()):
        chosen = choose_around(game_map.outdoor, x, z, config.radius, config.boxes, np.uint64(seed), number)
        boxes.append(Boxes(game_map.outdoor[chosen], config.quantity, round(frame)))
        waves.append(WaveInfo(config.start + config.interval * number, (x, z), config.radius))
    return tuple(boxes), tuple(waves)


def _center_of(spec: MatchSpec, game_map: GameMap, wave: SupplyWave, number: int) -> tuple[float, float]:
    """Return the center of a wave: given, or a random indoor location (outdoor on maps without houses)."""
    if wave.center is not None:
        return wave.center
    places = game_map.indoor if len(game_map.indoor) else game_map.outdoor
    place = places[RandomStream(spec.seed, Stream.WAVE_CENTER, agent=number).integer(0, len(places) - 1)]
    return float(place[0]), float(place[2])


def place_match(state: State, match: int, setup: Setup) -> None:
    """Write the first state of a match into its cleared row of a batch; agents are not yet equipped."""
    agents, matches, spec = state.agents, state.matches, setup.spec
    track, seats, seed = TRACKS[spec.track], len(spec.seats), np.uint64(spec.seed)
    matches.seats[match] = seats
    matches.slots[match] = setup.slots
    matches.seed[match] = matches.digest[match] = seed
    matches.frame_limit[match] = spec.frame_limit
    matches.respawns[match] = track.respawns
    matches.respawns_at_start[match] = spec.respawn_at == "start"
    if setup.target is not None:
        matches.has_target[match] = True
        matches.target[match] = setup.target
        agents.knows_target[match, :seats] = not track.hides_target
    if spec.supply_goal is not None:
        matches.supply_goal[match] = spec.supply_goal
    if len(setup.zone):
        matches.phases[match] = len(setup.zone)
        matches.zone[match, : len(setup.zone)] = setup.zone
    if len(setup.hot_spots):
        matches.places[match] = len(setup.hot_spots)
        matches.hot_spots[match, : len(setup.hot_spots)] = setup.hot_spots
    if len(setup.wave_centers):
        matches.waves[match] = len(setup.wave_centers)
        matches.wave_centers[match, : len(setup.wave_centers)] = setup.wave_centers
    lineup = _line_up(spec.track, spec.seats, spec.teams)
    matches.teams[match] = matches.teams_left[match] = lineup.teams
    matches.members_left[match, :seats] = lineup.members
    agents.team[match, :seats] = lineup.team
    agents.robot[match, :seats] = lineup.robot
    agents.present[match, :seats] = True
    agents.position[match, :seats] = agents.start[match, :seats] = setup.starts
    _write_equipment(state, match, spec)
    if setup.boxes:
        _place_boxes(state, match, setup, seed)


def _write_equipment(state: State, match: int, spec: MatchSpec) -> None:
    """Write the equipment of every seat of a match: that of the rules, or its own."""
    agents, seats = state.agents, len(spec.seats)
    for array, rule in EQUIPMENT.items():
        getattr(agents, array)[match, :seats] = getattr(spec.rules, rule)
    for seat in range(seats) if spec.equipment is not None else ():
        for array, value in zip(EQUIPMENT, spec.equipment_of(seat), strict=False):
            getattr(agents, array)[match, seat] = value


class Lineup(NamedTuple):
    """The teams and robots of a match, which depend only on its track, seats and teams."""

    team: NDArray[np.int32]  # (A,) the team of each seat
    robot: NDArray[np.int32]  # (A,) number of the robot in each seat, 0 for none
    teams: int  # number of teams
    members: NDArray[np.int32]  # (A,) number of seats of each team


@functools.lru_cache(maxsize=64)
def _line_up(track: str, seats: tuple[str, ...], teams: tuple[int, ...] | None) -> Lineup:
    team = np.array(TRACKS[track].teams(len(seats)) if teams is None else teams, np.int32)
    robot = [0 if name == SUBMISSION else ROBOTS[name].number for name in seats]
    members = np.bincount(team, minlength=len(seats)).astype(np.int32)
    return Lineup(team, np.array(robot, np.int32), int(team.max()) + 1, members)


def _place_boxes(state: State, match: int, setup: Setup, seed: np.uint64) -> None:
    """Write the boxes of a match, with serial numbers that reveal nothing about other boxes."""
    supplies, first = state.supplies, 0
    position, quantity, appears = (array[match] for array in supplies[:3])
    for places, (low, high), frame in setup.boxes:
        fill_boxes(places, low, high, frame, seed, first, position, quantity, appears)
        first += len(places)
    words = np.empty(first, np.uint64)
    draw_words(seed, Stream.BOX_SERIAL, words)
    supplies.serial[match, np.argsort(words, kind="stable")] = np.arange(first)
    state.matches.next_serial[match] = first


@kernel
def draw_words(seed: Word, stream: int, words: NDArray[np.uint64]) -> None:
    """Draw 64 random bits for each of (N,) words."""
    for index in range(words.shape[0]):
        words[index] = philox(seed, stream, 0, 0, index)[0]


def seed_of_seat(spec: MatchSpec, seat: int) -> int:
    """Return the private random seed of a seat, 63 bits, which reveals nothing about the match's seed."""
    return int(philox(np.uint64(spec.seed), Stream.AGENT_SEED, 0, seat, 0)[0]) >> 1
