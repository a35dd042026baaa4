"""A season as its client sees it: one method for each question, downloads, and following."""

import os
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TypeVar
from urllib.parse import quote

from pydantic import TypeAdapter, ValidationError

from wildscav.errors import UserError, describe
from wildscav.version import __version__
from wildscav_leaderboard.api.documents import (
    AccountView,
    HandedIn,
    KeyView,
    MatchList,
    MatchView,
    NewAccountView,
    NewTeamView,
    NewTokenView,
    SeasonView,
    SubmissionList,
    SubmissionView,
    TeamView,
)
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.competing.connection import (
    AnswerError,
    Connection,
    NoSeasonError,
    Query,
    UnreachableError,
)
from wildscav_leaderboard.submissions.states import ACTIVE, FINAL

T = TypeVar("T")
N = TypeVar("N", SubmissionView, MatchView)
PAGE = 100  # entries of a list that are asked for at once
PIECE = 1 << 16  # bytes
OnSent = Callable[[int], object]  # is told how many more bytes were sent


class SeasonClient:
    """What a season offers to one account, or to a visitor.

    Every method raises UserError, with one line that says why, if the season refuses or does not answer.
    """

    def __init__(self, connection: Connection) -> None:
        self.url = connection.url
        self._connection = connection

    def season(self) -> SeasonView:
        """Return the season."""
        return self._get(SeasonView, "/season")

    def boards(self) -> list[BoardDocument]:
        """Return the boards of all tracks that have results."""
        return self._get(list[BoardDocument], "/boards")

    # Accounts.

    def register(self, name: str, password: str, invitation: str | None) -> NewAccountView:
        """Make an account; it comes with a token."""
        return self._post(NewAccountView, "/accounts", name=name, password=password, invitation=invitation)

    def new_token(self, name: str, password: str, label: str) -> str:
        """Return a new token of an account."""
        return self._post(NewTokenView, "/tokens", name=name, password=password, label=label).token

    def revoke_own_token(self) -> None:
        """Make this client's token worth nothing."""
        self._connection.ask("DELETE", "/tokens/current")

    def me(self) -> AccountView:
        """Return the account, its team and its quota."""
        return self._get(AccountView, "/me")

    # Teams.

    def team(self, name: str) -> TeamView:
        """Return a team."""
        return self._get(TeamView, f"/teams/{quote(name, safe='')}")

    def make_team(self, name: str, title: str) -> NewTeamView:
        """Make a team; the key for teammates comes with it."""
        return self._post(NewTeamView, "/teams", name=name, title=title)

    def join_team(self, key: str) -> TeamView:
        """Join a team with its key."""
        return self._post(TeamView, "/teams/join", key=key)

    def leave_team(self) -> None:
        """Leave the account's team."""
        self._connection.ask("POST", "/teams/leave")

    def new_team_key(self) -> str:
        """Return another key for teammates; the old one is worth nothing from now on."""
        return self._post(KeyView, "/teams/mine/key").key

    # Submissions.

    def submit(
        self, archive: Path, suffix: str, message: str, progress: OnSent, replaces: int | None = None
    ) -> HandedIn:
        """Hand in an archive. It is sent piece by piece, so its size takes no memory."""
        query = {"message": message, "suffix": suffix} | ({"replaces": str(replaces)} if replaces else {})
        size = archive.stat().st_size
        answer = self._connection.upload("/submissions", query, _pieces(archive, progress), size)
        return self._as(HandedIn, answer)

    def submissions(
        self, limit: int, *, team: str | None = None, states: list[str] | None = None
    ) -> list[SubmissionView]:
        """Return submissions, the newest first."""

        def read(answer: object) -> list[SubmissionView]:
            return self._as(SubmissionList, answer).submissions

        return self._pages("/submissions", {"team": team, "state": states}, limit, read)

    def submission(self, number: int) -> SubmissionView:
        """Return a submission with its history."""
        return self._get(SubmissionView, f"/submissions/{number}")

    def act(self, number: int, act: str) -> SubmissionView:
        """Do an act on a submission of the own team, such as ``cancel``."""
        return self._post(SubmissionView, f"/submissions/{number}/{quote(act)}")

    def submission_log(self, number: int) -> str:
        """Return what a submission of the own team printed in its validation."""
        return self._connection.text(f"/submissions/{number}/logs")

    # Matches.

    def matches(
        self, limit: int, *, submission: int | None = None, track: str | None = None
    ) -> list[MatchView]:
        """Return matches, the newest first."""
        query: Query = {"submission": submission, "track": track}
        return self._pages("/matches", query, limit, lambda one: self._as(MatchList, one).matches)

    def match(self, number: int) -> MatchView:
        """Return a match."""
        return self._get(MatchView, f"/matches/{number}")

    def match_log(self, number: int, seat: int) -> str:
        """Return what an agent of the own team printed in a match."""
        return self._connection.text(f"/matches/{number}/logs/{seat}")

    def download_record(self, number: int, digest: str, path: Path) -> None:
        """Store the record of a match, whole or not at all, after its digest was compared."""
        with self._connection.stream("GET", f"/matches/{number}/record") as response:
            store_record(response.iter_bytes(), digest, path)

    def _pages(self, path: str, query: Query, limit: int, read: Callable[[object], list[N]]) -> list[N]:
        """Return a list that comes in pages, each of which is asked for by the last entry before it."""
        found: list[N] = []
        while len(found) < limit:
            size = min(PAGE, limit - len(found))
            before = found[-1].id if found else None
            page = read(self._connection.get(path, {**query, "limit": size, "before": before}))
            found += page
            if len(page) < size:
                break
        return found

    def _get(self, kind: type[T], path: str) -> T:
        """Return the document at a path."""
        return self._as(kind, self._connection.get(path))

    def _post(self, kind: type[T], path: str, **content: str | None) -> T:
        """Send a document, or nothing, and return the one in the answer."""
        return self._as(kind, self._connection.ask("POST", path, content=content or None))

    def _as(self, kind: type[T], answer: object) -> T:
        """Return an answer as a document."""
        try:
            return TypeAdapter(kind).validate_python(answer)
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            field = ".".join(str(part) for part in first["loc"])
            raise NoSeasonError(
                f"{self.url} does not answer as a season of Wildscav {__version__} does ({field}: "
                f"{first['msg']}): it may run another version"
            ) from None


def _pieces(path: Path, progress: OnSent) -> Iterator[bytes]:
    with path.open("rb") as file:
        while piece := file.read(PIECE):
            yield piece
            progress(len(piece))


def is_stored(path: Path, digest: str) -> bool:
    """Return whether a file is the record with a digest.

    Raises:
        OSError: There is a file, but it cannot be read, or is no record.
    """
    from wildscav_engine.record import FILE_LIMIT
    from wildscav_engine.storage.files import read_limited
    from wildscav_leaderboard.matches.record_files import record_digest

    return path.exists() and record_digest(read_limited(path, FILE_LIMIT)) == digest


def store_record(pieces: Iterable[bytes], digest: str, path: Path) -> None:
    """Write the record of a match into a new file.

    Raises:
        UserError: It has another digest, is too large, or the file cannot be written.
    """
    fresh = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        _write(pieces, fresh)
        if not is_stored(fresh, digest):
            raise UserError("the download is not the record that the season names: its digest is another")
        fresh.rename(path)
    except OSError as error:
        raise UserError(f"cannot store {path}: {error.strerror or describe(error)}") from None
    finally:
        fresh.unlink(missing_ok=True)


def _write(pieces: Iterable[bytes], path: Path) -> None:
    from wildscav_engine.record import FILE_LIMIT

    size = 0
    with path.open("wb") as file:
        for piece in pieces:
            size += file.write(piece)
            if size > FILE_LIMIT:
                raise UserError(f"the download has more than {FILE_LIMIT >> 20} MiB, as no record has")


PAUSE = 1.0  # s between two questions
PATIENCE = 900.0  # s without an answer


def follow(client: SeasonClient, submission: SubmissionView) -> Iterator[SubmissionView | UserError]:
    """Yield what becomes of a submission, until it has ended; an error where the season did not answer.

    Raises:
        UserError: The season refuses, or has not answered for a long time.
    """
    answered = time.monotonic()
    yield submission
    while submission.state not in (ACTIVE, *FINAL):
        time.sleep(PAUSE)
        try:
            submission = client.submission(submission.id)
        except UserError as error:
            if not _passes(error) or time.monotonic() - answered > PATIENCE:
                raise
            yield error
        else:
            answered = time.monotonic()
            yield submission


def _passes(error: UserError) -> bool:
    """Return whether it is worth to ask again."""
    return isinstance(error, UnreachableError) or (isinstance(error, AnswerError) and error.is_passing)
