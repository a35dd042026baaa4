"""Ports before and after a server listens on them. This imports little, so a taken port is named at once."""

import errno
import os
import socket

from wildscav.errors import UserError

LONGEST = 1.0  # s to wait for a connection


def check_port(host: str, port: int) -> int:
    """Check that a server can listen on a port, and return its number; for 0, that of a free one.

    Raises:
        UserError: It cannot: something else listens there, or it is not allowed to.
    """
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    with socket.socket(family) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((host, port))
        except (OSError, OverflowError) as error:
            raise unusable(host, port, error) from None
        return int(probe.getsockname()[1])


def is_listening(host: str, port: int) -> bool:
    """Return whether a server accepts connections on a port of this machine."""
    try:
        socket.create_connection((host, port), timeout=LONGEST).close()
    except OSError:
        return False
    return True


def unusable(host: str, port: int, error: OSError | OverflowError) -> UserError:
    """Return an error of a server that cannot listen on a port, in our words."""
    number = getattr(error, "errno", None)
    # Python writes into the reason which address it tried, which is said already.
    reason = os.strerror(number) if number is not None and number > 0 else str(error)
    hint = "; choose another with --port" if number == errno.EADDRINUSE else ""
    return UserError(f"port {port} of {host} cannot be used: {reason}{hint}")
