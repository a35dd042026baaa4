"""The names of tracks and levels, for options that take one."""

from wildscav.errors import UserError
from wildscav.terminal.suggestions import did_you_mean


def level_names() -> tuple[str, ...]:
    """Return the names of all levels, from the easiest to the hardest."""
    from wildscav_engine.maps.levels import LEVELS

    return tuple(LEVELS)


def known_track(track: str) -> str:
    """Return the value of ``--track``, or raise a UserError if there is no such track."""
    from wildscav_engine.tracks import TRACKS

    if track not in TRACKS:
        raise UserError(
            f"--track is {track!r}{did_you_mean(track, TRACKS)}, must be one of {', '.join(TRACKS)}", 2
        )
    return track
