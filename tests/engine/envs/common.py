"""What the tests of environments share: small worlds, short matches."""

from typing import Any

import numpy as np

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.tracks import TRACKS

SMALL = MapSpec(config=MapConfig(size=40, houses=1), seed=7)
OPEN = MapSpec(config=MapConfig(size=40, houses=0, relief=0, water=0, vegetation=0), seed=1)
FEW_BOXES = {"waves": [{"center": (0, 0), "radius": 15}], "spacing": 5}
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


TRACK_NAMES = tuple(TRACKS)
