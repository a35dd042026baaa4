"""Addresses: which are refused, and that only what an ended server has left behind is replaced."""

import asyncio
import os
import socket
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from wildscav.errors import AddressInUseError, UserError
from wildscav_server.endpoints.addresses import bind
from wildscav_server.endpoints.endpoint import EndpointSettings
from wildscav_server.match_server import MatchServer
from wildscav_server.workers.shared_server import SharedServer

NOBODY = 65_534


@contextmanager
def as_nobody() -> Iterator[None]:
    """Act as a user without any rights; who is not root already is one."""
    if os.geteuid() != 0:
        yield
        return
    os.seteuid(NOBODY)
    try:
        yield
    finally:
        os.seteuid(0)


def living(state: str, path: Path) -> socket.socket:
    """Return the socket of a server that lives."""
    if state == "not yet accepting":
        (bound,) = bind(f"unix:{path}")
        return bound
    bound = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM if state == "datagrams" else socket.SOCK_STREAM)
    bound.bind(str(path))
    if state != "datagrams":
        bound.listen(0)
    return bound


@pytest.mark.parametrize("state", ["not yet accepting", "queue is full", "datagrams", "no permission"])
def test_a_living_socket_is_never_removed(state: str) -> None:
    with tempfile.TemporaryDirectory() as folder:
        Path(folder).chmod(0o777)
        path = Path(folder, "match.sock")
        with living(state, path), socket.socket(socket.AF_UNIX) as waiting:
            if state == "queue is full":
                waiting.connect(str(path))
            path.chmod(0 if state == "no permission" else 0o777)

            with as_nobody(), pytest.raises(AddressInUseError, match="in use already"):
                bind(f"unix:{path}")

            assert path.is_socket()


def test_a_port_in_use_is_an_error() -> None:
    (bound,) = bind("127.0.0.1:0")
    bound.listen()
    with bound, pytest.raises(AddressInUseError, match="in use"):
        bind(f"127.0.0.1:{bound.getsockname()[1]}")


@pytest.mark.parametrize(
    "address",
    [
        *("50051", "localhost:x", "unix:/no/such/folder/socket", "unix:/tmp/" + "x" * 120),
        *("unix:", "unix:/tmp", f"unix:{__file__}"),
    ],
)
def test_a_malformed_address_is_a_usage_error(address: str) -> None:
    with pytest.raises(UserError) as caught:
        bind(address)
    assert caught.value.exit_code == 2


@pytest.mark.parametrize(
    "server",
    [
        lambda: MatchServer(arena=True, endpoint_settings=EndpointSettings(insecure=True)),
        lambda: SharedServer(1, insecure=True),
    ],
    ids=["alone", "with workers"],
)
def test_an_arena_at_a_public_address_needs_an_organizer_token(
    server: Callable[[], MatchServer | SharedServer],
) -> None:
    async def start() -> None:
        await server().start(["0.0.0.0:0"])

    with pytest.raises(UserError, match="organizer token"):
        asyncio.run(start())


def test_the_socket_of_an_ended_server_is_replaced(tmp_path: Path) -> None:
    path = tmp_path / "match.sock"
    with socket.socket(socket.AF_UNIX) as ended:
        ended.bind(str(path))
        ended.listen()

    (bound,) = bind(f"unix:{path}")

    with bound, socket.socket(socket.AF_UNIX) as client:
        client.connect(str(path))
