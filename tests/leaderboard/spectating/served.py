"""Real servers of small applications, for a browser or a client."""

import socket
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn
from starlette.types import ASGIApp

# s that a connection may be idle. On a busy machine, uvicorn's 5 s may pass between two requests:
# it is closed just when a client sends the next one.
IDLE = 3600


@contextmanager
def served(app: ASGIApp) -> Iterator[str]:
    """Serve an application on a free port, and give the address of its root."""
    config = uvicorn.Config(app, log_level="error", lifespan="off", timeout_keep_alive=IDLE)
    with running(config) as (host, port):
        yield f"http://{host}:{port}"


@contextmanager
def running(config: uvicorn.Config) -> Iterator[tuple[str, int]]:
    """Run a server on a free port, and give its host and port."""
    with socket.create_server(("127.0.0.1", 0), backlog=100) as listening:
        server = uvicorn.Server(config)
        thread = threading.Thread(target=server.run, args=([listening],))
        thread.start()
        while not server.started and thread.is_alive():
            time.sleep(0.01)
        try:
            yield listening.getsockname()
        finally:
            server.should_exit = True
            thread.join()
