"""Sandboxes: the ways to run an agent, one file each, behind one interface (``base.py``)."""

from typing import Any

from wildscav_engine.extensions import Registry
from wildscav_evaluator.sandbox.base import Ending, Launch, Promise, RunningAgent, Sandbox, SandboxError
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits

__all__ = [
    "DEFAULT_LIMITS",
    "SANDBOXES",
    "Ending",
    "Launch",
    "Limits",
    "Promise",
    "RunningAgent",
    "Sandbox",
    "SandboxError",
]


def make_sandbox(name: str, kind: Any) -> Sandbox:
    """Return the sandbox of the class that an entry point names; ValueError if it is none of that name."""
    missing = [
        part for part in ("name", "isolated", "runs_images", "promises", "start") if not hasattr(kind, part)
    ]
    if missing or not isinstance(kind, type):
        raise ValueError(f"it is no class of a sandbox: it has no {', '.join(missing) or 'objects'}")
    sandbox: Sandbox = kind()
    if sandbox.name != name:
        raise ValueError(f"its class is called {sandbox.name!r}")
    return sandbox


# The strongest first. Sandboxes of other packages are used only when they are asked for by name.
SANDBOXES: Registry[Sandbox] = Registry(
    "wildscav.sandboxes",
    {
        "oci": "wildscav_evaluator.sandbox.containers.oci:OciSandbox",
        "bubblewrap": "wildscav_evaluator.sandbox.linux.bubblewrap:BubblewrapSandbox",
        "process": "wildscav_evaluator.sandbox.process:ProcessSandbox",
    },
    make_sandbox,
)
