"""The command ``wildscav leaderboard``."""

from pathlib import Path
from typing import Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav_evaluator.cli.options.evaluation import NoDatabase

Where = Annotated[
    list[str] | None,
    typer.Argument(
        help="Folders of evaluations and tournaments, folders with such folders in them, or files "
        "results.json, or the address of a season. Default: out.",
        metavar="[FOLDER|URL]",
        show_default=False,
    ),
]
OfSeason = Annotated[
    str | None,
    typer.Option(
        "--season",
        help="Show the boards of the season at this address; latest is the one of WILDSCAV_SEASON, or of "
        "your latest login.",
        metavar="URL",
        show_default=False,
    ),
]
Track = Annotated[str | None, typer.Option(help="Only this track, or tracks whose names begin with this.")]
SuiteName = Annotated[
    str | None, typer.Option(help="Only this suite; spring also finds your own suite spring@19da5d55.")
]


def leaderboard(
    where: Where = None,
    season: OfSeason = None,
    track: Track = None,
    suite: SuiteName = None,
    db: NoDatabase = None,  # noqa: ARG001 - its callback says what replaced it
    as_json: AsJson = False,
) -> None:
    """Show the standings on every track: the latest evaluation of each submission, and tournaments.

    With --season, show the boards of a season; no account is needed for that.

    With --json: `standings`: the values that all rows share (`track`, `suite`, `seed`, `rounds`, versions,
    `sandbox`, `limits`, `clock`, `model`), and `rows`: `rank`, `submission`, `version`, `digest`,
    `interface`, `started`, `key` (that signed it), `matches`, `faults`, `scores` of each; `overall`, the same
    across tracks, with rows as in results.json; `tournaments`, as in their files.

    With --json, of a season: `season` (title, dates, tracks, announcements), and `boards`, as the season
    publishes them.
    """
    named = where or []
    if season is None and len(named) == 1 and _is_address(named[0]):
        season = named.pop()
    if season is not None:
        from wildscav_leaderboard.competing.boards import show_boards

        if named:
            raise UserError("--season shows the boards of one season: leave out the folders", exit_code=2)
        if suite is not None:
            raise UserError("--suite is for folders: a season has one suite on each track", exit_code=2)
        show_boards(season, track, as_json=as_json)
    else:
        from wildscav_evaluator.cli.sessions.leaderboard import show_standings
        from wildscav_evaluator.output.numbered_folders import OUT

        show_standings([Path(name) for name in named] or [OUT], track, suite, as_json=as_json)


def _is_address(text: str) -> bool:
    """Return whether a text is meant as a season's address: it is no path, and no part of one."""
    return "://" in text or not ("/" in text or Path(text).exists())
