"""What an agent needs: ``from wildscav import Agent, Action, MatchInfo, Observation, run``."""

from wildscav.agent import (
    Action,
    Agent,
    MatchInfo,
    Observation,
    SupplyBox,
    SupplyWave,
    Vector,
    VisibleAgent,
)
from wildscav.errors import WildscavError
from wildscav.grpc_settings import tune_grpc
from wildscav.sdk.run import run
from wildscav.version import __version__

__all__ = [
    "Action",
    "Agent",
    "MatchInfo",
    "Observation",
    "SupplyBox",
    "SupplyWave",
    "Vector",
    "VisibleAgent",
    "WildscavError",
    "__version__",
    "run",
]

tune_grpc()  # here, because every module that imports gRPC is in this package or imports it first
