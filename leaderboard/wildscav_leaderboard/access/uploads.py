"""Uploads of archives: written to disk piece by piece, so that they take no memory, whatever their size."""

import tempfile
from collections import Counter
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Annotated

import anyio
import anyio.to_thread
from fastapi import Depends, Query, Request

from wildscav_leaderboard.access.requests import CurrentDatabase, Now, Number
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.disk import check_room
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.seasons.refusals import TooLargeError, TooMuchError
from wildscav_leaderboard.submissions.archives import check_archive, checked_suffix, store_archive
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import check_accepting, hand_in
from wildscav_leaderboard.teams.service import own_team

NAME = "submission"
AT_ONCE = 3  # uploads of an account; the quota of a day counts them only when they are done
CHECKED = 4  # archives at a time: a check takes a thread, which pages need, too
READ = 2  # times the largest archive; of whatever is larger, no more than that is read


@dataclass(frozen=True)
class Upload:
    """A request whose body is an archive that is handed in.

    It depends on no session: that would be open until the body has arrived, however slowly it is sent.
    """

    request: Request
    database: CurrentDatabase
    now: Now
    message: Annotated[str, Query(max_length=1000)] = ""
    suffix: Annotated[str, Query(max_length=20)] = ".tar.gz"
    replaces: Number | None = None

    async def take(self, account: Account) -> Submission:
        """Hand it in for the team of an account.

        Raises:
            RefusalError: It is not accepted now, which is checked before it is read, or not valid.
        """
        run, written = anyio.to_thread.run_sync, self.request.app.state.season
        season = await run(check_upload_wanted, self.database, written, account, self.now)
        state = self.request.app.state
        with one_of(state.uploads, account):
            async with uploaded(self.request, season, self.suffix) as path, state.checks:
                place = self.database, season, account, path
                return await run(take_upload, *place, self.message, self.now, self.replaces)


Uploaded = Annotated[Upload, Depends()]


@contextmanager
def one_of(running: Counter[int], account: Account) -> Iterator[None]:
    """Count an upload of an account among those in progress.

    Raises:
        TooMuchError: The account has as many as it may.
    """
    if running[account.id] >= AT_ONCE:
        raise TooMuchError(f"you are uploading {AT_ONCE} submissions already: wait until one has arrived")
    running[account.id] += 1
    try:
        yield
    finally:
        running[account.id] -= 1


@asynccontextmanager
async def uploaded(request: Request, season: Season, suffix: str) -> AsyncIterator[Path]:
    """Yield the path of a request's body, in a folder of its own that is removed afterwards.

    Raises:
        TooLargeError: It is larger than the season allows. It is read to its end, without being written, if
            that is near, because a browser that is still sending does not see the answer.
        InvalidError: The suffix is of no kind of archive.
    """
    largest = season.settings.quotas.archive << 20
    season.files.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="upload-", dir=season.files) as folder:
        path = Path(folder) / f"{NAME}{checked_suffix(suffix)}"
        size = 0
        async with await anyio.open_file(path, "wb") as file:
            async for piece in request.stream():
                size += len(piece)
                if size <= largest:
                    await file.write(piece)
                elif size > READ * largest:
                    break
        if size > largest:
            raise TooLargeError(f"the archive is larger than {season.settings.quotas.archive} MiB")
        yield path


def check_upload_wanted(database: Database, season: Season, account: Account, now: datetime) -> Season:
    """Check that an account may hand in a submission now, before it is uploaded.

    Returns:
        The season with the rules that are in force.

    Raises:
        RefusalError: It may not, or there is no room for it.
    """
    check_room(season)
    with database.reading() as session:
        season = in_force(session, season)
        check_accepting(session, season, own_team(session, account), account, now)
    return season


def take_upload(
    database: Database,
    season: Season,
    account: Account,
    path: Path,
    message: str,
    now: datetime,
    replaces: int | None = None,
) -> Submission:
    """Check an uploaded archive, keep it, and enter the submission.

    Raises:
        RefusalError: It is not valid, or not accepted now.
    """
    archive = check_archive(path, season)
    with database.writing() as session:
        team = own_team(session, account)
        submission = hand_in(session, season, team, account, archive, message, now, replaces)
        store_archive(archive, season)  # last, so that nothing is kept of what is refused
    return submission
