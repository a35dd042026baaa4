"""Addresses to listen on, ``unix:/path`` or ``host:port``, and those of sites."""

import contextlib
import errno
import ipaddress
import re
import socket
from pathlib import Path
from urllib.parse import urlsplit

from wildscav.errors import AddressInUseError, UserError

UNIX = "unix:"
LAST_PORT = 65_535
PATH_LIMIT = 107  # bytes, of a unix socket's path on Linux


def bind(address: str) -> list[socket.socket]:
    """Return sockets that are bound to an address, from which nothing is accepted yet.

    A host name may need several.

    Raises:
        AddressInUseError: Another process listens there, or the address is not this machine's.
        UserError: The address is malformed.
    """
    if address.startswith(UNIX):
        return [_bind_path(address, Path(address.removeprefix(UNIX).removeprefix("//")))]
    return _bind_port(address)


def _bind_path(address: str, path: Path) -> socket.socket:
    if len(str(path).encode()) > PATH_LIMIT:
        raise UserError(f"{address}: the path of a socket may have at most {PATH_LIMIT} bytes", exit_code=2)
    if not path.parent.is_dir():
        raise UserError(f"{address}: there is no folder {path.parent}", exit_code=2)
    if path.exists() and not path.is_socket():
        raise UserError(f"{address}: {path} exists, and is not a socket", exit_code=2)
    if path.exists() and not _is_left_behind(path):
        raise AddressInUseError(address)
    bound = socket.socket(socket.AF_UNIX)
    try:
        path.unlink(missing_ok=True)
        bound.bind(str(path))
        bound.listen()  # so that others see that it is in use, even if its server still starts
    except OSError as error:
        bound.close()
        raise AddressInUseError(address, error.strerror or str(error)) from None
    return bound


def _is_left_behind(path: Path) -> bool:
    """Return whether a file is the socket of a server that has ended.

    The kernel refuses connections to such a socket. Any other error, such as a missing permission or a full
    queue, means that the server lives.
    """
    with socket.socket(socket.AF_UNIX) as probe:
        probe.setblocking(False)
        return probe.connect_ex(str(path)) == errno.ECONNREFUSED


def _bind_port(address: str) -> list[socket.socket]:
    host, port = split(address)
    bound: list[socket.socket] = []
    try:
        places = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        for family, kind, protocol, _, name in dict.fromkeys(places):
            bound.append(socket.socket(family, kind, protocol))
            bound[-1].setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if family == socket.AF_INET6 and len(places) > 1:
                bound[-1].setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            bound[-1].bind((name[0], port, *name[2:]))
            port = bound[-1].getsockname()[1]  # further sockets use the port that the first one got
    except OSError as error:
        for one in bound:
            one.close()
        reason = "it is in use already" if error.errno == errno.EADDRINUSE else error.strerror or str(error)
        raise AddressInUseError(address, reason) from None
    return bound


def split(address: str) -> tuple[str, int]:
    """Return the host and the port of ``host:port`` or ``[host]:port``; a UserError if it is malformed."""
    host, colon, port = address.rpartition(":")
    if not colon or not host or not port.isdecimal() or int(port) > LAST_PORT:
        raise UserError(f"address is {address!r}, must be HOST:PORT or unix:/PATH", exit_code=2)
    return host.removeprefix("[").removesuffix("]"), int(port)


def with_port(address: str, port: int) -> str:
    """Return an address with the port that was actually bound."""
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


def is_site(text: str) -> bool:
    """Return whether a text is the URL of a site, perhaps with a path, to which links can be added."""
    try:
        parts = urlsplit(text)
        has_host = parts.scheme in ("http", "https") and bool(parts.hostname) and parts.port != 0
    except ValueError:
        return False
    return has_host and re.search(r"[\s?#@{}]", text) is None
