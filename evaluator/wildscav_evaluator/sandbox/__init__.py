"""Sandboxes: the ways to run an agent. One file each, all behind one interface."""

from wildscav_evaluator.sandbox.base import Launch, RunningAgent, Sandbox
from wildscav_evaluator.sandbox.process import ProcessSandbox

SANDBOXES: dict[str, Sandbox] = {
    "process": ProcessSandbox(),
}

__all__ = ["SANDBOXES", "Launch", "RunningAgent", "Sandbox"]
