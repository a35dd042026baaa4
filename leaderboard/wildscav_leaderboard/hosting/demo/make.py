"""Making the demo season: its folder, its people, and the submissions of its teams."""

import secrets
import shutil
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from importlib.resources import files
from pathlib import Path

import tomli_w

from wildscav.baselines import ALL_ROUND, baseline_folder
from wildscav.sdk.submission_folder import MANIFEST
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.choose import choose
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS
from wildscav_leaderboard.access.uploads import take_upload
from wildscav_leaderboard.accounts.models import COMPETITOR
from wildscav_leaderboard.accounts.passwords import hashed
from wildscav_leaderboard.accounts.service import add_account, find_account
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import FINISHED, PLAYING, WAITING, Match
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.organizing.status import count_by_state
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.initial_files import write_season_folder
from wildscav_leaderboard.seasons.own_database import opened
from wildscav_leaderboard.seasons.settings import SETTINGS_FILE
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.packing import pack
from wildscav_leaderboard.teams.service import make_team
from wildscav_server import leftovers

SUITE_FILE = "suite.toml"
ORGANIZER = "organizer"
WITHOUT_CONTAINERS = ("bubblewrap", "process")  # sandboxes, the strongest first
LASTS = timedelta(days=30)


@dataclass(frozen=True)
class Login:
    """An account with which people may look around."""

    name: str
    role: str
    password: str


def make_demo(folder: Path, port: int, sandbox: str | None = None) -> tuple[Season, tuple[Login, ...]]:
    """Make a season in a new folder, in which the all-round baselines are the submissions of the teams.

    Args:
        folder: The folder, which must be missing or empty.
        sandbox: In which agents run; None for the strongest that works here without containers.

    Returns:
        The season, and the accounts of an organizer and of each team.

    Raises:
        UserError: The folder cannot be made, or the sandbox does not work here.
    """
    now = datetime.now(UTC)
    write_season_folder(folder, _files(now, port, _sandbox(sandbox)))
    season = Season.open(folder)
    with opened(season) as database:
        logins = (_organizer(season, database, now), *(_team(database, name, now) for name in ALL_ROUND))
        for name in ALL_ROUND:
            _hand_in(season, database, name, now)
    return season, logins


def _sandbox(asked: str | None) -> str:
    candidates = [SANDBOXES[name] for name in ((asked,) if asked else WITHOUT_CONTAINERS)]
    return choose(asked, candidates, DEFAULT_LIMITS).sandbox.name


def _files(now: datetime, port: int, sandbox: str) -> dict[str, str]:
    """Return the content of the season's settings and its suite."""
    here = files(__package__)
    opens = now.replace(microsecond=0) - timedelta(hours=1)
    settings = (here / "season.toml").read_text("utf-8")
    dates = {"opens": opens.isoformat(), "closes": (opens + LASTS).isoformat()}
    return {
        SETTINGS_FILE: settings.format(port=port, sandbox=sandbox, **dates),
        SUITE_FILE: (here / SUITE_FILE).read_text("utf-8"),
    }


def _organizer(season: Season, database: Database, now: datetime) -> Login:
    login = Login(ORGANIZER, "organizer", _password())
    with database.writing() as session:
        doing = Doing(session, season, acts.COMMAND_LINE, now)
        acts.add_organizer(doing, login.name, password=login.password)
        acts.announce(
            doing,
            "Welcome",
            "The baselines play here on small maps. Hand in an agent of your own, and see where it comes in.",
        )
    return login


def _team(database: Database, name: str, now: datetime) -> Login:
    """Make a team of one competitor, who is called as it is."""
    login = Login(name, "competitor", _password())
    with database.writing() as session:
        account = add_account(session, name, hashed(login.password), COMPETITOR, now)
        make_team(session, account, name, f"Team {name.title()}", now)
    return login


def _password() -> str:
    return secrets.token_urlsafe(9)


def _hand_in(season: Season, database: Database, name: str, now: datetime) -> None:
    """Hand in a baseline for the team that is called like it, as the web site does with an upload."""
    with database.reading() as session:
        account = find_account(session, name)
    if account is None:
        raise RuntimeError(f"there is no account {name}")
    with leftovers.temporary_folder("demo-") as place:
        copy = place / name
        shutil.copytree(baseline_folder(name), copy)
        _restrict(copy / MANIFEST, tuple(season.settings.tracks))
        archive = place / f"{name}.tar.gz"
        pack(copy, archive)
        take_upload(database, season, account, archive, "the baseline that comes with Wildscav", now)


def _restrict(manifest: Path, tracks: tuple[str, ...]) -> None:
    """Let a submission play some tracks alone, since its check plays a match on each."""
    content = tomllib.loads(manifest.read_text("utf-8"))
    manifest.write_text(tomli_w.dumps({**content, "tracks": list(tracks)}), "utf-8")


@dataclass(frozen=True)
class Opening:
    """How far the season is."""

    submissions: int
    validated: int  # that take part, or failed
    played: int  # matches
    ahead: int  # matches that wait or are being played
    is_shown: bool = True  # whether all that take part are on the boards, which follow a moment later

    def is_ready(self, matches: int) -> bool:
        """Return whether so many matches are played, or as many as there are."""
        is_validated = self.is_shown and self.validated == self.submissions
        return is_validated and (self.played >= matches or not self.ahead)


def opening_of(database: Database, tracks: Iterable[str]) -> Opening:
    """Return how far a season is in which everybody plays some tracks."""
    with database.reading() as session:
        counted = count_by_state(session, Submission)
        played = count_by_state(session, Match)
        boards = [read_board(session, track) for track in tracks]
    over = sum(counted.get(state, 0) for state in (states.ACTIVE, *states.FINAL))
    ahead = sum(played.get(state, 0) for state in (WAITING, PLAYING))
    shown = [sum(row.submission is not None for row in board.rows) if board else 0 for board in boards]
    is_shown = min(shown) >= counted.get(states.ACTIVE, 0)
    return Opening(sum(counted.values()), over, played.get(FINISHED, 0), ahead, is_shown)
