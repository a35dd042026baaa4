"""The ids by which Gymnasium and PettingZoo know the environments.

Entry points are strings: nothing is compiled, or imported beyond this file and the libraries themselves,
before an environment is made. The number after ``-v`` rises whenever learning could change.
"""

import gymnasium

from wildscav_engine.extensions import names

VERSION = 0
TRACKS = "wildscav.tracks"


def env_id(track: str) -> str:
    """Return the Gymnasium id of a track."""
    return f"WildScav/{track.capitalize()}-v{VERSION}"


def zoo_id(track: str) -> str:
    """Return the PettingZoo name of a track."""
    return f"wildscav/{track}_v{VERSION}"


def register() -> None:
    """Make the ids known to Gymnasium."""
    for track in names(TRACKS):
        if env_id(track) not in gymnasium.registry:
            gymnasium.register(
                id=env_id(track),
                entry_point="wildscav_engine.envs.single:SingleEnv",
                vector_entry_point="wildscav_engine.envs.vector:VectorArena",
                kwargs={"track": track},
            )


def register_several() -> None:
    """Make the ids known to PettingZoo, which has to be installed."""
    from pettingzoo import parallel_registry
    from pettingzoo import register as enter

    home = "wildscav_engine.envs.parallel"
    for track in names(TRACKS):
        if zoo_id(track).replace("_v", "-v") not in parallel_registry:
            enter("parallel", zoo_id(track), entry_point=f"{home}:parallel_env", kwargs={"track": track})
            enter("aec", zoo_id(track), entry_point=f"{home}:aec_env", kwargs={"track": track})
