"""Sockets that web servers listen on."""

import socket

from wildscav.system.ports import unusable

GRACE = 1  # s for open pages to be closed when a server ends


def listen(host: str, port: int) -> socket.socket:
    """Return a socket that listens on an address; port 0 is any free one.

    Raises:
        UserError: Nothing can listen there.
    """
    try:
        return socket.create_server((host, port), family=socket.AF_INET6 if ":" in host else socket.AF_INET)
    except (OSError, OverflowError) as error:
        raise unusable(host, port, error) from None
