"""The ids by which Gymnasium and PettingZoo know the environments.

Entry points are strings: nothing is compiled, or imported beyond this file and the libraries themselves,
before an environment is made. The number after ``-v`` rises whenever learning could change.
"""

from itertools import product
from typing import Literal, get_args

import gymnasium

from wildscav_engine.extensions import names

Version = Literal[0, 1]
VERSIONS: tuple[Version, ...] = get_args(Version)
VERSION = VERSIONS[-1]  # the default of environments without an id, too
TRACKS = "wildscav.tracks"


def env_id(track: str, version: int = VERSION) -> str:
    """Return the Gymnasium id of a track."""
    return f"WildScav/{track.capitalize()}-v{version}"


def zoo_id(track: str, version: int = VERSION) -> str:
    """Return the PettingZoo name of a track."""
    return f"wildscav/{track}_v{version}"


def register() -> None:
    """Make the ids known to Gymnasium."""
    for track, version in product(names(TRACKS), VERSIONS):
        if env_id(track, version) not in gymnasium.registry:
            gymnasium.register(
                id=env_id(track, version),
                entry_point="wildscav_engine.envs.single:SingleEnv",
                vector_entry_point="wildscav_engine.envs.vector:VectorArena",
                kwargs={"track": track, "version": version},
                order_enforce=False,  # the environments check both themselves
                disable_env_checker=True,
            )


def register_several() -> None:
    """Make the ids known to PettingZoo, which has to be installed."""
    from pettingzoo import parallel_registry
    from pettingzoo import register as enter

    home = "wildscav_engine.envs.parallel"
    for track, version in product(names(TRACKS), VERSIONS):
        name, options = zoo_id(track, version), {"track": track, "version": version}
        if name.replace("_v", "-v") not in parallel_registry:
            enter("parallel", name, entry_point=f"{home}:parallel_env", kwargs=options)
            enter("aec", name, entry_point=f"{home}:aec_env", kwargs=options)
