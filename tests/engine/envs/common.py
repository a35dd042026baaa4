"""What the tests of environments share: small worlds, short matches."""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium.vector import AutoresetMode

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.tracks import TRACKS

SMALL = MapSpec(config=MapConfig(size=40, houses=1), seed=7)
OPEN = MapSpec(config=MapConfig(size=40, houses=0, relief=0, water=0, vegetation=0), seed=1)
FEW_BOXES = {"waves": [{"center": (0, 0), "radius": 15}], "spacing": 5}
# It comes to its first place after 0.2 s.
HOT_SPOT = {"hot_spot": {"start": 0.2, "interval": 1.0, "places": 2, "boxes": 2}}
# Short enough to reach the end, with few opponents.
OPTIONS: dict[str, dict[str, Any]] = {
    "navigation": {},
    "gathering": {"supplies": FEW_BOXES},
    "capture": {},
    "battle": {"supplies": FEW_BOXES, "opponents": ("fighter", "walker")},
    "royale": {"supplies": FEW_BOXES, "opponents": ("fighter", "fighter")},
}


def options(track: str, **more: Any) -> dict[str, Any]:
    """Options of a single environment of a track."""
    return {"map": SMALL, "time_limit": 1.5, **OPTIONS[track], **more}


def many_options(track: str, **more: Any) -> dict[str, Any]:
    """Options of an environment of a track for three learners."""
    alone = {name: value for name, value in OPTIONS[track].items() if name != "opponents"}
    return {"map": SMALL, "time_limit": 1.5, "agents": 3, **alone, **more}


def env_id(track: str) -> str:
    return f"wildscav_engine.envs:WildScav/{track.capitalize()}-v1"


def digest(value: Any) -> Any:
    """Return something to compare byte for byte: arrays as their bytes, dictionaries in order."""
    if isinstance(value, dict):
        return {key: digest(value[key]) for key in sorted(value, key=str)}
    if isinstance(value, list | tuple):
        return [digest(item) for item in value]
    if isinstance(value, np.ndarray):
        if value.dtype == object:
            return [digest(item) for item in value]
        return (value.dtype.str, value.shape, value.tobytes())
    return value


def batch_of(env: Any) -> Any:
    """The matches that an environment plays."""
    return env.arena.batch


def play_alike(ours: Any, theirs: Any, steps: int = 20, before: Callable[[int], None] | None = None) -> None:
    """Play the same with two vector environments, and check that they tell the same, byte for byte."""
    assert digest(ours.reset(seed=5)) == digest(theirs.reset(seed=5))
    ours.action_space.seed(1)
    for step in range(steps):
        if before is not None:
            before(step)
        actions = ours.action_space.sample()
        one, other = ours.step(actions), theirs.step(actions)
        assert ours.observation_space.contains(one[0])
        assert digest(one) == digest(other)
        ended = one[2] | one[3]
        if ours.metadata["autoreset_mode"] == AutoresetMode.DISABLED and ended.any():
            resets = [env.reset(options={"reset_mask": ended.copy()}) for env in (ours, theirs)]
            assert digest(resets[0]) == digest(resets[1])


TRACK_NAMES = tuple(TRACKS)
