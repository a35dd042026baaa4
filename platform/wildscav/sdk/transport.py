"""How an agent's gRPC moves bytes: set before it first does."""

import os

VARIABLE = "GRPC_EXPERIMENTS"
# Its event engine hands every message from thread to thread. Without it, the poller that waits for a message
# reads it, too: that takes a quarter of its processor time off a step. (Not for the server: there the event
# engine keeps the limits of connections.) A gRPC that does not have this name ignores it.
EXPERIMENTS = "-event_engine_client"


def tune() -> None:
    """Have gRPC poll for itself, unless the environment says otherwise. Call before the first channel."""
    os.environ.setdefault(VARIABLE, EXPERIMENTS)
