"""Environments for learners: Gymnasium for one, PettingZoo and batched arrays for several."""

import sys
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from wildscav_engine.envs.registry import register, register_several

if TYPE_CHECKING:
    from wildscav_engine.envs.batched import BatchedArena
    from wildscav_engine.envs.description import describe
    from wildscav_engine.envs.parallel import ParallelArena, aec_env, parallel_env
    from wildscav_engine.envs.settings.config import EnvConfig
    from wildscav_engine.envs.settings.options import EnvOptions
    from wildscav_engine.envs.settings.presets import PRESETS
    from wildscav_engine.envs.single import SingleEnv
    from wildscav_engine.envs.stable_baselines import StableVector
    from wildscav_engine.envs.vector import VectorArena
    from wildscav_engine.envs.wrappers import FlatActions, FlatObservations

_HOMES = {
    "BatchedArena": "batched",
    "EnvConfig": "settings.config",
    "EnvOptions": "settings.options",
    "describe": "description",
    "ParallelArena": "parallel",
    "aec_env": "parallel",
    "parallel_env": "parallel",
    "PRESETS": "settings.presets",
    "SingleEnv": "single",
    "StableVector": "stable_baselines",
    "VectorArena": "vector",
    "FlatActions": "wrappers",
    "FlatObservations": "wrappers",
}

__all__ = [
    "PRESETS",
    "BatchedArena",
    "EnvConfig",
    "EnvOptions",
    "FlatActions",
    "FlatObservations",
    "SingleEnv",
    "VectorArena",
    "describe",
]
# `from wildscav_engine.envs import *` gives what can be imported; these come with optional libraries.
if find_spec("pettingzoo"):
    __all__ += ["ParallelArena", "aec_env", "parallel_env"]
if find_spec("stable_baselines3"):
    __all__ += ["StableVector"]

# Importing this package makes the ids known: PettingZoo's if it is imported already, else with ``parallel``.
register()
if sys.modules.get("pettingzoo"):
    register_several()


def __getattr__(name: str) -> Any:
    """Import what is asked for: to make the ids known costs little."""
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
