"""The command ``wildscav submit``, and the archive that a submission is handed in as."""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from wildscav.cli.shared_options import AsJson
from wildscav.errors import INTERRUPTED, UserError
from wildscav.terminal.console import console, counted, print_json, progress_bar
from wildscav_leaderboard.competing import texts
from wildscav_leaderboard.competing.connected import SeasonUrl, season_client
from wildscav_leaderboard.competing.course import check_end, waited

if TYPE_CHECKING:
    from wildscav_evaluator.submissions.submission import Submission
    from wildscav_leaderboard.api.documents import HandedIn, QuotaView, SubmissionView
    from wildscav_leaderboard.competing.season_client import OnSent, SeasonClient


def submit(
    submission: Annotated[
        Path,
        typer.Argument(
            help="Folder with a submission.toml, an archive of one, or a baseline's name.",
            metavar="SUBMISSION",
            show_default=False,
        ),
    ],
    message: Annotated[
        str, typer.Option("--message", "-m", help="What is new in it; only your team sees it.")
    ] = "",
    replaces: Annotated[
        int | None,
        typer.Option(
            help="The submission that leaves if too many of your team take part. Default: the oldest on "
            "each track that is not kept.",
            min=1,
            show_default=False,
        ),
    ] = None,
    wait: Annotated[
        bool, typer.Option("--wait", help="Wait until it takes part; exit with 1 if it failed.")
    ] = False,
    season: SeasonUrl = None,
    as_json: AsJson = False,
) -> None:
    """Hand in a submission for your team. `wildscav check` tells beforehand whether it will pass.

    With --json: `quota`, `not_played` (tracks that the season lacks), and `submission`: `id`, `team`,
    `team_title`, `name`, `version`, `message`, `tracks`, `digest`, `size`, `created`, `state`, `playing`
    (tracks), `kept`, `replaces` (by track, the number of what will leave it), `since`, `deadline`,
    `queue_position`, `expected_wait` (s), `validation` (how far it is), `charged`, `platform_faults`, `fault`
    (`agent` or `platform`), `reason`, `last_lines`, `command`, `history`, `progress`, `totals`.

    While it takes part, `progress` has one entry for each of its tracks: `track`, `played` and `planned`
    matches, and `missing`, how many teams a ladder waits for before it makes matches. Once all its matches of
    a suite are over, `totals` has an entry for it: `track`, `matches`, their mean `score`, and `faults`, in
    how many of them it had each kind.
    """
    from wildscav_evaluator.cli.options.selection import load_named

    loaded = load_named(submission)
    with season_client(season) as client:
        quota = _quota(client)
        with _progress() as begun, archive_of(submission, loaded, quota.archive) as (archive, suffix):
            on_sent = begun(archive)
            try:
                handed_in = client.submit(archive, suffix, message, on_sent, replaces)
            except KeyboardInterrupt:
                said = "interrupted: `wildscav team submissions` tells whether it arrived"
                raise UserError(said, INTERRUPTED) from None
        missing = [track for track in loaded.manifest.tracks if track not in handed_in.submission.tracks]
        _show(client, handed_in, missing, wait=wait)
        last = handed_in.submission
        if wait:
            last = waited(client, last)
    if as_json:
        print_json({"submission": last, "quota": handed_in.quota, "not_played": missing})
    if wait:
        check_end(last)
        console.print(f"its matches: wildscav team matches {last.id}")


def _quota(client: "SeasonClient") -> "QuotaView":
    """Return the team's quota, of which something is left."""
    account = client.me()
    if account.team is None or account.quota is None:
        raise UserError(
            "you are in no team yet: `wildscav team create NAME` makes one, `wildscav team join KEY` "
            "joins one"
        )
    if account.quota.left_today == 0:
        raise UserError(
            f"your team has used today's {counted(account.quota.per_day, 'submission')}; the next day begins "
            f"at {account.quota.resets:%Y-%m-%d %H:%M} UTC"
        )
    return account.quota


@contextmanager
def _progress() -> "Iterator[Callable[[Path], OnSent]]":
    """Show that an archive is packed, how much of it was sent, and that the season then checks it."""
    from rich.progress import DownloadColumn, TransferSpeedColumn

    with progress_bar(DownloadColumn(), TransferSpeedColumn()) as shown:
        task = shown.add_task("packing", total=None)

        def begun(archive: Path) -> "OnSent":
            shown.update(task, description="uploading", total=archive.stat().st_size)
            return advance

        def advance(count: int) -> None:
            shown.advance(task, count)
            if shown.finished:
                shown.update(task, description="being checked by the season")

        yield begun


def _show(client: "SeasonClient", handed_in: "HandedIn", missing: list[str], *, wait: bool) -> None:
    one = handed_in.submission
    rows = {
        "submission": f"{one.id}: {one.name} {one.version}, for {', '.join(one.tracks)}",
        "not played": f"{', '.join(missing)}: not in this season" if missing else "",
        "state": ", ".join(filter(None, (one.state, texts.waiting(one)))),
        "replaces": ", ".join(_replaced(one)),
        "quota": texts.quota(handed_in.quota),
        "page": f"{client.url}/submissions/{one.id}",
        "follow it": "" if wait else f"wildscav team submissions {one.id} --wait",
    }
    console.print(texts.facts(rows))


def _replaced(one: "SubmissionView") -> "Iterator[str]":
    """Yield what will leave each track for a submission."""
    for track, number in one.replaces.items():
        yield f"itself on {track}, for newer ones" if number == one.id else f"{number} on {track}"


FOLDER_SUFFIX = ".tar.gz"


@contextmanager
def archive_of(named: Path, submission: "Submission", largest: int) -> Iterator[tuple[Path, str]]:
    """Give the archive of a submission and its suffix; a folder is packed for as long as it is needed.

    Args:
        named: What the user named: a folder, an archive or a baseline.
        largest: MiB that the archive may have.

    Raises:
        UserError: It is an image, which only its own machine has, or too large.
        OSError: It cannot be packed.
    """
    from wildscav_evaluator.submissions.archives import SUFFIXES, is_archive
    from wildscav_leaderboard.submissions.packing import pack

    if submission.image is not None:
        raise UserError(f"{named} is an image on this machine: submit a folder or an archive", exit_code=2)
    if named.is_file() and is_archive(named):
        if named.stat().st_size > largest << 20:
            raise UserError(f"{named} has more than {largest} MiB, which is the most that the season takes")
        yield named, next(suffix for suffix in SUFFIXES if named.name.lower().endswith(suffix))
        return
    with tempfile.TemporaryDirectory(prefix="wildscav-") as folder:
        archive = Path(folder) / f"submission{FOLDER_SUFFIX}"
        pack(submission.folder, archive, largest)
        yield archive, FOLDER_SUFFIX
