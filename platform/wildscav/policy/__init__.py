"""Policies as agents: the observations and actions of the training environments, from what an agent receives.

Nothing here needs the engine. ``wildscav init --from-policy`` writes how an environment is laid out into a
submission's ``policy.json``; ``Policy`` reads it, turns each ``Observation`` into exactly the arrays that the
environment would have returned, asks the network, and turns its choice into an ``Action``.
"""

from wildscav.policy.environment import Environment
from wildscav.policy.networks import Choose, Network, load_network
from wildscav.policy.policy import Policy, PolicyAgent

__all__ = ["Choose", "Environment", "Network", "Policy", "PolicyAgent", "load_network"]
