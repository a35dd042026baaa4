"""One server for all rulings on HTTP/2."""

from collections.abc import Iterator

import pytest
from tests.platform.server.http2.peers import Server


@pytest.fixture(scope="package")
def server() -> Iterator[Server]:
    """A server that must have no call open when all its clients are gone."""
    server = Server()
    yield server
    try:
        server.wait_for_calls_to_end()
    finally:
        server.stop()
