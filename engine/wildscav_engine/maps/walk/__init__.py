"""Where a body can go: the walkable graph of a map, reachability, and shortest paths."""

from wildscav_engine.maps.walk.graph import WalkGraph, build_graph
from wildscav_engine.maps.walk.paths import Leg, Path, find_path, is_reached, leads_out, node_near
from wildscav_engine.maps.walk.shortest import shortest_length, straight_length

__all__ = [
    "Leg",
    "Path",
    "WalkGraph",
    "build_graph",
    "find_path",
    "is_reached",
    "leads_out",
    "node_near",
    "shortest_length",
    "straight_length",
]
