"""Metrics over HTTP, for Prometheus on the same machine."""

from collections.abc import Iterator
from contextlib import contextmanager

from prometheus_client import CollectorRegistry, start_http_server
from prometheus_client.registry import Collector

from wildscav.errors import UserError

HOST = "127.0.0.1"


@contextmanager
def serving_metrics(collector: Collector, port: int | None) -> Iterator[str | None]:
    """Serve metrics to this machine, at a free port for 0 and not at all for None, until the block ends.

    Yields:
        The URL of the metrics, or None if they are not served.

    Raises:
        UserError: The port cannot be bound.
    """
    if port is None:
        yield None
        return
    registry = CollectorRegistry()
    registry.register(collector)
    try:
        server, thread = start_http_server(port, HOST, registry)
    except OSError as error:
        raise UserError(f"--metrics-port {port} cannot be used: {error.strerror}", exit_code=2) from error
    try:
        yield f"http://{HOST}:{server.server_port}/metrics"
    finally:
        server.shutdown()
        server.server_close()
        thread.join()
