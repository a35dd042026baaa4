"""What an agent needs: ``from wildscav import Agent, Action, MatchInfo, Observation, run``.

The names are imported when they are first used, so that small commands need neither NumPy nor asyncio.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from wildscav.grpc_settings import tune_grpc
from wildscav.version import __version__

if TYPE_CHECKING:
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
    from wildscav.notes import mark, plot, say
    from wildscav.sdk.run import run

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
    "mark",
    "plot",
    "run",
    "say",
]
# Others are in wildscav.agent.
HOMES = {"WildscavError": "wildscav.errors", "run": "wildscav.sdk.run"} | dict.fromkeys(
    ("mark", "plot", "say"), "wildscav.notes"
)

tune_grpc()  # here, because every module that imports gRPC is in this package or imports it first

if not TYPE_CHECKING:  # else mypy would accept any name

    def __getattr__(name: str) -> Any:
        """Import a name."""
        if name not in __all__:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        value = globals()[name] = getattr(import_module(HOMES.get(name, "wildscav.agent")), name)
        return value


def __dir__() -> list[str]:
    """Return all names, imported or not."""
    return sorted({*globals(), *__all__})
