"""Where a body can go: the walkable graph of a map, reachability, and shortest paths."""

import warnings
from typing import Any

from wildscav_engine.maps.walk.graph import NavGraph, build_graph
from wildscav_engine.maps.walk.paths import Leg, Path, find_path, is_reached, leads_out, node_near
from wildscav_engine.maps.walk.shortest import shortest_length, straight_length

__all__ = [
    "Leg",
    "NavGraph",
    "Path",
    "build_graph",
    "find_path",
    "is_reached",
    "leads_out",
    "node_near",
    "shortest_length",
    "straight_length",
]


def __getattr__(name: str) -> Any:
    """Return a name by its old spelling, for one release."""
    if name != "WalkGraph":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn("WalkGraph is called NavGraph now", DeprecationWarning, stacklevel=2)
    return NavGraph
