"""Settings of gRPC's input and output. gRPC reads them when it is imported, so they must be set before."""

import os

VARIABLE = "GRPC_EXPERIMENTS"
# gRPC's event engine hands every message from one thread to another. Without it, the poller that waits for a
# message also reads it: threads are woken half as often, and a step takes a quarter to a third less processor
# time, in a client as well as in a server. Releases of gRPC that do not know these names ignore them.
EXPERIMENTS = "-event_engine_client,-event_engine_listener"


def tune_grpc() -> None:
    """Make gRPC use its poller instead of its event engine, unless the environment variable is set."""
    os.environ.setdefault(VARIABLE, EXPERIMENTS)
