"""Compiling the engine before the first match, so that no agent's clock runs while it happens."""

import numpy as np


def warm() -> None:
    """Play a few steps of every track on a tiny map, with every sensor, and keep nothing.

    Numba compiles what is called, for the types that it is called with, and writes it to the cache: every
    process that comes later only loads it.
    """
    from wildscav.server.warm import warm_map
    from wildscav_engine.actions import Field, no_actions
    from wildscav_engine.maps.mesh import solids_mesh
    from wildscav_engine.match import Match
    from wildscav_engine.sensors import SENSORS
    from wildscav_engine.spec import SUBMISSION, MatchSpec
    from wildscav_engine.tracks import TRACKS

    game_map = warm_map()
    for track in TRACKS:
        seats = (SUBMISSION, "fighter") if TRACKS[track].fields >= {Field.SHOOT} else (SUBMISSION,)
        spec = MatchSpec(track=track, map=game_map.spec, seats=seats, time_limit=0.5)
        match = Match(spec, game_map)
        while not match.over:
            match.step(no_actions(match.seats) + np.float32(1.0))
        match.start_info(0)
        for kind in SENSORS.values():
            for sensor in kind.warmers():
                sensor.read(match, [0])
        match.result()
    solids_mesh(match.game_map.world)
