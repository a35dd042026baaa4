"""Records of a season's matches, for ``wildscav replay``: the entry point ``wildscav.record_sources``."""

from pathlib import Path

from wildscav.errors import UserError, describe
from wildscav.terminal.console import console, error_console


def fetched_record(match: int, season: str | None) -> Path:
    """Return the path of a match's record, which is downloaded into the current folder unless it is there.

    Args:
        match: Number of the match.
        season: Address of the season; None for the one of the latest login.

    Raises:
        UserError: There is no such match, its record is hidden, or it cannot be stored.
    """
    from wildscav_leaderboard.cli.competing.connected import season_client
    from wildscav_leaderboard.client.downloads import is_stored

    path = Path(f"match-{match}.wsr")
    with season_client(season) as client:
        found = client.match(match)
        if found.record is None:
            raise UserError(f"match {match} has no record yet: it is {found.state}")
        try:
            stored = is_stored(path, found.record)
        except OSError as error:
            raise UserError(describe(error)) from None
        if not stored and path.exists():
            raise UserError(f"{path} is another file, which the record would overwrite: move it away")
        if not stored:
            with error_console.status("downloading the record"):
                client.download_record(match, found.record, path)
            console.print(f"{path}: the record of match {match}", soft_wrap=True)
    return path
