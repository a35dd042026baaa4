"""The documents that the API answers with, and that pages show."""

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict

from wildscav_evaluator.output.json_files import Document
from wildscav_leaderboard.boards.documents import ProgressView, TotalsView


class View(Document, BaseModel):
    """Base of all documents."""

    model_config = ConfigDict(from_attributes=True)


class ErrorView(View):
    """Why a request was refused."""

    error: str  # one line
    status: int  # of HTTP


# What a route that answers with text or a file is described with, as its refusals are documents all the same.
REFUSALS: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "Why the request was refused.",
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/ErrorView"}}},
    }
}


class QuotaView(View):
    """What a team has used of its quota."""

    per_day: int  # submissions that it may hand in on a day
    used_today: int
    left_today: int
    resets: datetime  # when the next day begins
    active_per_track: int  # submissions that may take part on a track at once
    active: dict[str, int]  # by track
    archive: int  # MiB of an archive, at most


class TeamView(View):
    """A team."""

    name: str  # in addresses
    title: str  # as people read it
    created: datetime
    disqualified: str | None  # why, if it is
    members: list[str]  # names of accounts


class TeamRow(TeamView):
    """A team in a list of all."""

    submissions: int  # that it handed in
    active: int  # that take part


class AccountView(View):
    """Whoever asks."""

    name: str
    role: str  # "competitor" or "organizer"
    team: TeamView | None
    quota: QuotaView | None


class NewAccount(BaseModel):
    """What is needed to register."""

    name: str
    password: str
    invitation: str | None = None  # the key of one, where the season asks for it


class NewAccountView(View):
    """A new account, with its first token, which is shown once."""

    name: str
    role: str  # "competitor" or "organizer"
    token: str


class NewToken(BaseModel):
    """What is needed to get a token."""

    name: str
    password: str
    label: str = "token"  # by which you tell your tokens apart


class NewTokenView(View):
    """A new token, which is shown once."""

    token: str


class TokenView(View):
    """A token without its secret part."""

    id: int
    label: str
    created: datetime
    used: datetime | None  # the last time, if ever


class NewTeam(BaseModel):
    """What is needed to make a team."""

    name: str
    title: str = ""  # as people read it; empty: the name


class NewTeamView(View):
    """A new team, with the key for teammates, which is shown once."""

    team: TeamView
    key: str


class KeyView(View):
    """A key, which is shown once."""

    key: str


class Key(BaseModel):
    """A key for teammates."""

    key: str


class TransitionView(View):
    """A step from one state to the next."""

    at: datetime
    state: str  # the next one
    detail: str  # why


class SubmissionView(View):
    """A submission. Its team and the organizers see why it failed."""

    id: int
    team: str
    team_title: str  # as people read it
    name: str
    version: str
    message: str  # of its team
    tracks: list[str]  # for which it was handed in
    digest: str  # of its files
    size: int  # bytes of its archive
    created: datetime
    state: str
    playing: list[str]  # the tracks on which it takes part
    kept: bool  # whether no later one replaces it unasked
    replaces: dict[str, int] = {}  # by track, what will leave it, as things are now; not in lists
    since: datetime  # of its state
    deadline: datetime | None  # by when its state ends
    queue_position: int | None = None  # while it waits
    expected_wait: float | None = None  # s
    validation: str = ""  # how far it is, in one line; not in lists
    charged: bool  # whether it counts against the quota
    platform_faults: int  # attempts that the platform broke
    fault: str | None  # whose fault it is that it failed
    reason: str | None = None  # why it failed
    last_lines: list[str] = []  # that it printed
    command: str | None = None  # with which you get the same on your machine
    history: list[TransitionView] = []
    progress: list[ProgressView] = []  # on each of its tracks, while it takes part; not in lists
    totals: list[TotalsView] = []  # on each suite whose matches are all over; not in lists


class SubmissionList(View):
    """Submissions, the newest first."""

    submissions: list[SubmissionView]
    next: str | None  # the address of those that come after them


class HandedIn(View):
    """A new submission, and what is left of the quota."""

    submission: SubmissionView
    quota: QuotaView


class SeatView(View):
    """A seat of a match that has an entrant."""

    seat: int
    entrant: str  # its name in records
    name: str  # as people read it: of a submission with its version, or of a robot
    submission: int | None
    team: str | None
    team_title: str | None
    status: str | None = None  # the outcome, as in results.json
    fault: str | None = None  # whose fault it is, if something went wrong
    detail: str | None = None  # what went wrong, in one line
    metrics: dict[str, float] | None = None
    place: int | None = None  # on a ladder, from 1; None where not every seat's outcome can be seen
    latency_p50: float | None = None  # s
    latency_p99: float | None = None  # s
    latency_max: float | None = None  # s
    late_steps: int | None = None  # steps without an answer in time

    @property
    def who(self) -> str:
        """Who plays in it, as people read it."""
        return self.team_title or self.name


class MatchView(View):
    """A match, with what whoever asks may see of it."""

    id: int
    kind: str
    track: str
    number: int  # of the suite or of its ladder, from 0
    state: str
    since: datetime | None  # None where how long it took is hidden
    created: datetime
    detail: str  # what went wrong, in one line
    platform_faults: int  # attempts that the platform broke
    judging: int  # more than 1 where organizers had it played again
    superseded: datetime | None  # since when a later judging counts in its place
    seats: list[SeatView]
    winner: str | None = None  # as people read it, or why there is none; None where it cannot be seen
    hidden: str | None  # why its record, trails and logs cannot be seen
    unseen: str | None  # why its outcomes cannot be seen by everyone
    record: str | None  # BLAKE2b digest of its record


class MatchList(View):
    """Matches, the newest first."""

    matches: list[MatchView]
    next: str | None  # the address of those that come after them


class AnnouncementView(View):
    """A text of the organizers."""

    id: int
    at: datetime
    author: str
    title: str
    text: str


class TrackView(View):
    """A track of the season."""

    name: str
    edition: int | None  # that is in force; None before the conductor has run
    mode: str  # "suite" or "ladder"
    suite: str  # from which its matches are
    rounds: int  # of the suite
    seats: int  # entrants in a match
    robots: list[str]  # that take part as entrants


class CountsView(View):
    """How much is going on."""

    teams: int
    submissions: int
    matches: int  # that were played


class ValidationView(View):
    """How submissions are validated, for ``wildscav check --season``."""

    sandbox: str
    limits: dict[str, dict[str, Any]]  # of an agent on each track
    model: bool  # whether agents may ask a language model


class SeasonView(View):
    """The season."""

    name: str
    title: str
    opens: datetime
    freezes: datetime | None
    closes: datetime
    registration: str  # "open" or "invited"
    commitment: str  # SHA-256 of the secret from which all seeds follow
    final_commitment: str  # SHA-256 of the secret of the matches that decide the season
    opened: str | None  # the secret, once it is opened
    final_opened: str | None  # that of the final matches, likewise
    paused: str | None  # why, if it is
    frozen: bool  # whether the public boards stay as they are
    finalized: bool  # whether the boards are final
    versions: dict[str, Any]
    tracks: list[TrackView]
    announcements: list[AnnouncementView]
    # Only where the season itself is asked for:
    counts: CountsView | None = None  # how much is going on
    validation: ValidationView | None = None  # how submissions are validated


class PointView(View):
    """A place of a submission at some time."""

    at: datetime
    team: str | None = None  # if the history of a team was asked for
    submission: int
    rank: int  # the best that it may have had
    last_rank: int  # the worst
    score: float  # on a ladder the rating
    low: float  # of its 95 % interval
    high: float
    matches: int  # played


class EntrantView(View):
    """Who plays on a ladder: a submission or a robot."""

    entrant: str  # its name in records
    name: str  # as people read it: of a submission with its version, or of a robot
    submission: int | None
    team: str | None
    title: str  # of its team, or the robot's name


class PairView(View):
    """How an entrant did against another one."""

    first: str
    second: str
    wins: int  # of the first one
    ties: int
    losses: int
    share: float  # of the points, where a tie is half a point


class HeadToHeadView(View):
    """How the entrants of a ladder did against each other."""

    track: str
    entrants: list[EntrantView]  # in the order of the board
    records: list[PairView]  # of those who met, each pair in both orders


class OpponentView(View):
    """How a submission did against an opponent."""

    opponent: EntrantView
    wins: int  # of the submission
    ties: int
    losses: int
    share: float  # of the points, where a tie is half a point


class WebhookView(View):
    """A webhook without its secret."""

    id: int
    url: str
    created: datetime
    disabled: str | None  # why, if it is


class NewWebhook(BaseModel):
    """What is needed to register a webhook."""

    url: str


class NewWebhookView(View):
    """A new webhook, with the secret that signs its messages, which is shown once."""

    webhook: WebhookView
    secret: str


class AuditEntryView(View):
    """A privileged act."""

    id: int
    at: datetime
    actor: str  # who did it
    act: str
    subject: str  # to whom or what
    detail: str
