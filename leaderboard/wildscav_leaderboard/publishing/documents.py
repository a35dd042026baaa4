"""The documents that are published for audits.

A season has one document, and each board a file of lines: the board, the submissions that take part in it,
and the matches that count on it, in the order in which they were made. The web site and an export have the
same.
"""

from collections.abc import Iterable
from datetime import datetime
from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field

from wildscav_evaluator.output.json_files import WithOptionalFields
from wildscav_evaluator.output.results import OtherInterface
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.seasons.editions import Conditions, Part
from wildscav_leaderboard.seasons.settings import Mode
from wildscav_leaderboard.visibility import PUBLIC

Digest = Annotated[str, Field(pattern="^[0-9a-f]{32}$")]


class PublishedBoard(Part):
    """Where a board is, relative to the season's document."""

    track: str
    audience: Literal["public", "season"]  # as it is; or as it was before final matches decided the season
    lines: str  # the file of lines from which it can be computed anew
    shown: str  # the board as it is shown to everyone

    @property
    def label(self) -> str:
        """Its name in reports and files: that of its track, and what tells it from the other one."""
        return self.track if self.audience == PUBLIC else f"{self.track}-{self.audience}"


class PublishedTrack(Part):
    """What is played on a track."""

    name: str
    mode: Mode
    suite: str  # its label: for an organizer's own, followed by @ and a digest of its file
    suite_digest: str | None  # of an organizer's own suite: SHA-256 of its file
    suite_file: str | None  # that file, once the secret is opened
    rounds: int
    planned: int  # matches of each submission; on a ladder, at most, if its rating is not settled before
    robots: tuple[str, ...]  # that take part in a ladder
    interval: float | None = None  # of a ladder: at which width a rating is settled, in points of Elo


class PublishedEdition(Part):
    """The rules of a track at some time: results are compared within an edition alone."""

    track: str
    number: int
    digest: Digest  # of its conditions, which each of its matches names
    begun: datetime
    in_force: bool
    conditions: Conditions


class PublishedSecret(Part):
    """A secret from which the seeds of matches follow."""

    commitment: str  # SHA-256 of it
    secret: str | None  # in hexadecimal digits, once it is opened


class PublishedSeason(Part):
    """A season, as it is published for audits."""

    format: Literal[1] = 1
    name: str
    title: str
    opens: datetime
    freezes: datetime | None
    closes: datetime
    frozen: datetime | None  # since when the public boards stay as they are
    finalized: bool
    secret: PublishedSecret
    final_secret: PublishedSecret  # of the matches that decide the season
    tracks: tuple[PublishedTrack, ...]
    editions: tuple[PublishedEdition, ...] = ()  # in the order in which they were made
    # Submissions that are on no board, by number, and why.
    left_out: dict[str, str] = {}  # noqa: RUF012 (Pydantic copies it)
    boards: tuple[PublishedBoard, ...]
    records: str  # where they are: {match} stands for a match's number, {thousand} for its thousands

    def secret_of(self, commitment: str) -> PublishedSecret:
        """Return the secret from which a board's matches follow, given the commitment in its conditions."""
        return self.final_secret if commitment == self.final_secret.commitment else self.secret


class PublishedSubmission(Part, WithOptionalFields):
    """A submission that takes part in a board."""

    omitted = ("interface",)

    id: int
    entrant: str  # its name in matches and records
    name: str
    version: str
    team: str
    team_title: str
    created: datetime
    digest: Digest  # of its content, from which its private seeds follow
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers


class PublishedSeat(Part):
    """How a match went in the seat of an entrant."""

    seat: int
    entrant: str
    submission: int | None  # None for a robot
    status: str
    fault: str | None
    metrics: dict[str, float]


class PublishedMatch(Part):
    """A match that counts on a board, or one of a ladder that was given up and counts for nobody.

    Of a hidden match of a suite, only what it is and the digest of its record are published.
    """

    id: int  # grows with the order in which matches are made
    kind: str
    number: int  # in the suite, or of the ladder's matches
    judging: int = 1  # more than 1 where organizers had it played again
    superseded: bool = False  # whether a later judging has taken its place: it counts no more
    submission: int | None  # the one that is evaluated; None on a ladder
    void: str | None = None  # why it was given up; then nothing else is known of it
    at: datetime | None = None  # when its result arrived
    conditions: str = ""  # digest of those under which it was played
    metrics: dict[str, float] | None = None  # the mean of its seats
    seats: tuple[PublishedSeat, ...] = ()
    record: Digest | None = None  # BLAKE2b digest of its record, 32 hexadecimal digits
    record_size: int = 0  # bytes
    hidden: str | None = None  # why its record cannot be downloaded yet

    @property
    def withheld(self) -> str:
        """Why its result is not published yet; an empty text if it is, or there is none."""
        return self.hidden if self.hidden is not None and self.at is None else ""


class End(Part):
    """The last line of a board's file, without which it is not whole."""

    submissions: int
    matches: int


class Line(Part):
    """A line of a board's file, of which one field is given: first the board, then the others."""

    board: BoardDocument | None = None
    submission: PublishedSubmission | None = None
    match: PublishedMatch | None = None
    end: End | None = None

    def text(self) -> str:
        """Return it as it is published."""
        (name,) = self.model_fields_set
        return f'{{"{name}":{getattr(self, name).model_dump_json()}}}\n'


class IncompleteError(ValueError):
    """A board's file is not whole; the message says what is wrong."""


class BoardFile(Part):
    """Everything in a board's file."""

    board: BoardDocument | None  # None if there are no results yet
    submissions: tuple[PublishedSubmission, ...]
    matches: tuple[PublishedMatch, ...]

    @cached_property
    def by_number(self) -> dict[int, PublishedSubmission]:
        """The submissions by their numbers."""
        return {one.id: one for one in self.submissions}

    @classmethod
    def of(cls, lines: Iterable[Line]) -> "BoardFile":
        """Return what some lines say.

        Raises:
            IncompleteError: They are not all.
        """
        board, submissions, matches, end = None, [], [], None
        for line in lines:
            if end is not None:
                raise IncompleteError("it goes on after its end")
            board = line.board or board
            submissions += [] if line.submission is None else [line.submission]
            matches += [] if line.match is None else [line.match]
            end = line.end
        if end is None:
            raise IncompleteError("it has no end: the download was cut off")
        if (end.submissions, end.matches) != (len(submissions), len(matches)):
            raise IncompleteError(
                f"it has {len(submissions)} submissions and {len(matches)} matches, and its end counts "
                f"{end.submissions} and {end.matches}"
            )
        return cls.model_construct(board=board, submissions=tuple(submissions), matches=tuple(matches))
