"""The command ``wildscav season demo``."""

import contextlib
import time
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.errors import UserError
from wildscav.terminal.console import command, console, error_console, progress_bar

if TYPE_CHECKING:
    from wildscav_leaderboard.hosting.demo.make import Login
    from wildscav_leaderboard.seasons.folder import Season

HOST = "127.0.0.1"
PORT = 8000  # unless something else listens there
LOOKS = 1.0  # s between two looks at the season
SILENCE = 30.0  # s between two lines of progress where there is no terminal


def demo(
    folder: Annotated[
        Path | None,
        typer.Option(help="Where to make the season, and to leave it. Default: a temporary folder."),
    ] = None,
    matches: Annotated[int, typer.Option(help="Matches to play before it is shown.", min=0, max=18)] = 8,
    port: Annotated[
        int | None,
        typer.Option(help=f"Port to listen on. Default: {PORT}, or another free one.", min=1, max=65_535),
    ] = None,
    sandbox: Annotated[
        str | None,
        typer.Option(help="Sandbox of the agents. Default: bubblewrap if it works here, else process."),
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the season's page in a browser.")] = True,
) -> None:
    """Open a season to look at: the baselines are its teams, and play while you look around."""
    free = _free_port(port)  # before all that takes time
    from wildscav_engine.compilation.engine_progress import silence
    from wildscav_evaluator.sandbox import SANDBOXES
    from wildscav_leaderboard.hosting.demo.make import make_demo
    from wildscav_leaderboard.hosting.serve import serve

    if sandbox is not None and sandbox not in SANDBOXES:
        raise UserError(f"--sandbox is {sandbox!r}, must be one of {', '.join(SANDBOXES)}", exit_code=2)
    with _place(folder) as place:
        season, logins = make_demo(place, free, sandbox)
        watch = _Watch(season, logins, matches, opens=browser)
        quiet = silence() if error_console.is_terminal else contextlib.nullcontext()
        with quiet, contextlib.closing(watch):
            serve(season, watch=watch)


@contextlib.contextmanager
def _place(folder: Path | None) -> Iterator[Path]:
    """Yield the folder of the season; a temporary one is removed at the end."""
    from wildscav_server import leftovers

    if folder is not None:
        yield folder
        return
    with leftovers.temporary_folder("season-") as place:
        yield place / "demo"


def _free_port(wanted: int | None) -> int:
    """Return a port on which nothing listens yet."""
    from wildscav.system.ports import check_port

    if wanted is not None:
        return check_port(HOST, wanted)
    try:
        return check_port(HOST, PORT)
    except UserError:
        return check_port(HOST, 0)


class _Watch:
    """Shows how far a season is until it is worth a look, and then where it is. Called again and again."""

    def __init__(self, season: "Season", logins: "tuple[Login, ...]", matches: int, *, opens: bool) -> None:
        from rich.progress import MofNCompleteColumn, TimeElapsedColumn

        self._season, self._logins, self._matches, self._opens = season, logins, matches, opens
        self._database = season.database()
        self._progress = progress_bar(MofNCompleteColumn(), TimeElapsedColumn())
        self._checks = self._progress.add_task("submissions are checked", total=None)
        self._played = self._progress.add_task("matches are played", total=matches, start=False)
        self._is_shown, self._looked, self._said = False, 0.0, time.monotonic()
        self._progress.start()
        error_console.print(
            "the baselines are checked, and play their first matches; the first time, this compiles the "
            "engine, which takes up to two minutes"
        )

    def __call__(self) -> None:
        from wildscav_leaderboard.hosting.demo.make import opening_of

        if self._is_shown or time.monotonic() - self._looked < LOOKS:
            return
        self._looked = time.monotonic()
        state = opening_of(self._database, self._season.settings.tracks)
        self._progress.update(self._checks, total=state.submissions, completed=state.validated)
        if state.validated == state.submissions:
            self._progress.start_task(self._played)
            self._progress.update(self._played, completed=min(state.played, self._matches))
        if not error_console.is_terminal and self._looked - self._said > SILENCE:
            self._said = self._looked
            error_console.print(
                f"{state.validated} of {state.submissions} submissions are checked, "
                f"{min(state.played, self._matches)} of {self._matches} matches are played"
            )
        if state.is_ready(self._matches):
            self._is_shown = True
            self._progress.stop()
            self._show()

    def close(self) -> None:
        """Leave the terminal as it was."""
        self._progress.stop()
        self._database.close()

    def _show(self) -> None:
        from wildscav_evaluator.sandbox.process import WARNING

        address = self._season.settings.web.address
        logins = (
            f"log in as {one.name:10} password {one.password} to see what {one.role}s see"
            for one in self._logins[:2]
        )
        wildscav = command("wildscav")
        lines = [
            f"the season is at {address} (Ctrl-C ends it)",
            *logins,
            f"take part: {wildscav} login {address} --register",
            f"           {wildscav} team create my-team",
            f"           {wildscav} init my-agent",
            f"           {wildscav} submit my-agent --wait (or hand it in at {address}/submit)",
        ]
        if self._season.settings.execution.sandbox == "process":
            lines.append(WARNING)
        for line in lines:
            console.print(line)
        if self._opens:
            with contextlib.suppress(webbrowser.Error):
                webbrowser.open(address)
