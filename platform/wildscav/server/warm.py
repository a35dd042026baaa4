"""Compile what a match runs before anybody waits for it."""

import threading

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
    from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec

    with _lock:
        if _warmed:
            return
        small = MapSpec(config=MapConfig(size=40, houses=0))
        match = Match(MatchSpec(track="navigation", map=small, time_limit=0.1))
        match.start_info(0)
        for sensor in SENSORS.values():
            sensor.read(match, [0], sensor.parse({}))
        match.step(no_actions(1))
        match.result()
        _warmed.append(True)
