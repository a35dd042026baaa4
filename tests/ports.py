"""Free ports for programs that must be told theirs before they start."""

import secrets
import socket

# Below those that systems give to outgoing connections and to whoever asks for any free port: one of those
# could be taken by another test before the program listens on it.
FIRST, LAST = 10_240, 32_768


def free_ports(count: int = 1) -> int:
    """Return the first of some ports in a row that nobody has."""
    while True:
        port = FIRST + secrets.randbelow(LAST - FIRST - count)
        try:
            for number in range(count):
                socket.create_server(("127.0.0.1", port + number)).close()
        except OSError:
            continue
        return port
