"""How gRPC moves bytes: set before it first does."""

import os

VARIABLE = "GRPC_EXPERIMENTS"
# Its event engine hands every message from thread to thread. Without it, the poller that waits for a message
# reads it, too: that takes a quarter of a client's processor time off a step, and a third of a server's. A
# gRPC that does not have these names ignores them.
EXPERIMENTS = "-event_engine_client,-event_engine_listener"


def tune() -> None:
    """Have gRPC poll for itself, unless the environment says otherwise.

    Call it before the first channel or server is made.
    """
    os.environ.setdefault(VARIABLE, EXPERIMENTS)
