"""What is pinned for each version: maps of all kinds, matches of all tracks, and the bytes of a record."""

import base64
import os
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from hashlib import blake2b
from unittest.mock import patch

import numpy as np
from numpy.typing import NDArray
from tests.builders import box, map_from

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import Kind, build_world
from wildscav_engine.maps import GameMap, generate_map, map_spec
from wildscav_engine.maps.base import Base, save_base
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.record.format import RecordError, decode, encode, record_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.map_spec import MapConfig, MapSpec, Placement
from wildscav_engine.specs.match_spec import Equipment, MatchSpec
from wildscav_engine.specs.rules import Rules
from wildscav_engine.specs.supply_config import SupplyConfig, SupplyWave
from wildscav_engine.tracks import TRACKS

Digests = dict[str, str]  # by the name of the case

BY_HAND = (
    Placement(kind="house", location=(10, -10), orientation=30, storeys=2),
    Placement(kind="block", location=(-20, 20), area=(4, 2)),
    Placement(kind="tree", location=(-20, -20), area=(12, 12)),
)
TOWN = MapConfig(size=100, houses=4, density="high", ruggedness=1.0, relief=1.5, water=0.2)
MAPS = {
    "farms": MapSpec(config=MapConfig(size=60, houses=2, storeys=(1, 4)), seed=1),
    "steep town": MapSpec(config=TOWN, seed=2**63),
    "woods": MapSpec(config=MapConfig(size=80, houses=1, vegetation=1.0, placements=BY_HAND), seed=7),
    "lakes": MapSpec(config=MapConfig(size=80, houses=0, water=0.4, relief=0.6), seed=11),
    "plain": MapSpec(config=MapConfig(size=60, houses=3, relief=0.0, water=0.0, vegetation=0.1), seed=3),
    "number 104": map_spec(104),
    "country": MapSpec(config=LEVELS["expert"], seed=1),
}

ROBOT_SEATS = ("fighter", "gatherer-hard", "seeker", "walker-easy", "fighter-hard", "gatherer", "seeker-easy")
STEPS = 120


def map_digests(_: Mapping[str, str]) -> Digests:
    """The digests of maps, one of them on an imported base."""
    digests = {name: generate_map(spec.config, spec.seed).digest for name, spec in MAPS.items()}
    with _imported_island() as base:
        config = MapConfig(size=60, houses=0, vegetation=0.8, base=base)
        digests["imported"] = generate_map(config, 5).digest
    return digests


@contextmanager
def _imported_island() -> Iterator[str]:
    """A hilly island with a block on it as an imported map, and its digest."""
    across = np.abs(np.arange(31) - 15.0)
    heights = 4.0 - 0.02 * (across[:, None] ** 2 + across[None, :] ** 2)
    base = Base(heights, 0.0, (box((-3, 3, 2), (3, 6, 3)),), 60, "island")
    with tempfile.TemporaryDirectory() as folder, patch.dict(os.environ, WILDSCAV_MAPS=folder):
        yield save_base(base)[0]


def match_digests(_: Mapping[str, str]) -> Digests:
    """The digests of matches, by all steps and the result: they are played on a map made by hand."""
    game_map = yard()
    return {spec.track + f" {spec.seed}": _digest_of(_played(spec, game_map)) for spec in _specs()}


def _specs() -> Iterator[MatchSpec]:
    """Two matches of each track, of robots alone and with seats that do all there is; one of dense boxes."""
    rules = Rules(respawn_time=2.0, invincible_time=1.0)
    for track in TRACKS:
        yield MatchSpec(track=track, seed=1, seats=ROBOT_SEATS, time_limit=10.0, rules=rules)
        yield MatchSpec(
            track=track,
            seed=2,
            seats=("submission",) * 4 + ROBOT_SEATS[:4],
            teams=(0, 0, 1, 1, 2, 2, 3, 3),
            starts=((-12.0, 1.0, -10.0), None, None, None, (14.0, 1.0, 20.0), None, None, None),
            equipment=(None, Equipment(health=40, shot_damage=50), *(None,) * 6),
            time_limit=12.0,
            rules=rules,
        )
    dense = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0)),), spacing=2.0)
    yield MatchSpec(track="gathering", seed=3, seats=ROBOT_SEATS[:2], time_limit=10.0, supplies=dense)


def _played(spec: MatchSpec, game_map: GameMap) -> Match:
    match = Match(spec, game_map)
    for step in range(STEPS):
        match.step(_actions(match.seats, step))
    return match


def _actions(seats: int, step: int) -> NDArray[np.float32]:
    """Actions of all kinds, the same for ever: they walk, turn, jump, pick up, shoot and reload."""
    rows = np.zeros((seats, FIELDS), np.float32)
    for seat in range(seats):
        number = seat * 37 + step // 4 * 11
        rows[seat, :4] = number * 29 % 360, number % 11, number % 7 - 3, step % 5 - 2
        rows[seat, 4:8] = number % 3 == 0, 1, number % 5 != 0, number % 13 == 0
    return rows


def _digest_of(match: Match) -> str:
    digest = blake2b(np.array(match.digests, "<u8").tobytes(), digest_size=8)
    digest.update(match.result().model_dump_json().encode())
    return digest.hexdigest()


def yard() -> GameMap:
    """A map that no generator makes: rough ground, a steep hill, a pond, a room, steps, a tree and a rock."""
    row, column = np.mgrid[0:31, 0:31].astype(np.float64)
    heights = 0.1 * ((7.0 * row + 13.0 * column) % 5.0)
    heights += np.maximum(0.0, 8.0 - 1.6 * (abs(column - 22.0) + abs(row - 8.0)))
    heights[20:26, 4:10] -= 1.2
    water = np.full((30, 30), -np.inf)
    water[19:26, 3:10] = 0.1
    solids = [
        *(box((-6, 0, -6), (-5.7, 3, 4)), box((1, 0, -6), (1.3, 3, -2)), box((1, 0, 0), (1.3, 3, 4))),
        *(box((-6, 0, -6.3), (1.3, 3, -6)), box((-6, 0, 4), (1.3, 3, 4.3))),
        box((-5.7, -1, -6), (1, 0.6, 4), Kind.FLOOR),
        box((-6, 3, -6.3), (1.3, 3.3, 4.3), Kind.ROOF),
        *(box((4 + n, -1, 10), (5 + n, 0.5 + 0.4 * n, 13), Kind.STAIR) for n in range(4)),
        *(box((-10, 0, 12), (-9.6, 3, 12.4), Kind.TRUNK), box((-11, 3, 11), (-8.6, 6, 13.4), Kind.CROWN)),
        box((-14, -1, -3), (-12, 1.2, -1), Kind.ROCK),
    ]
    world = build_world((-30.0, -30.0), heights, water, solids, np.zeros((0, 3)))
    spots = [(x, z) for x in range(-26, 27, 4) for z in range(-26, 27, 4) if _is_open(x, z)]
    spawns = [(x, ground_at(world, x, z).height, z) for x, z in spots]
    world = world._replace(spawns=np.array(spawns, np.float64))
    return map_from(world, [(-3.0, 0.601, -4.0), (-3.0, 0.601, 1.0), (-1.0, 0.601, 3.0)])


def _is_open(x: int, z: int) -> bool:
    hill, pond = abs(x - 14) + abs(z + 14) < 14, x < -8 and z > 7
    return not (hill or pond or (-16 < x < 10 and -8 < z < 15))


def record_bytes(pinned: Mapping[str, str]) -> Digests:
    """A record as it is written again after it was read; a new one where none is pinned."""
    if "a match" not in pinned:
        spec = MatchSpec(track="battle", seed=1, seats=("submission", "fighter"), time_limit=0.3)
        match = Match(spec, yard())
        match.play_out()
        data = encode(record_of(match, ["one", "two"]))
    else:
        try:
            data = encode(decode(base64.b64decode(pinned["a match"])))
        except RecordError as error:
            return {"a match": f"cannot be read: {error}"}
    return {"a match": base64.b64encode(data).decode()}
