"""Compile what a match runs before anybody waits for it."""

import threading
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap

_lock = threading.Lock()
_warmed: list[bool] = []


def warm() -> None:
    """Play a tiny match with every sensor, once a process.

    Kernels compile (or load from their cache) when they first run. In the event loop that would hold up every
    other match, and its agents would pay for it from their time.
    """
    from wildscav_engine.actions import no_actions
    from wildscav_engine.match import Match
    from wildscav_engine.sensors import SENSORS
    from wildscav_engine.spec import MatchSpec

    with _lock:
        if _warmed:
            return
        game_map = warm_map()
        match = Match(MatchSpec(track="navigation", map=game_map.spec, time_limit=0.1), game_map)
        match.start_info(0)
        for kind in SENSORS.values():
            for sensor in kind.warmers():
                sensor.read(match, [0])
        match.step(no_actions(1))
        match.result()
        _warmed.append(True)


def warm_map() -> "GameMap":
    """Make a small map with a little of everything, anew: one that was kept on disk would warm nothing."""
    from wildscav_engine.maps import generate_map
    from wildscav_engine.spec import MapConfig

    return generate_map(MapConfig(size=60, houses=3, density="high", ruggedness=1.0, water=0.1), seed=5)
