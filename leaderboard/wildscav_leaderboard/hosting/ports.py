"""Ports of this machine."""

import socket

from wildscav.errors import UserError, describe


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
        except OSError as error:
            raise UserError(f"port {port} of {host} cannot be used: {describe(error)}") from error
        return int(probe.getsockname()[1])
