"""What an agent needs: ``from wildscav import Agent, Action, MatchInfo, Observation, run``."""

from wildscav.errors import WildscavError
from wildscav.sdk.agent import (
    Action,
    Agent,
    MatchInfo,
    Observation,
    SupplyBox,
    SupplyWave,
    Vector,
    VisibleAgent,
)
from wildscav.sdk.run import run

__version__ = "0.1.0"

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
    "run",
]
