"""The argument that names a season's folder, its opening, and the commands that make, copy and check one."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.terminal.console import command, console, counted, counting, error_console, print_json

if TYPE_CHECKING:
    from wildscav_leaderboard.database.connection import Database
    from wildscav_leaderboard.seasons.folder import Season


SeasonFolder = Annotated[Path, typer.Argument(help="The season's folder.", metavar="DIR", show_default=False)]


@contextmanager
def opened(folder: Path, *, any_version: bool = False) -> "Iterator[tuple[Season, Database]]":
    """Give a season and its database. See ``own_database.opened``."""
    from wildscav_leaderboard.seasons import own_database
    from wildscav_leaderboard.seasons.folder import Season

    season = Season.open(folder)
    with own_database.opened(season, any_version=any_version) as database:
        yield season, database


Backup = Annotated[Path, typer.Argument(help="The file of the backup.", metavar="BACKUP", show_default=False)]


def init(
    folder: SeasonFolder,
    name: Annotated[
        str | None, typer.Option(help="Short name of the season; the folder's name if not given.")
    ] = None,
    title: Annotated[str | None, typer.Option(help="Title, as people read it.")] = None,
    days: Annotated[int, typer.Option(help="How long it is open.", min=1, max=3650)] = 30,
) -> None:
    """Make a season's folder: commented settings, a template of rules, and secret seeds with commitments."""
    from wildscav_leaderboard.seasons.initial_files import make_season_folder

    commitment, final = make_season_folder(folder, name, title, days)
    console.print(f"season     {folder}")
    console.print(f"settings   {folder / 'season.toml'}: read and change them before it opens")
    console.print(f"rules      {folder / 'rules.md'}: fill them in and publish them with the commitments")
    console.print("publish    these commitments to the season's secrets, and keep the secrets:")
    console.print(f"           {commitment}  secret.txt")
    console.print(f"           {final}  final-secret.txt")
    console.print(f"start it   {command('wildscav', 'season', 'serve', folder)}")


def export(
    folder: SeasonFolder,
    out: Annotated[
        Path,
        typer.Argument(help="The folder to write, which must be new.", metavar="OUT", show_default=False),
    ],
) -> None:
    """Write what is published of a season into a folder: boards, matches and records, for anyone to audit."""
    from wildscav_leaderboard.publishing.export import export as run

    with opened(folder) as (season, database):
        made = run(season, database, out)
    hidden = f"; {made.hidden:,} more are still hidden" if made.hidden else ""
    found = ((made.boards, "board"), (made.matches, "match"), (made.records, "record"))
    console.print(f"{', '.join(counted(*one) for one in found)}{hidden}")
    console.print(f"exported to {made.folder}")
    console.print(f"check it    {command('wildscav', 'verify', out)}")


def backup(folder: SeasonFolder, out: Backup) -> None:
    """Back up a season while it runs: settings, secrets, database, archives and records, in one tar."""
    from wildscav_leaderboard.organizing.backups.backup import back_up

    with (
        opened(folder, any_version=True) as (season, database),
        counting("files are backed up") as on_progress,
    ):
        done = back_up(season, database, out, datetime.now(UTC), on_progress)
    size = f"{done.size / (1 << 20):,.1f} MiB"
    held = f"{counted(done.rows, 'row')} and {counted(done.files, 'file')}, {size}"
    console.print(f"{out}: {held}; it holds the secrets, so keep it safe")
    if done.missing:
        error_console.print(
            f"missing: {counted(len(done.missing), 'file')}, the first one {done.missing[0]}; "
            "`wildscav season check` tells more"
        )


def restore(backup: Backup, folder: SeasonFolder) -> None:
    """Restore a backup into a new folder and an empty database, of the same kind or another one."""
    from wildscav_leaderboard.organizing.backups.restore import restore as restored

    done = restored(backup, folder)
    console.print(f"season   {done.season}, as it was at {done.at:%Y-%m-%d %H:%M:%S} UTC")
    console.print(f"database {done.database}: {counted(done.rows, 'row')}")
    console.print(f"start it {command('wildscav', 'season', 'serve', folder)}")


def check(folder: SeasonFolder, as_json: AsJson = False) -> None:
    """Check that a season has all that it needs: settings, secrets, database, and every file unchanged.

    With --json: `passed`, `files` (how many were checked), `problems` and `changes` (of the rules, not in
    force yet), a line each, `longest` (by track, seconds that agents can make a match last), and `note`
    (why the database was not checked; empty if it was).
    """
    from wildscav_evaluator.monitoring.dashboard import duration
    from wildscav_leaderboard.organizing.checking import check_season

    with counting("files are checked") as on_progress:
        found = check_season(folder, on_progress)
    if as_json:
        print_json({"passed": found.passed, **asdict(found)})
    for problem in found.problems:
        error_console.print(problem)
    if not found.passed:
        raise typer.Exit(1)
    if found.changes and not as_json:
        apply = command("wildscav", "season", "apply", folder)
        console.print("\n".join([*found.changes, f"{apply} brings this into force"]))
    if not as_json:
        for track, seconds in found.longest.items():
            console.print(f"{track}: a match lasts at most {duration(seconds)} by its agents' time limits")
        rest = f"; {found.note}" if found.note else f", database and {counted(found.files, 'file')}"
        console.print(f"nothing is wrong: settings, secrets{rest}")
