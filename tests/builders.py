"""Small worlds and matches for tests, made by hand."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import RandomStream, Stream
from wildscav_engine.geometry.world import CELL, Kind, Solid, World, build_world, convex_solid
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.simulation.match import Match
from wildscav_engine.simulation.state import Supplies
from wildscav_engine.simulation.systems.supplies import index_boxes
from wildscav_engine.simulation.systems.visibility import Seen
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave
from wildscav_engine.tracks.rewards import FACTS, RewardSum, write_facts, write_terms

# Boxes on half of the whole metres of a map, and in all rooms.
RICH = SupplyConfig(
    waves=(SupplyWave(center=(0, 0), radius=1000, outdoor_richness=50, indoor_richness=100),), spacing=1
)
WILD = MapSpec(config=MapConfig(size=100, houses=5, storeys=(1, 3), vegetation=0.7, relief=1.3), seed=8)
BOX_FACES = ((0, 1, 2, 3), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(low: Sequence[float], high: Sequence[float], kind: Kind = Kind.WALL) -> Solid:
    """An upright box from its least to its greatest corner."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    bottom = [(x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1)]
    top = [(x, y1, z) for x, _, z in bottom]
    return convex_solid(kind, np.array(bottom + top, float), BOX_FACES)


def flat_world(
    size: int = 40, solids: Sequence[Solid] = (), slope: float = 0.0, water: float = -np.inf
) -> World:
    """A square world about the origin, level or rising eastwards, with solids on it."""
    cells = int(size / CELL)
    east = np.arange(cells + 1) * CELL - size / 2
    heights = np.tile(east * slope, (cells + 1, 1))
    spots = np.array([[x, x * slope, z] for x in range(-15, 16, 6) for z in range(-15, 16, 6)], float)
    surface = np.full((cells, cells), water)
    return build_world((-size / 2, -size / 2), heights, surface, solids, spots)


def map_from(world: World, indoor: Sequence[Sequence[float]] = ()) -> GameMap:
    """A map around a world made by hand."""
    size = round(-2 * world.corner[0])
    spec = MapSpec(config=MapConfig(size=size, houses=0))
    inside = np.array(indoor, float).reshape(-1, 3)
    houses = np.full(len(world.solid_kind), -1, np.int16)
    return GameMap(spec, world, (), inside, world.spawns.copy(), houses)


def random_map_config(seed: int, *, steepest: float) -> MapConfig:
    """Return a kind of map drawn by a seed, with at most so much relief."""
    dice = RandomStream(seed, Stream.HOUSES)
    return MapConfig(
        size=2 * dice.integer(30, 60),
        houses=dice.integer(0, 4),
        storeys=((1, 4), (1, 2), (2, 3))[seed % 3],
        density=("low", "high")[seed % 2],
        relief=dice.uniform(0.3, steepest),
        ruggedness=dice.uniform(),
        water=dice.uniform(0.0, 0.25),
        vegetation=dice.uniform(),
    )


def make_match(track: str = "battle", world: World | None = None, seats: int = 1, **spec: Any) -> Match:
    """A match on a small flat map."""
    return Match(
        MatchSpec(track=track, seats=("submission",) * seats, **spec), map_from(world or flat_world())
    )


def duel(world: World | None = None, **spec: Any) -> Match:
    """A battle in which seat 0 looks north at seat 1, ten metres away, who looks back."""
    match = make_match(world=world, seats=2, **spec)
    place(match, 0, (0, 0, 0))
    place(match, 1, (0, 0, 10), yaw=180)
    return match


def place(match: Match, seat: int, position: Sequence[float], yaw: float = 0.0, pitch: float = 0.0) -> None:
    """Put an agent somewhere, looking somewhere."""
    agents = match.state.agents
    agents.position[0, seat] = position
    agents.yaw[0, seat], agents.pitch[0, seat] = yaw, pitch


def lay_boxes(
    match: Match, *places: Sequence[float], quantity: int | Sequence[int] = 3, serial: int = 0
) -> None:
    """Lay exactly these boxes, in the first slots."""
    supplies = match.state.supplies
    supplies.quantity[:] = 0
    count = len(places)
    supplies.position[0, :count] = np.array(places).reshape(-1, 3)
    supplies.quantity[0, :count] = quantity
    supplies.appears[0, :count] = 0
    supplies.serial[0, :count] = np.arange(serial, serial + count)
    index_boxes_of(match)


def facts_of(match: Match) -> NDArray[np.float32]:
    """The facts about the agents of a match, (A, FACTS), that rewards are made of."""
    facts = np.zeros((1, match.seats, FACTS), np.float32)
    write_facts(match.state.agents, match.state.matches, facts)
    return facts[0]


def paid_between(
    before: NDArray[np.float32], after: NDArray[np.float32], **weights: float
) -> dict[str, list[float]]:
    """What each seat is paid for a step from its facts (A, FACTS) before and after, by term."""
    arrays, paid = RewardSum(weights).term_arrays, np.zeros((len(after), len(weights)), np.float32)
    for seat, values in enumerate(paid):
        write_terms(arrays, before[seat], after[seat], values)
    return dict(zip(weights, paid.T.tolist(), strict=True))


def index_boxes_of(match: Match) -> None:
    """Let boxes be found that were laid by hand."""
    supplies = Supplies(*(array[0] for array in match.state.supplies))
    index_boxes(match.game_map.world, supplies, match.state.matches, 0)


def seen_now(match: Match) -> Seen:
    """What everybody sees of a state that was changed by hand since the last step."""
    match._batch._seen_now.clear()
    return match.seen


def position(match: Match, seat: int = 0) -> NDArray[np.float64]:
    """Return (3,) m where a seat is."""
    return np.asarray(match.state.agents.position[0, seat]).copy()


def act(match: Match, steps: int = 1, **seats: dict[str, float]) -> None:
    """Play steps in which the named seats (``seat_0={"walk_speed": 5}``) do the same again and again."""
    rows: NDArray[np.float32] = np.zeros((match.seats, FIELDS), np.float32)
    for name, fields in seats.items():
        for field, value in fields.items():
            rows[int(name.removeprefix("seat_")), Field[field.upper()]] = value
    index_boxes_of(match)
    for _ in range(steps):
        match.step(rows)
