"""People who ask for much and read nothing of it: everybody else is answered meanwhile."""

import os
import socket
from collections.abc import Iterator
from contextlib import ExitStack
from urllib.parse import urlsplit

import httpx
import pytest
from tests.leaderboard.filled_season import FilledSeason
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.hosting.app import create_app
from wildscav_leaderboard.visibility import path_of_record

READERS = 100
LARGE = 16 << 20  # bytes, which the buffers of no connection hold


@pytest.fixture
def large_record(hostile_season: FilledSeason) -> Iterator[int]:
    """The number of a public match whose record is large."""
    match = hostile_season.matches["ladder"]
    with hostile_season.database.reading() as session:
        path = path_of_record(session, hostile_season.season, match)
    size = path.stat().st_size
    os.truncate(path, LARGE)
    yield match
    os.truncate(path, size)


def test_pages_are_answered_beside_readers_that_read_nothing(
    hostile_season: FilledSeason, large_record: int
) -> None:
    app = create_app(hostile_season.season, hostile_season.database)
    with served(app) as address, ExitStack() as stack:
        host, port = urlsplit(address).hostname, urlsplit(address).port
        readers = []
        for _ in range(READERS):  # all at once, which are more than there are threads
            reader = stack.enter_context(socket.socket())
            reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            reader.connect((host, port))
            reader.sendall(f"GET /api/v1/matches/{large_record}/record HTTP/1.1\r\nHost: a\r\n\r\n".encode())
            readers.append(reader)
        for path in ("/", "/boards/battle", "/api/v1/matches"):
            assert httpx.get(f"{address}{path}", timeout=20.0).status_code == 200
        assert {reader.recv(12) for reader in readers} == {b"HTTP/1.1 200"}
