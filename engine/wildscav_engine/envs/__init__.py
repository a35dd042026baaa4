"""Environments: Gymnasium for one learner, PettingZoo and batched arrays for several."""

import sys
from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from wildscav_engine.envs.registry import register, register_several

if TYPE_CHECKING:
    from wildscav_engine.envs.batched import BatchedArena
    from wildscav_engine.envs.curriculum import AdaptiveOptions, Curriculum
    from wildscav_engine.envs.description import describe
    from wildscav_engine.envs.league import League
    from wildscav_engine.envs.parallel import ParallelArena, aec_env, parallel_env
    from wildscav_engine.envs.settings.config import EnvConfig
    from wildscav_engine.envs.settings.functions import Learners
    from wildscav_engine.envs.settings.options import EnvOptions, EpisodeOptions
    from wildscav_engine.envs.settings.players import PolicyOpponent, Sampler, SeatController, StatefulPolicy
    from wildscav_engine.envs.settings.presets import PRESETS
    from wildscav_engine.envs.single import SingleEnv
    from wildscav_engine.envs.stable_baselines import StableVector
    from wildscav_engine.envs.vector import VectorArena
    from wildscav_engine.envs.wrappers import FlatActions, FlatObservations

_MODULES = {
    "AdaptiveOptions": "curriculum",
    "BatchedArena": "batched",
    "Curriculum": "curriculum",
    "EnvConfig": "settings.config",
    "EnvOptions": "settings.options",
    "EpisodeOptions": "settings.options",
    "Learners": "settings.functions",
    "League": "league",
    "PolicyOpponent": "settings.players",
    "Sampler": "settings.players",
    "SeatController": "settings.players",
    "StatefulPolicy": "settings.players",
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
    "AdaptiveOptions",
    "BatchedArena",
    "Curriculum",
    "EnvConfig",
    "EnvOptions",
    "EpisodeOptions",
    "FlatActions",
    "FlatObservations",
    "League",
    "Learners",
    "PolicyOpponent",
    "Sampler",
    "SeatController",
    "SingleEnv",
    "StatefulPolicy",
    "VectorArena",
    "describe",
]
# `from wildscav_engine.envs import *` imports these only if their optional libraries are installed.
if find_spec("pettingzoo"):
    __all__ += ["ParallelArena", "aec_env", "parallel_env"]
if find_spec("stable_baselines3"):
    __all__ += ["StableVector"]

# Importing this package registers the ids. Those of PettingZoo are registered only if it is already imported;
# otherwise, importing ``parallel`` does it.
register()
if sys.modules.get("pettingzoo"):
    register_several()


def __getattr__(name: str) -> Any:
    """Import the module of a name on first use, so that importing this package costs little."""
    if name not in _MODULES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_MODULES[name]}"), name)
