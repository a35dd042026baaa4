"""What can be wrong with a submission's ``policy.json``, or with what its network returns."""

from wildscav.errors import AgentError


class PolicyError(AgentError):
    """A policy's file cannot be used, or its network does not fit it; the message says what is wrong."""
