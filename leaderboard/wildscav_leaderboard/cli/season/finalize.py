"""The command ``wildscav season finalize``."""

import shutil
import time
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.progress import MofNCompleteColumn, TimeElapsedColumn

from wildscav.terminal.console import command, console, counted, error_console, progress_bar
from wildscav_leaderboard.cli.season.folders import SeasonFolder, opened

if TYPE_CHECKING:
    from wildscav_leaderboard.database.connection import Database
    from wildscav_leaderboard.organizing import finalizing
    from wildscav_leaderboard.seasons.folder import Season

LOOKS = 1.0  # s between two looks at the season
QUESTION = "The season is still open. End it now? Nothing can be handed in from then on."
STAGES = {"settling": "matches that were planned", "deciding": "matches that decide the season"}


def finalize(
    folder: SeasonFolder,
    best: Annotated[
        int,
        typer.Option(help="How many submissions of each suite play the deciding matches.", min=1, max=1000),
    ] = 10,
    now: Annotated[bool, typer.Option("--now", help="End a season that is still open.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="With --now: do not ask.")] = False,
    leave_out: Annotated[
        list[int],
        typer.Option(
            help="A submission that is on no board although it takes part; may be repeated.",
            show_default=False,
        ),
    ] = [],  # noqa: B006 (Typer's way)
    reason: Annotated[
        str, typer.Option(help="With --leave-out: why; everyone sees it.", show_default=False)
    ] = "",
    abort: Annotated[
        bool, typer.Option("--abort", help="Take back a `finalize` that waits: the season goes on.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder for what is published at the end; default: DIR/published.", show_default=False
        ),
    ] = None,
) -> None:
    """End a season: the best play again on fresh hidden seeds, the boards become final, all becomes public.

    It waits until the conductor has played the matches. If it is interrupted, run it again, and it goes on.
    After the end, it makes the boards without whoever is disqualified since, and publishes all anew.
    """
    from wildscav_leaderboard.cli.season.acts import command_line
    from wildscav_leaderboard.organizing import finalizing
    from wildscav_leaderboard.seasons.folder import PUBLISHED

    with opened(folder) as (season, database):
        if now and not yes and not abort and datetime.now(UTC) < season.settings.closes:
            typer.confirm(QUESTION, abort=True)
        with database.writing() as session:
            actor, at = command_line(), datetime.now(UTC)
            if abort:
                finalizing.abort(session, actor, at)
            elif not (again := finalizing.finalize_again(session, season, actor, at)):
                finalizing.begin(session, season, actor, best, at, early=now)
                if leave_out:
                    finalizing.leave_out(session, actor, leave_out, reason, at)
        if abort:
            console.print("the end of the season is taken back")
            return
        _wait(season, database)
        console.print("the season is over: its boards are final, and its secrets are opened")
        _publish(season, database, out or season.folder / PUBLISHED, again=again)


def _publish(season: "Season", database: "Database", out: Path, *, again: bool) -> None:
    """Export what is published, unless that was done before; again, a folder is replaced as a whole."""
    from wildscav_leaderboard.publishing.export import export

    if again and out.exists():
        new, old = (out.with_name(f".{out.name}.{what}") for what in ("new", "old"))
        for left in (new, old):  # by an interrupted try
            shutil.rmtree(left, ignore_errors=True)
        export(season, database, new)
        out.rename(old)
        new.rename(out)
        shutil.rmtree(old)
    elif not out.exists():
        export(season, database, out)
    console.print(f"published in {out}; anyone can check it:")
    console.print(f"  {command('wildscav', 'verify', out)}")


def _wait(season: "Season", database: "Database") -> None:
    """Wait for the end of the season, and show how far it is."""
    from wildscav_leaderboard.cli.season.acts import command_line
    from wildscav_leaderboard.conductor.plans import rate_ladders
    from wildscav_leaderboard.organizing import finalizing

    shown = _Shown()
    with shown.progress:
        while True:
            with database.reading() as session:
                rate_ladders(session, season)
            with database.writing() as session:
                state = finalizing.advance(session, season, command_line(), datetime.now(UTC))
            if state.stage == finalizing.DONE:
                return
            shown.update(state)
            time.sleep(LOOKS)


class _Shown:
    """The progress as it is shown: a bar on a terminal, a line for each change elsewhere."""

    def __init__(self) -> None:
        self.progress = progress_bar(MofNCompleteColumn(), TimeElapsedColumn())
        self._task = self.progress.add_task("", total=None)
        self._said = ""

    def update(self, state: "finalizing.Ending") -> None:
        """Show how far the season is."""
        what = STAGES[state.stage]
        if state.pending:
            what = f"{counted(state.pending, 'submission')} to be validated, {what}"
        self.progress.update(self._task, description=what, completed=state.played, total=state.planned)
        said = state.note or ("" if error_console.is_terminal else what)
        if said and said != self._said:
            error_console.print(said)
        self._said = said
