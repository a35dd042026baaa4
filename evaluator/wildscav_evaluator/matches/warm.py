"""Compiling the engine before the first match, so that no agent's clock runs while it happens."""

from collections.abc import Sequence
from typing import Any

import numpy as np

Wanted = dict[str, dict[str, Any]]  # sensors by name, with their options


def warm(sensors: Sequence[Wanted] = ()) -> None:
    """Play a few steps of every track on a tiny map, read some sensors there, and keep nothing.

    Numba compiles what is called, for the types that it is called with, and writes it to the cache: every
    process that comes later only loads it.

    Args:
        sensors: What will be read in matches, for each submission.
    """
    from wildscav.server.hosting.observations import SeatObservations
    from wildscav.server.hosting.warm_up import warm_map
    from wildscav_engine.maps.export.mesh import solids_mesh
    from wildscav_engine.sensors import parse_sensors
    from wildscav_engine.simulation.match import Match
    from wildscav_engine.specs.actions import Field, no_actions
    from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
    from wildscav_engine.tracks import TRACKS

    game_map = warm_map()
    for track in TRACKS:
        seats = (SUBMISSION, "fighter") if Field.SHOOT in TRACKS[track].fields else (SUBMISSION,)
        spec = MatchSpec(track=track, map=game_map.spec, seats=seats, time_limit=0.5)
        match = Match(spec, game_map)
        while not match.over:
            match.step(no_actions(match.seats) + np.float32(1.0))
        match.start_info(0)
        SeatObservations(match, [0]).encode([0.0])
        match.result()
    for wanted in sensors:
        for sensor in parse_sensors(wanted).values():
            sensor.read(match, [0])
    solids_mesh(match.game_map.world)
