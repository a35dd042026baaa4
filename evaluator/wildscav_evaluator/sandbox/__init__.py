"""Sandboxes: the ways to run an agent. One file each, all behind one interface."""

from wildscav_evaluator.sandbox.base import Ending, Launch, Promise, RunningAgent, Sandbox, SandboxError
from wildscav_evaluator.sandbox.containers.oci import OciSandbox
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits
from wildscav_evaluator.sandbox.linux.bubblewrap import BubblewrapSandbox
from wildscav_evaluator.sandbox.process import ProcessSandbox

SANDBOXES: dict[str, Sandbox] = {
    "oci": OciSandbox(),
    "bubblewrap": BubblewrapSandbox(),
    "process": ProcessSandbox(),
}

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
