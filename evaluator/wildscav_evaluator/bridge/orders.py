"""What the process of a bridge is told of a seat."""

from collections.abc import Sequence
from typing import NamedTuple


class Order(NamedTuple):
    """A seat to serve."""

    interface: str  # "words" or "keys"
    socket: int  # descriptor of the socket that listens for its agent
    token: str  # by which its agent takes the seat; the match knows another one
    address: str  # of the match's socket
    match_token: str  # of the seat there
    names: Sequence[str]  # the display names of all seats
