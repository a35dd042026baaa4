"""A short battle, a small map and an environment: the same with compiled kernels and with plain Python.

Run as a script, with NUMBA_DISABLE_JIT=1, it prints what ``report`` returns otherwise.
"""

import json
import sys
import warnings
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[3]))

import numpy as np
from tests.builders import box, flat_world, map_from

from wildscav_engine.compilation.kernel import PLAIN
from wildscav_engine.envs import SingleEnv
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.walk.paths import find_path
from wildscav_engine.sensors import ColorCamera, DepthCamera, Lidar, NormalCamera, SegmentationCamera
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import HotSpot, SupplyConfig, SupplyWave


def report() -> list[object]:
    """Play, and return what came of it."""
    world = flat_world(40, [box((-4, 0, 4), (4, 3, 5))])
    seats = ("submission", "fighter", "gatherer")
    game_map = map_from(world)
    match = Match(MatchSpec(track="battle", map=game_map.spec, seed=5, seats=seats, time_limit=20), game_map)
    actions = np.zeros((len(seats), FIELDS), np.float32)
    actions[0, [Field.WALK_SPEED, Field.TURN, Field.SHOOT, Field.JUMP, Field.PICK_UP]] = 10.0, 3.0, 1, 1, 1
    digests = []
    for _ in range(8):
        match.step(actions)
        digests.append(str(match.digest))
    sensors = (DepthCamera(6, 4), Lidar(), ColorCamera(6, 4), NormalCamera(6, 4), SegmentationCamera(6, 4))
    readings = [float(sensor.read(match, [0]).astype(float).sum()) for sensor in sensors]
    royale = Match(MatchSpec(track="royale", map=game_map.spec, seed=5, seats=("fighter",) * 4), game_map)
    for _ in range(8):
        royale.step()
    digests.append(str(royale.digest))
    digests += _robots(game_map)
    generated = generate_map(MapConfig(size=40, houses=1, vegetation=0.5, water=0.2), 3)
    return [digests, readings, generated.digest, _path(generated), _episode(generated)]


def _robots(game_map: GameMap) -> list[str]:
    """Return the digests of a squad and fighters at a hot spot, and of a search in teams, after a while."""
    hot_spot = HotSpot(interval=1.0, places=2, radius=5.0, boxes=4)
    waves = SupplyConfig(waves=(SupplyWave(center=(0.0, 0.0), radius=15.0),), hot_spot=hot_spot)
    squad, fighters = ("hunter-squad-hard",) * 3, ("fighter-hard",) * 3
    digests = []
    for track, seats, steps in (
        ("battle", squad + fighters, 40),
        ("capture", ("seeker-hard",) * 2 + ("seeker",) * 2, 12),
    ):
        teams = tuple(seat * 2 // len(seats) for seat in range(len(seats)))
        supplies = waves if track == "battle" else None
        match = Match(MatchSpec(track=track, seed=6, seats=seats, teams=teams, supplies=supplies), game_map)
        for _ in range(steps):
            match.step()
        digests.append(str(match.digest))
    return digests


def _path(game_map: GameMap) -> list[float]:
    """Return where a path across a part of a map turns."""
    path = find_path(game_map.graph, *map(tuple, game_map.outdoor[[0, len(game_map.outdoor) // 4]]))
    assert path is not None
    return np.asarray(path.points).ravel().tolist()


def _episode(game_map: GameMap) -> list[float]:
    """Return what a learner observes and is rewarded for in a few steps, in each action mode."""
    found = []
    for mode in ("box", "multidiscrete", "dict"):
        chosen = {"opponents": ("fighter",), "flat": mode != "dict", "sensors": {}, "action_mode": mode}
        env = SingleEnv("battle", map=game_map.spec, **chosen)  # type: ignore[arg-type]
        env.reset(seed=1)
        env.action_space.seed(1)
        for _ in range(3):
            observation, reward, *_ = env.step(env.action_space.sample())
            rows = observation.values() if isinstance(observation, dict) else [observation]
            found += [float(reward), *(float(np.sum(row, dtype=np.float64)) for row in rows)]
    return found


if __name__ == "__main__":
    assert PLAIN
    warnings.simplefilter("ignore", RuntimeWarning)  # NumPy's own numbers complain where words overflow
    sys.stdout.write(json.dumps(report()))
