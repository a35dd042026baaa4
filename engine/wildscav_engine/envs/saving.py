"""The state of an environment as bytes: its match, and the position in the sequence of episodes.

The bytes have the layout of ``storage/binary_format.py``. Their payload is the result of ``Batch.get_state``,
which also covers versions. The checksum detects damage but not forgery: do not load states from untrusted
sources.
"""

from typing import Any

from wildscav_engine.envs.arena import Arena
from wildscav_engine.envs.settings.episodes import Episodes
from wildscav_engine.simulation.snapshot import StateError
from wildscav_engine.storage.binary_format import BinaryFormatError, Layout, pack, unpack

LAYOUT = Layout(b"WILDSENV", 1, "a state of an environment")


def save(arena: Arena, match: int, episodes: Episodes) -> bytes:
    """Return one match of an arena and the position in its sequence of episodes as bytes."""
    header: dict[str, Any] = {"seed": episodes.seed, "number": episodes.number}
    names = arena.opponents.names(match)
    if names is not None:
        header["players"] = names
    return pack(LAYOUT, header, arena.get_state(match))


def load(arena: Arena, match: int, data: bytes) -> Episodes:
    """Restore a match that ``save`` returned, and return its episodes; errors as ``OneMatch.set_state``."""
    try:
        header, payload = unpack(LAYOUT, data)
    except BinaryFormatError as error:
        raise StateError(str(error)) from error
    arena.set_state(match, bytes(payload), header.get("players"))
    return Episodes(int(header["seed"]), int(header["number"]))
