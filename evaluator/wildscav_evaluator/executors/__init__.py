"""Executors: where matches are played and records are played again, on this machine or on a cluster."""

from typing import Any

from wildscav_engine.extensions import Registry
from wildscav_evaluator.executors.base import Examined, Executor, ExecutorError, Node, Players

__all__ = ["EXECUTORS", "Examined", "Executor", "ExecutorError", "Node", "Players"]

PARTS = ("name", "at_once", "nodes", "examine", "choose_sandbox", "players", "map", "__enter__", "__exit__")


def check_executor(name: str, kind: Any) -> type[Executor]:
    """Return the class of an executor that an entry point names; ValueError if it is none of that name."""
    missing = [part for part in PARTS if not hasattr(kind, part)]
    if missing or not isinstance(kind, type):
        raise ValueError(f"it is no class of an executor: it has no {', '.join(missing) or 'objects'}")
    executor: type[Executor] = kind
    if executor.name != name:
        raise ValueError(f"its class is called {executor.name!r}")
    return executor


# The first is the default.
EXECUTORS: Registry[type[Executor]] = Registry(
    "wildscav.executors",
    {
        "local": "wildscav_evaluator.executors.local:LocalExecutor",
        "ray": "wildscav_evaluator.executors.ray_executor:RayExecutor",
    },
    check_executor,
)
