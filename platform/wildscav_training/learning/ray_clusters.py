"""Ray clusters: whether something listens at an address, and the token by which a cluster knows its users."""

import os
import socket
from pathlib import Path

from wildscav.errors import UserError

REACH_TIME = 5.0  # s for a connection to the address
TOKEN_FILE = Path("~/.ray/auth_token")  # written by `ray start --head`
TOKEN_VARIABLES = ("RAY_AUTH_TOKEN", "RAY_AUTH_TOKEN_PATH")


def has_token() -> bool:
    """Return whether this user has a token."""
    return any(name in os.environ for name in TOKEN_VARIABLES) or TOKEN_FILE.expanduser().is_file()


def use_token() -> None:
    """Present this user's token to clusters if there is one; Ray asks for it by default but sends none.

    A cluster that asks for no token ignores it. Ray reads this when it is imported.
    """
    if has_token():
        os.environ.setdefault("RAY_AUTH_MODE", "token")


def check_address(address: str, *prefixes: str) -> None:
    """Refuse an address where nothing listens, for which Ray would wait a minute.

    Args:
        address: ``HOST:PORT``.
        prefixes: What may stand before it, such as "ray://".

    Raises:
        UserError: It is no address, or nothing listens there.
    """
    bare = address
    for prefix in prefixes:
        bare = bare.removeprefix(prefix)
    host, _, port = bare.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65_536 or "/" in host:
        allowed = " or ".join(f"{prefix}HOST:PORT" for prefix in ("", *prefixes))
        raise UserError(f"--address {address} is no address of a Ray cluster: must be {allowed}", exit_code=2)
    try:
        socket.create_connection((host.strip("[]"), int(port)), REACH_TIME).close()
    except OSError as error:
        raise UserError(f"there is no Ray cluster at {address}: {error.strerror or error}") from None
