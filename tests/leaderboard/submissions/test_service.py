"""What a team may hand in, when, and how its submissions go from state to state."""

import shutil
from datetime import datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy.orm import Session
from tests.leaderboard.seasons_made import NOON, checked, make_season, submitted, team_with_member

from wildscav_leaderboard.access.uploads import take_upload
from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.service import find_account
from wildscav_leaderboard.api.accounts import quota_view
from wildscav_leaderboard.api.submissions import submission_view
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import RefusalError, TooMuchError
from wildscav_leaderboard.seasons.state import NODES, write_state
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.submissions.service import (
    StateError,
    hand_in,
    move,
)
from wildscav_leaderboard.teams.service import find_team, leave_team, make_team

AGENT = "from wildscav.agent import Action\n\n\nclass Agent:\n    number = {number}\n"


@pytest.fixture
def season(tmp_path: Path) -> Season:
    return make_season(tmp_path / "season")


@pytest.fixture
def agents(tmp_path: Path) -> list[Path]:
    """Eight submissions of different content."""
    folders = []
    for number in range(8):
        folder = tmp_path / f"agent{number}"
        folder.mkdir()
        (folder / "submission.toml").write_text(
            'name = "runner"\nversion = "1"\nentry_point = "agent:Agent"\ntracks = ["navigation"]\n'
        )
        (folder / "agent.py").write_text(AGENT.format(number=number))
        folders.append(folder)
    return folders


@pytest.fixture
def foxes(database: Database) -> str:
    with database.writing() as session:
        team_with_member(session, "foxes")
        team_with_member(session, "owls")
    return "foxes"


def enter(database: Database, season: Season, team: str, folder: Path, now: datetime = NOON) -> Submission:
    with database.writing() as session:
        return submitted(session, season, team, folder, now)


def step(database: Database, submission: Submission, *following: str, now: datetime = NOON) -> None:
    with database.writing() as session:
        found = session.get_one(Submission, submission.id)
        for state in following:
            move(session, found, state, now)


def test_the_day_ends_at_midnight_utc(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    late = NOON.replace(hour=23, minute=59)
    for folder in agents[:3]:
        enter(database, season, foxes, folder, late)
    with pytest.raises(TooMuchError, match="the next day begins at 2030-06-02 00:00 UTC"):
        enter(database, season, foxes, agents[3], late)
    enter(database, season, "owls", agents[3], late)  # the quota is each team's own
    enter(database, season, foxes, agents[3], late + timedelta(minutes=1))


def captain_of(session: Session, team: str) -> Account:
    captain = find_account(session, f"{team}-captain")
    assert captain is not None
    return captain


def found_another(database: Database, team: str, other: str) -> None:
    """Let the captain of a team leave it, and make another one."""
    with database.writing() as session:
        leave_team(session, captain_of(session, team))
        make_team(session, captain_of(session, team), other, "", NOON)


def test_the_quota_is_each_accounts_too_whatever_its_team(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    for folder in agents[:2]:
        enter(database, season, foxes, folder)
    found_another(database, foxes, "hares")
    enter(database, season, "hares", agents[2])
    with pytest.raises(TooMuchError, match="you have, in this team and others, used today's 3 submissions"):
        enter(database, season, "hares", agents[3])


def test_who_submitted_for_a_disqualified_team_submits_for_no_other_one(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    enter(database, season, foxes, agents[0])
    found_another(database, foxes, "hares")
    with database.writing() as session:
        find_team(session, foxes).disqualified = "copied"
    with pytest.raises(RefusalError, match="foxes, for which you submitted, is disqualified: copied"):
        enter(database, season, "hares", agents[1])


def test_members_of_a_disqualified_team_stay_in_it(database: Database, foxes: str) -> None:
    with database.writing() as session:
        find_team(session, foxes).disqualified = "copied"
        with pytest.raises(RefusalError, match="its members cannot leave it"):
            leave_team(session, captain_of(session, foxes))


@pytest.mark.parametrize(
    ("message", "left_out", "says"), [("x" * 201, "", "message"), ("", "agent.py", "no file")]
)
def test_nothing_is_kept_of_an_upload_that_is_refused(
    *,
    database: Database,
    season: Season,
    agents: list[Path],
    foxes: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    message: str,
    left_out: str,
    says: str,
) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))
    (agents[0] / left_out).unlink() if left_out else None
    upload = Path(shutil.make_archive(str(tmp_path / "upload" / "submission"), "gztar", agents[0]))
    with database.reading() as session:
        captain = captain_of(session, foxes)
    with pytest.raises(RefusalError, match=says):
        take_upload(database, season, captain, upload, message, NOON)
    assert not season.archives.exists()
    assert not (tmp_path / "cache" / "submissions").exists()


def test_a_fault_of_the_platform_is_never_charged(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    for folder in agents[:3]:
        one = enter(database, season, foxes, folder)
    with database.writing() as session:
        found = session.get_one(Submission, one.id)
        for _ in range(2):  # an attempt that the platform broke, and another one
            move(session, found, states.QUEUED, NOON)
            move(session, found, states.BUILDING, NOON)
        move(session, found, states.FAILED, NOON, fault="platform", reason="the disk was full")
        quota = quota_view(session, season, find_team(session, foxes), NOON)
    assert (quota.used_today, quota.left_today) == (2, 1)
    enter(database, season, foxes, agents[3])


def test_a_fault_of_the_agent_and_a_withdrawal_stay_charged(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    first, second = (enter(database, season, foxes, folder) for folder in agents[:2])
    with database.writing() as session:
        move(session, session.get_one(Submission, first.id), states.FAILED, NOON, fault="agent")
        move(session, session.get_one(Submission, second.id), states.CANCELLED, NOON)
        quota = quota_view(session, season, find_team(session, foxes), NOON)
    assert quota.used_today == 2


@pytest.mark.parametrize(
    ("when", "why"),
    [(NOON - timedelta(days=2), "opens at 2030-05-31"), (NOON + timedelta(days=9), "closed at 2030-06-10")],
)
def test_nothing_is_accepted_before_the_season_or_after_it(
    database: Database, season: Season, agents: list[Path], foxes: str, when: datetime, why: str
) -> None:
    with pytest.raises(RefusalError, match=why):
        enter(database, season, foxes, agents[0], when)


def test_the_same_content_is_not_taken_twice(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    first = enter(database, season, foxes, agents[0])
    with pytest.raises(RefusalError, match=f"submission {first.id} has the same content"):
        enter(database, season, foxes, agents[0])
    enter(database, season, "owls", agents[0])  # another team may have had the same idea
    step(database, first, states.CANCELLED)
    enter(database, season, foxes, agents[0])


@pytest.mark.parametrize(
    ("steps", "fault", "advice"),
    [
        (
            (states.QUEUED, states.BUILDING, states.VALIDATING, states.ACTIVE, states.DISABLED),
            None,
            "restore it",
        ),
        ((states.QUEUED, states.FAILED), "agent", "change what made it fail"),
        ((states.QUEUED, states.FAILED), "platform", None),
    ],
)
def test_a_new_version_string_is_no_new_content_even_of_a_submission_that_is_over(
    database: Database,
    season: Season,
    agents: list[Path],
    foxes: str,
    steps: tuple[str, ...],
    fault: str | None,
    advice: str | None,
) -> None:
    first = enter(database, season, foxes, agents[0])
    with database.writing() as session:
        for state in steps:
            same_fault = fault if state == states.FAILED else None
            move(session, session.get_one(Submission, first.id), state, NOON, fault=same_fault)
    manifest = agents[0] / "submission.toml"
    manifest.write_text(manifest.read_text().replace('"1"', '"1.1"') + '\nauthor = "a fox"\n')
    if advice is None:
        enter(database, season, foxes, agents[0])
        return
    with pytest.raises(RefusalError, match=rf"submission {first.id} has the same content .*{advice}"):
        enter(database, season, foxes, agents[0])
    manifest.write_text(manifest.read_text().replace("navigation", "battle"))
    enter(database, season, foxes, agents[0])  # on no track of the first


def test_a_disqualified_team_hands_nothing_in(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    with database.writing() as session:
        find_team(session, foxes).disqualified = "it copied the owls"
    with pytest.raises(RefusalError, match="disqualified: it copied the owls"):
        enter(database, season, foxes, agents[0])


def test_a_state_that_cannot_follow_is_refused(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    one = enter(database, season, foxes, agents[0])
    with pytest.raises(StateError, match=f"submission {one.id} is submitted, and cannot become active"):
        step(database, one, states.ACTIVE)


def test_a_team_that_submits_much_delays_nobody_but_itself(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    many = [enter(database, season, foxes, folder) for folder in agents[:3]]
    other = enter(database, season, "owls", agents[3])
    with database.reading() as session:
        assert [one.id for one in queue(session)] == [many[0].id, other.id, many[1].id, many[2].id]
        shown = submission_view(session, season, other, None, NOON)
        assert shown.queue_position == 2
        assert shown.expected_wait == 120.0  # nothing is known yet: a minute each
    with database.writing() as session:
        write_state(session, NODES, {"validations": 2}, NOON)
        assert submission_view(session, season, other, None, NOON).expected_wait == 60.0  # beside the first


def test_two_uploads_at_once_do_not_exceed_the_quota(
    database: Database, season: Season, agents: list[Path], foxes: str
) -> None:
    from concurrent.futures import ThreadPoolExecutor

    archives = [checked(season, folder) for folder in agents]

    def try_one(archive: object) -> bool:
        try:
            with database.writing() as session:
                team = find_team(session, foxes)
                from wildscav_leaderboard.accounts.service import find_account

                account = find_account(session, "foxes-captain")
                assert account is not None
                hand_in(session, season, team, account, archive, "", NOON)  # type: ignore[arg-type]
        except TooMuchError:
            return False
        return True

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(try_one, archives)) == 3
