"""The documents of boards, which pages, the API and the audit share."""

from collections.abc import Iterable
from dataclasses import dataclass
from datetime import datetime
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field

from wildscav_evaluator.output.json_files import WithOptionalFields
from wildscav_evaluator.output.results import MetricInfo, OtherInterface, Summary, with_interface
from wildscav_evaluator.seats import robot_entrant
from wildscav_leaderboard.seasons.editions import Conditions, Part

FEWEST_MATCHES = 12  # 6 games, each played twice: in fewer, the interval of a rating says nothing


@dataclass(frozen=True)
class Entry:
    """Who takes part in a board."""

    entrant: str  # its name in matches
    submission: int | None  # None for a robot
    name: str
    version: str = ""
    team: str = ""  # empty for a robot
    team_title: str = ""
    since: datetime | None = None
    interface: OtherInterface | None = None  # by which it plays; None for numbers

    @classmethod
    def of(cls, submission: Any, team: str, title: str) -> "Entry":
        """Return a submission of a team, as it is stored or as it is published."""
        one = submission
        return cls(one.entrant, one.id, one.name, one.version, team, title, one.created, one.interface)

    @classmethod
    def of_robots(cls, robots: Iterable[str]) -> "list[Entry]":
        """Return the robots of a ladder."""
        return [cls(robot_entrant(robot), None, robot) for robot in robots]

    @property
    def shown(self) -> dict[str, Any]:
        """What its row has of it."""
        return {name: value for name, value in vars(self).items() if name != "entrant"}


class ProgressView(BaseModel):
    """How far a submission is on a track."""

    track: str
    played: int  # matches
    planned: int  # on a ladder: at most, if its rating is not settled before
    missing: int  # entrants without whom its ladder makes no match for it; 0 once it has one


class TotalsView(BaseModel):
    """How a submission did in all of its matches of a suite together."""

    track: str
    matches: int
    score: float  # their mean
    faults: dict[str, int]  # in how many matches it had each kind of fault


class Row(Part, WithOptionalFields):
    """A team's place on a board, with its best submission there."""

    omitted = ("interface",)

    rank: int | None  # the best that it may have; None until it can be ranked
    last_rank: int | None  # the worst that it may have
    team: str  # name
    team_title: str
    submission: int | None  # None for a robot
    name: str  # of the submission, or of the robot
    version: str
    matches: int  # played
    planned: int  # in all
    faults: int  # matches in which something went wrong in a seat of its own; on a suite 0 until it is ranked
    since: datetime | None  # when the submission was handed in
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers

    @property
    def agent(self) -> str:
        """The submission's name and version, with its interface unless it plays by numbers."""
        return with_interface(f"{self.name} {self.version}", self.interface)

    @property
    def ranks(self) -> str:
        """The ranks that it may have, such as "1–3" or "4"; empty until it can be ranked."""
        if self.rank is None:
            return ""
        return str(self.rank) if self.rank == self.last_rank else f"{self.rank}–{self.last_rank}"


class SuiteRow(Row):
    """A place on the board of a suite."""

    metrics: dict[str, Summary]  # by name; the first of the board's metrics is the score


class LadderRow(Row):
    """A place on the board of a ladder."""

    model_config = ConfigDict(frozen=True, extra="ignore")  # older boards have OpenSkill's mu and sigma

    rating: float  # on the scale of Elo; the mean of those who met is 1500
    deviation: float  # standard deviation of the rating
    low: float  # of the rating's 95 % interval
    high: float
    provisional: bool = False  # until its interval is as narrow as the season asks
    wins: int  # matches in which it was first, alone
    mean_place: float | None  # a tie counts as the mean of the places that it covers

    @property
    def is_measured(self) -> bool:
        """Whether it has played enough for its interval to say anything, or all that it will play."""
        return not self.provisional or self.matches >= min(FEWEST_MATCHES, self.planned)


class SuiteBoard(Part):
    """The board of a track on which every submission plays the same suite."""

    mode: Literal["suite"] = "suite"
    format: Literal[1] = 1
    track: str
    conditions: Conditions
    updated: datetime  # when the last result that counts arrived
    metrics: tuple[MetricInfo, ...]  # the first is the score
    entered: tuple[int, ...] = ()  # the submissions that take part; each team's best one has a row
    rows: tuple[SuiteRow, ...]  # the best first; those that cannot be ranked yet come last


class LadderBoard(Part):
    """The board of a track on which submissions meet each other."""

    mode: Literal["ladder"] = "ladder"
    format: Literal[1] = 1
    track: str
    conditions: Conditions
    updated: datetime
    applied: int  # matches under these conditions that the ratings come from: the first ones that were made
    metrics: tuple[MetricInfo, ...]  # by which the entrants of a match are placed, and the others
    entered: tuple[int, ...] = ()  # the submissions that take part; each team's best one has a row
    rows: tuple[LadderRow, ...]  # the highest rating first; a provisional one is where its low is


BoardDocument = Annotated[SuiteBoard | LadderBoard, Field(discriminator="mode")]


def place_of(board: SuiteBoard | LadderBoard, row: Row) -> tuple[float, float, float]:
    """Return what a row is ranked by, with its 95 % interval: its mean score, or its rating."""
    if isinstance(row, SuiteRow):
        score = row.metrics[board.metrics[0].name]
        return score.mean, score.low, score.high
    rating: Any = row
    return rating.rating, rating.low, rating.high
