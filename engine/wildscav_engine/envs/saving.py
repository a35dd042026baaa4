"""The state of an environment as bytes: its match, and which episode comes next.

The layout is that of ``container``: the payload is what ``Batch.get_state`` gives, so versions are checked as
they are there. The checksum finds damage, not forgery; take no state from strangers.
"""

from wildscav_engine.envs.arena import Arena
from wildscav_engine.envs.settings.episodes import Episodes
from wildscav_engine.simulation.snapshot import StateError
from wildscav_engine.storage.binary_format import BinaryFormatError, Layout, pack, unpack

LAYOUT = Layout(b"WILDSENV", 1, "a state of an environment")


def save(arena: Arena, match: int, episodes: Episodes) -> bytes:
    """Return one match of an arena as bytes, with the count of its episodes."""
    header = {"seed": episodes.seed, "number": episodes.number}
    return pack(LAYOUT, header, arena.get_state(match))


def load(arena: Arena, match: int, data: bytes) -> Episodes:
    """Put a match that ``save`` gave into an arena, and return its episodes.

    Raises:
        StateError: The bytes are no state of an environment, damaged, or of another version.
        MatchSetupError: The match is of another track, or of other rules or seats.
    """
    try:
        header, payload = unpack(LAYOUT, data)
    except BinaryFormatError as error:
        raise StateError(str(error)) from error
    arena.set_state(match, bytes(payload))
    episodes = arena.episodes(int(header["seed"]))
    episodes.number = int(header["number"])
    return episodes
