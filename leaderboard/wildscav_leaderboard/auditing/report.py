"""What an audit found: what is wrong, what was checked, and what could not be."""

from dataclasses import dataclass, field
from typing import Any

from wildscav_leaderboard.boards.documents import Row
from wildscav_leaderboard.publishing.documents import BoardFile, PublishedMatch


@dataclass(frozen=True)
class Finding:
    """One thing that is published and wrong."""

    problem: str  # one line
    track: str | None = None  # navigation-season: of the board before final matches decided the season
    team: str | None = None
    submission: int | None = None
    match: int | None = None
    field: str | None = None  # with dots, such as metrics.time.mean
    published: Any = None
    expected: Any = None  # what should be published instead

    def __str__(self) -> str:
        places = (
            self.track,
            f"team {self.team}" if self.team else None,
            f"submission {self.submission}" if self.submission is not None else None,
            f"match {self.match}" if self.match is not None else None,
        )
        where = ", ".join(place for place in places if place is not None)
        return f"{where}: {self.problem}" if where else self.problem


def wrong_value(name: str, published: Any, expected: Any, **place: Any) -> Finding:
    """Return the finding that a field has a wrong value."""
    return Finding(
        f"{name} is published as {published}, must be {expected}",
        field=name,
        published=published,
        expected=expected,
        **place,
    )


def of_row(row: Row) -> dict[str, Any]:
    """Return where a finding about a row of a board is."""
    return {"team": row.team or f"robot:{row.name}", "submission": row.submission}


def of_match(match: PublishedMatch, file: BoardFile) -> dict[str, Any]:
    """Return where a finding about a match is: in a suite, with whose match it is."""
    own = file.by_number.get(match.submission or 0)
    return {"match": match.id, "submission": match.submission, "team": None if own is None else own.team}


@dataclass
class Check:
    """How much of something was checked."""

    what: str
    track: str | None
    checked: int = 0
    unchecked: dict[str, int] = field(default_factory=dict)  # how many were not, by the reason

    def skip(self, why: str, count: int = 1) -> None:
        """Note that some could not be checked."""
        if count:
            self.unchecked[why] = self.unchecked.get(why, 0) + count


@dataclass
class Report:
    """The result of an audit."""

    season: str
    address: str
    commitments: tuple[str, str]  # to the season's secret, and to that of its final matches
    findings: list[Finding] = field(default_factory=list)
    checks: list[Check] = field(default_factory=list)

    @property
    def holds(self) -> bool:
        """Whether nothing is wrong."""
        return not self.findings

    def check(self, what: str, track: str | None = None) -> Check:
        """Begin to count how much of something is checked."""
        found = Check(what, track)
        self.checks.append(found)
        return found
