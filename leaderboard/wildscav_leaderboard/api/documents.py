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
    status: int


# What a route that answers with text or a file is described with, as its refusals are documents all the same.
REFUSALS: dict[int | str, dict[str, Any]] = {
    "4XX": {
        "description": "Why the request was refused.",
        "content": {"application/json": {"schema": {"$ref": "#/components/schemas/ErrorView"}}},
    }
}


class QuotaView(View):
    """What a team has used of its quota."""

    per_day: int
    used_today: int
    left_today: int
    resets: datetime
    active_per_track: int
    active: dict[str, int]  # by track
    archive: int  # MiB of an archive, at most


class TeamView(View):
    """A team."""

    name: str
    title: str
    created: datetime
    disqualified: str | None
    members: list[str]


class TeamRow(TeamView):
    """A team in a list of all."""

    submissions: int  # that it handed in
    active: int  # that take part


class AccountView(View):
    """Whoever asks."""

    name: str
    role: str
    team: TeamView | None
    quota: QuotaView | None


class NewAccount(BaseModel):
    """What is needed to register."""

    name: str
    password: str
    invitation: str | None = None


class NewAccountView(View):
    """A new account, with its first token, which is shown once."""

    name: str
    role: str
    token: str


class NewToken(BaseModel):
    """What is needed to get a token."""

    name: str
    password: str
    label: str = "token"


class NewTokenView(View):
    """A new token, which is shown once."""

    token: str


class TokenView(View):
    """A token without its secret part."""

    id: int
    label: str
    created: datetime
    used: datetime | None


class NewTeam(BaseModel):
    """What is needed to make a team."""

    name: str
    title: str = ""


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
    state: str
    detail: str


class SubmissionView(View):
    """A submission. Its team and the organizers see why it failed."""

    id: int
    team: str
    team_title: str  # as people read it
    name: str
    version: str
    message: str
    tracks: list[str]
    digest: str
    size: int
    created: datetime
    state: str
    playing: list[str]  # the tracks on which it takes part
    kept: bool  # whether no later one replaces it unasked
    replaces: dict[str, int] = {}  # by track, what will leave it, as things are now; not in lists
    since: datetime
    deadline: datetime | None
    queue_position: int | None = None
    expected_wait: float | None = None  # s
    validation: str = ""  # how far it is, in one line; not in lists
    charged: bool
    platform_faults: int
    fault: str | None
    reason: str | None = None
    last_lines: list[str] = []
    command: str | None = None
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
    status: str | None = None
    fault: str | None = None
    detail: str | None = None
    metrics: dict[str, float] | None = None
    place: int | None = None  # on a ladder, from 1; None where not every seat's outcome can be seen
    latency_p50: float | None = None  # s
    latency_p99: float | None = None
    latency_max: float | None = None
    late_steps: int | None = None

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
    detail: str
    platform_faults: int
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
    next: str | None


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
    mode: str
    suite: str
    rounds: int
    seats: int
    robots: list[str]


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
    registration: str
    commitment: str  # SHA-256 of the secret from which all seeds follow
    final_commitment: str  # SHA-256 of the secret of the matches that decide the season
    opened: str | None  # the secret, once it is opened
    final_opened: str | None
    paused: str | None  # why, if it is
    frozen: bool
    finalized: bool
    versions: dict[str, Any]
    tracks: list[TrackView]
    announcements: list[AnnouncementView]
    # Only where the season itself is asked for:
    counts: CountsView | None = None
    validation: ValidationView | None = None


class PointView(View):
    """A place of a submission at some time."""

    at: datetime
    team: str | None = None  # if the history of a team was asked for
    submission: int
    rank: int
    last_rank: int
    score: float
    low: float
    high: float
    matches: int


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
    wins: int
    ties: int
    losses: int
    share: float


class WebhookView(View):
    """A webhook without its secret."""

    id: int
    url: str
    created: datetime
    disabled: str | None


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
    actor: str
    act: str
    subject: str
    detail: str
