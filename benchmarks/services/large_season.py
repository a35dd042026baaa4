"""A season with many submissions and results, none of which was played."""

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from sqlalchemy import case, insert, select
from sqlalchemy.orm import Session
from tests.leaderboard.results_made import made_result

from wildscav_evaluator.suites.seeds import new_secret
from wildscav_leaderboard.accounts.service import add_account
from wildscav_leaderboard.boards.matchmaking import ladder_match
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.models import PLAY, Attempt
from wildscav_leaderboard.database.base import Base
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, LADDER, SUITE, Match, MatchResult, MatchSeat
from wildscav_leaderboard.seasons.editions import digest_of
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.submissions.models import Submission, Transition
from wildscav_leaderboard.teams.models import Member, Team

PER_TEAM, SEATS = 2, 4
AT_A_TIME = 1000  # rows inserted at once
SETTINGS = """
name = "large"
title = "A large season"
opens = {opens}
closes = {closes}
registration = "open"

[quotas]
per_day = 1000
active = {per_team}
archive = 128

[execution]
sandbox = "process"

[web]
port = {port}
requests_per_minute = 1000000

[tracks.navigation]
mode = "suite"
suite = "small.toml"

[tracks.battle]
mode = "ladder"
suite = "small.toml"
seats = {seats}
matches = 40
robots = ["fighter"]
"""
SUITE_FILE = """
name = "small"

[map]
size = 40
houses = 0

[tracks.navigation]
maps = {matches}
episodes = 1
match = {{ time_limit = 4 }}

[tracks.battle]
maps = 10
episodes = 1
match = {{ time_limit = 4, seats = ["submission", "fighter"] }}
"""


class Size(NamedTuple):
    """How large a season is."""

    submissions: int
    suite_matches: int  # of each submission
    ladder_matches: int  # of all submissions together; even
    copies: int = 1  # how often all these matches are there

    @property
    def matches(self) -> int:
        """The number of matches before they are copied."""
        return self.submissions * self.suite_matches + self.ladder_matches


LARGE = Size(1000, 90, 10_000)


def make_large_season(folder: Path, port: int, size: Size = LARGE) -> Season:
    """Make a season in a new folder."""
    folder.mkdir(parents=True)
    now = datetime.now(UTC)
    settings = SETTINGS.format(
        opens=(now - timedelta(days=30)).isoformat(),
        closes=(now + timedelta(days=30)).isoformat(),
        per_team=PER_TEAM,
        port=port,
        seats=SEATS,
    )
    (folder / SETTINGS_FILE).write_text(settings)
    (folder / "small.toml").write_text(SUITE_FILE.format(matches=size.suite_matches * size.copies))
    for name in (SECRET_FILE, FINAL_SECRET_FILE):
        (folder / name).write_bytes(new_secret())
    season = Season.open(folder)
    database = season.database()
    database.upgrade()
    with database.writing() as session:
        begin_editions(session, season, now)
        season = in_force(session, season)
        _add_people(session, size, now)
        entrants = _add_submissions(session, size, now)
    _add_matches(database, season, size, entrants, now)
    for copy in range(1, size.copies):
        _copy_matches(database, size, copy)
    database.close()
    return season


def _add_people(session: Session, size: Size, now: datetime) -> None:
    """Add all teams, each with one member."""
    teams = range(1, size.submissions // PER_TEAM + 1)
    for number in teams:
        add_account(session, f"member-{number}", "no hash", "competitor", now)
    session.add_all(Team(name=f"team-{one}", title=f"Team {one}", created=now) for one in teams)
    session.flush()
    session.add_all(Member(account_id=one, team_id=one, joined=now) for one in teams)


def _add_submissions(session: Session, size: Size, now: datetime) -> list[str]:
    """Add active submissions; return their entrants."""
    path = ("submitted", "queued", "building", "validating", "active")
    found = []
    for number in range(size.submissions):
        created = now - timedelta(days=20, seconds=-60 * number)
        submission = Submission(
            team_id=1 + number // PER_TEAM,
            account_id=1 + number // PER_TEAM,
            name=f"agent-{number}",
            version="1.0",
            message="a message",
            tracks=["navigation", "battle"],
            digest=f"{number:032x}",
            content=f"{number:032x}",
            archive=f"{number:064x}.zip",
            size=100_000,
            created=created,
            state="active",
            since=created + timedelta(seconds=40),
            playing=["navigation", "battle"],
        )
        session.add(submission)
        session.flush()
        found.append(submission.entrant)
        session.add_all(
            Transition(submission_id=submission.id, at=created + timedelta(seconds=10 * step), state=state)
            for step, state in enumerate(path)
        )
    return found


def _add_matches(database: Database, season: Season, size: Size, entrants: list[str], now: datetime) -> None:
    """Add all matches with their seats, attempts and results."""
    digests = {track: digest_of(edition.conditions) for track, edition in season.editions.items()}
    skill = np.random.default_rng(0)
    strengths = skill.normal(0.0, 10.0, len(entrants))
    rows: list[tuple[dict[str, Any], ...]] = []
    for number, (match, seats) in enumerate(_matches(season, size, entrants), 1):
        at = now - timedelta(days=10) + timedelta(seconds=5 * number)
        for seat in seats:
            seat.match_id = number
        scores = [
            30.0 + float(strengths[(seat.submission_id or 1) - 1]) + skill.normal(0.0, 5.0) for seat in seats
        ]
        row, timing, record = made_result(match, seats, scores)
        rows.append(
            (
                _columns(match) | {"since": at, "created": at, "state": FINISHED},
                *(_columns(seat) for seat in seats),
                {
                    "kind": PLAY,
                    "number": 1,
                    "epoch": 1,
                    "started": at,
                    "deadline": at,
                    "match_id": number,
                    "ended": at,
                    "outcome": "done",
                },
                {
                    "match_id": number,
                    "attempt_id": number,
                    "at": at,
                    "row": row.model_dump(mode="json"),
                    "timing": timing.model_dump(mode="json"),
                    "conditions": digests[match.track],
                    "record": record.digest,
                    "record_size": record.size,
                    "fault": None,
                    "score": scores[0] if match.kind == SUITE else None,
                },
            )
        )
        if len(rows) == AT_A_TIME:
            _insert(database, rows)
            rows = []
    if rows:
        _insert(database, rows)


def _matches(season: Season, size: Size, entrants: list[str]) -> Iterator[tuple[Match, list[MatchSeat]]]:
    """Yield all matches with their seats."""
    now = datetime.now(UTC)

    def made(kind: str, track: str, number: int, group: int, spec: Any) -> Match:
        about = {"kind": kind, "track": track, "number": number, "group_id": group, "spec": spec}
        return Match(**about, edition_id=season.numbers[track], created=now, since=now)

    for place, spec in enumerate(season.suite_matches["navigation"][: size.suite_matches]):
        dumped = spec.model_dump(mode="json")
        for group, entrant in enumerate(entrants, 1):
            match = made(SUITE, "navigation", place, group, dumped)
            yield match, [MatchSeat(match_id=0, seat=0, submission_id=group, entrant=entrant)]
    suite, draw = season.suite("battle"), np.random.default_rng(1)
    for number in range(0, size.ladder_matches, 2):
        met = draw.choice(len(entrants), SEATS, replace=False)
        names = {entrants[one]: int(one) + 1 for one in met}
        for turn in range(2):
            spec, seated = ladder_match(suite, "battle", season.seed.value, number + turn, sorted(names))
            seats = [
                MatchSeat(match_id=0, seat=seat, submission_id=names[name], entrant=name)
                for seat, name in seated.items()
            ]
            yield made(LADDER, "battle", number + turn, 0, spec.model_dump(mode="json")), seats


def _columns(one: Match | MatchSeat) -> dict[str, Any]:
    """Return the values of a row that is not stored yet."""
    return {column.key: getattr(one, column.key) for column in one.__table__.columns if column.key != "id"}


def _insert(database: Database, rows: list[tuple[dict[str, Any], ...]]) -> None:
    with database.writing() as session:
        session.execute(insert(Match), [row[0] for row in rows])
        session.execute(insert(MatchSeat), [seat for row in rows for seat in row[1:-2]])
        session.execute(insert(Attempt), [row[-2] for row in rows])
        session.execute(insert(MatchResult), [row[-1] for row in rows])


def _copy_matches(database: Database, size: Size, copy: int) -> None:
    """Add all matches of the season once more, with other numbers."""
    more = copy * size.matches
    in_a_copy = case((Match.kind == SUITE, size.suite_matches), else_=size.ladder_matches)
    changed: dict[type[Base], dict[str, Any]] = {
        Match: {"id": Match.id + more, "number": Match.number + copy * in_a_copy},
        MatchSeat: {"match_id": MatchSeat.match_id + more},
        Attempt: {"id": Attempt.id + more, "match_id": Attempt.match_id + more},
        MatchResult: {"match_id": MatchResult.match_id + more, "attempt_id": MatchResult.attempt_id + more},
    }
    with database.writing() as session:
        for table, values in changed.items():
            columns = {column.key: column for column in table.__table__.columns} | values
            first = (table.id if table in {Match, Attempt} else table.match_id) <= size.matches
            session.execute(insert(table).from_select(list(columns), select(*columns.values()).where(first)))
