"""Trained policies as agents: the training environments' observations and actions, without the engine.

``wildscav init --from-policy`` describes the environment in a submission's ``policy.json``. ``Policy`` reads
that file, turns each ``Observation`` into exactly the arrays that the environment would have returned, runs
the network, and turns its choice into an ``Action``.
"""

from wildscav.policy.environment import Environment
from wildscav.policy.networks import Choose, Network, load_network
from wildscav.policy.policy import Policy, PolicyAgent

__all__ = ["Choose", "Environment", "Network", "Policy", "PolicyAgent", "load_network"]
