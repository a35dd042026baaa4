"""Seasons, teams and submissions for tests, with the real services."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from wildscav_evaluator.suites.seeds import new_secret
from wildscav_leaderboard.accounts.models import COMPETITOR, Account
from wildscav_leaderboard.accounts.service import add_account
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import FINAL_SECRET_FILE, SECRET_FILE, Season
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.submissions.archives import CheckedArchive, check_archive, store_archive
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.packing import pack
from wildscav_leaderboard.submissions.service import hand_in
from wildscav_leaderboard.teams.models import Member, Team
from wildscav_leaderboard.teams.service import find_team, make_team

NOON = datetime(2030, 6, 1, 12, tzinfo=UTC)
SETTINGS = """
name = "trial"
title = "The trial season"
opens = {opens}
closes = {closes}
registration = "open"

[quotas]
per_day = 3
active = 2

[execution]
sandbox = "process"

[tracks.navigation]
mode = "suite"
suite = "tiny.toml"

[tracks.battle]
mode = "ladder"
suite = "tiny.toml"
seats = 2
robots = ["fighter"]
{more}
"""
SUITE = """
name = "tiny"

[map]
size = 40
houses = 0

[tracks.navigation]
maps = 2
episodes = 1
match = { time_limit = 4 }

[tracks.battle]
maps = 1
episodes = 1
match = { time_limit = 4, seats = ["submission", "fighter"] }
"""


def make_season(folder: Path, more: str = "", *, current: bool = False, **dates: datetime) -> Season:
    """Make a season's folder with short matches, open around ``NOON``, or around the present time."""
    folder.mkdir(parents=True, exist_ok=True)
    noon = datetime.now(UTC) if current else NOON
    opens = dates.get("opens", noon - timedelta(days=1))
    closes = dates.get("closes", noon + timedelta(days=9))
    text = SETTINGS.format(opens=opens.isoformat(), closes=closes.isoformat(), more=more)
    (folder / SETTINGS_FILE).write_text(text)
    (folder / "tiny.toml").write_text(SUITE)
    for name in (SECRET_FILE, FINAL_SECRET_FILE):
        (folder / name).write_bytes(new_secret())
    return Season.open(folder)


def changed(season: Season, **settings: Any) -> Season:
    """Return a season with some other settings."""
    return replace(season, settings=season.settings.model_copy(update=settings))


@contextmanager
def opened(season: Season) -> Iterator[Database]:
    """Give a season's database, with all tables."""
    database = season.database()
    database.upgrade()
    yield database
    database.close()


def make_account(session: Session, name: str, role: str = COMPETITOR) -> Account:
    """Make an account whose password nobody knows."""
    return add_account(session, name, "no hash", role, NOON)


def team_with_member(session: Session, name: str) -> tuple[Team, Account]:
    """Make a team with one member."""
    account = make_account(session, f"{name}-captain")
    return make_team(session, account, name, name.title(), NOON)[0], account


def checked(season: Season, folder: Path) -> CheckedArchive:
    """Pack a submission, check it, and put it into the season's files."""
    path = season.folder / "uploads" / f"{folder.name}.tar.gz"
    path.parent.mkdir(exist_ok=True)
    pack(folder, path)
    archive = check_archive(path, season)
    store_archive(archive, season)
    return archive


def submitted(session: Session, season: Season, team: str, folder: Path, now: datetime = NOON) -> Submission:
    """Hand in a folder for a team."""
    found = find_team(session, team)
    account = session.scalars(select(Account).join(Member).where(Member.team_id == found.id)).first()
    assert account is not None
    return hand_in(session, season, found, account, checked(season, folder), "", now)
