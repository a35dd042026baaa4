"""Compile what a match runs before anybody waits for it."""

import functools
import threading
from collections.abc import Iterable
from typing import TYPE_CHECKING

from wildscav.server.hosting.observations import SeatObservations

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.simulation.match import Match

_lock = threading.Lock()
_warmed: set["Sensor"] = set()


def warm(sensors: "Iterable[Sensor] | None" = None) -> None:
    """Play a tiny match, once a process, and read sensors in it, each once.

    Kernels compile (or load from their cache) when they first run. In the event loop that would hold up every
    other match, and its agents would pay for it from their time.

    Args:
        sensors: Which ones; by default every kind with every choice that it offers.
    """
    with _lock:
        match = _tiny_match()
        for sensor in every_sensor() if sensors is None else sensors:
            if sensor not in _warmed:
                sensor.read(match, [0])
                _warmed.add(sensor)


def every_sensor() -> "list[Sensor]":
    """Return sensors that between them run all kernels of all kinds."""
    from wildscav_engine.sensors import SENSORS

    return [sensor for kind in SENSORS.values() for sensor in kind.warmers()]


@functools.cache
def _tiny_match() -> "Match":
    """Return a match that was played to its end."""
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.actions import no_actions
    from wildscav_engine.specs.match_spec import MatchSpec

    game_map = warm_map()
    match = Match(MatchSpec(track="navigation", map=game_map.spec, time_limit=0.1), game_map)
    match.start_info(0)
    SeatObservations(match, [0]).encode([0.0])
    match.step(no_actions(1))
    match.result()
    return match


def warm_map() -> "GameMap":
    """Make a small map with a little of everything, anew: one that was kept on disk would warm nothing."""
    from wildscav_engine.maps import generate_map
    from wildscav_engine.specs.map_spec import MapConfig

    return generate_map(MapConfig(size=60, houses=3, density="high", ruggedness=1.0, water=0.1), seed=5)
