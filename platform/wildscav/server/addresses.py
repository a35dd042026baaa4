"""Addresses to listen on: ``unix:/path`` or ``host:port``."""

import contextlib
import errno
import ipaddress
import socket
from pathlib import Path

from wildscav.errors import AddressInUseError, UserError

UNIX = "unix:"
LAST_PORT = 65_535
PATH_LIMIT = 107  # bytes, of a unix socket's path on Linux


def check_free(address: str) -> None:
    """Find out whether an address can be listened on: gRPC's own errors do not say what is wrong.

    Raises:
        AddressInUseError: Somebody listens there, or the address is not this machine's.
        UserError: It is malformed.
    """
    if address.startswith(UNIX):
        _check_path_free(address, Path(address.removeprefix(UNIX).removeprefix("//")))
    else:
        _check_port_free(address)


def _check_path_free(address: str, path: Path) -> None:
    if len(str(path).encode()) > PATH_LIMIT:
        raise UserError(f"{address}: the path of a socket has {PATH_LIMIT} bytes at most", exit_code=2)
    if not path.parent.is_dir():
        raise UserError(f"{address}: there is no folder {path.parent}", exit_code=2)
    if not path.exists():
        return
    with socket.socket(socket.AF_UNIX) as probe:
        if not path.is_socket() or probe.connect_ex(str(path)) == 0:
            raise AddressInUseError(address)


def _check_port_free(address: str) -> None:
    host, port = split(address)
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        family, kind, protocol, _, where = found[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            probe.bind(where)
            # Two sockets may be bound with SO_REUSEADDR, but only one may listen.
            probe.listen()
    except OSError as error:
        reason = "it is in use already" if error.errno == errno.EADDRINUSE else error.strerror or str(error)
        raise AddressInUseError(address, reason) from None


def split(address: str) -> tuple[str, int]:
    """Return the host and the port of ``host:port`` or ``[host]:port``.

    Raises:
        UserError: It is malformed.
    """
    host, colon, port = address.rpartition(":")
    if not colon or not host or not port.isdecimal() or int(port) > LAST_PORT:
        raise UserError(f"address is {address!r}, must be HOST:PORT or unix:/PATH", exit_code=2)
    return host.removeprefix("[").removesuffix("]"), int(port)


def with_port(address: str, port: int) -> str:
    """Return an address with the port that was really taken."""
    return address if address.startswith(UNIX) else f"{address.rpartition(':')[0]}:{port}"


def is_public(address: str) -> bool:
    """Return whether other machines can reach an address."""
    if address.startswith(UNIX):
        return False
    host, _ = split(address)
    if host == "localhost":
        return False
    with contextlib.suppress(ValueError):
        return not ipaddress.ip_address(host).is_loopback
    return True
