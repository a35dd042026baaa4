"""Errors in a submission's ``policy.json`` or in its network's outputs."""

from wildscav.errors import AgentError


class PolicyError(AgentError):
    """A policy's file cannot be used, or its network does not fit it."""
