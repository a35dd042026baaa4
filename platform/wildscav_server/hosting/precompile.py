"""Compile all kernels that a match runs, or load them from the cache, before they are needed."""

import functools
import threading
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any

from wildscav_server.hosting.observations import SeatObservations

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.sensors import Sensor
    from wildscav_engine.simulation.match import Match

_lock = threading.Lock()
_read: set["Sensor"] = set()


def precompile(sensors: "Iterable[Sensor] | None" = None) -> None:
    """Play a tiny match of every track, once per process, and read each sensor once; None: all of them.

    Kernels are compiled (or loaded from the cache) when they first run. In the event loop, that would delay
    all other matches, and the time would be charged to their agents.
    """
    with _lock:
        match = _tiny_match()
        for sensor in every_sensor() if sensors is None else sensors:
            if sensor not in _read:
                sensor.read(match, [0])
                _read.add(sensor)


def precompile_for(submissions: "Iterable[Mapping[str, Any]]") -> None:
    """Precompile the sensors of submissions; each has their options by name."""
    from wildscav_engine.sensors import parse_sensors

    precompile([sensor for sensors in submissions for sensor in parse_sensors(sensors).values()])


def every_sensor() -> "list[Sensor]":
    """Return sensors that together run all kernels of every kind of sensor."""
    from wildscav_engine.sensors import SENSORS

    return [sensor for kind in SENSORS.values() for sensor in kind.warmers()]


@functools.cache
def _tiny_match() -> "Match":
    """Play a match of each track, and return the last one."""
    import numpy as np

    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.actions import Field, no_actions
    from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
    from wildscav_engine.tracks import TRACKS

    # Loading a cached map would not compile the generator.
    game_map = small_map()
    for name, track in TRACKS.items():
        seats = (SUBMISSION, "fighter") if Field.SHOOT in track.fields else (SUBMISSION,)
        match = Match(MatchSpec(track=name, map=game_map.spec, seats=seats, time_limit=0.5), game_map)
        match.start_info(0)
        SeatObservations(match, [0]).encode([0.0])
        while not match.over:
            match.step(no_actions(match.seats) + np.float32(1.0))
        match.result()
    # Results search for the shortest way only where a target was reached.
    game_map.shortest_length(game_map.indoor[0], game_map.outdoor[0], 1.0)
    return match


def small_map() -> "GameMap":
    """Generate a small map with all kinds of objects."""
    from wildscav_engine.maps import generate_map
    from wildscav_engine.specs.map_spec import MapConfig

    return generate_map(MapConfig(size=60, houses=3, density="high", ruggedness=1.0, water=0.1), seed=5)
