"""What a team may hand in, when, and how its submissions go from state to state."""

import shutil
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
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
from wildscav_leaderboard.boards.documents import Entry
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.publishing.documents import PublishedSubmission
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import RefusalError, TooMuchError
from wildscav_leaderboard.seasons.state import NODES, write_state
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.archives import CheckedArchive
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.queue import queue
from wildscav_leaderboard.submissions.service import StateError, hand_in, move
from wildscav_leaderboard.teams.service import find_team, leave_team, make_team

PLAYS = (states.QUEUED, states.BUILDING, states.VALIDATING, states.ACTIVE)
AGENT = "from wildscav.agent import Action\n\n\nclass Agent:\n    number = {number}\n"


@dataclass
class Desk:
    """A season with the teams foxes and owls, where submissions are handed in."""

    database: Database
    season: Season
    agents: list[Path]  # eight, of different content

    def enter(self, agent: int, team: str = "foxes", now: datetime = NOON) -> Submission:
        with self.database.writing() as session:
            return submitted(session, self.season, team, self.agents[agent], now)

    def disqualify(self, why: str) -> None:
        with self.database.writing() as session:
            find_team(session, "foxes").disqualified = why


@pytest.fixture
def desk(database: Database, tmp_path: Path) -> Desk:
    folders = [tmp_path / f"agent{number}" for number in range(8)]
    for number, folder in enumerate(folders):
        folder.mkdir()
        (folder / "submission.toml").write_text(
            'name = "runner"\nversion = "1"\nentry_point = "agent:Agent"\ntracks = ["navigation"]\n'
        )
        (folder / "agent.py").write_text(AGENT.format(number=number))
    with database.writing() as session:
        team_with_member(session, "foxes")
        team_with_member(session, "owls")
    return Desk(database, make_season(tmp_path / "season"), folders)


def step(desk: Desk, submission: Submission, *following: str, fault: str | None = None) -> None:
    with desk.database.writing() as session:
        found = session.get_one(Submission, submission.id)
        for state in following:
            move(session, found, state, NOON, fault=fault if state == states.FAILED else None)


def test_by_which_interface_a_submission_plays_is_kept_for_boards_and_audits(desk: Desk) -> None:
    with (desk.agents[1] / "submission.toml").open("a") as manifest:
        manifest.write('interface = "words"\n')
    found = [desk.enter(agent) for agent in (0, 1)]
    assert [Entry.of(one, "foxes", "Foxes").interface for one in found] == [None, "words"]
    published = [PublishedSubmission.about(one, team="foxes", team_title="Foxes") for one in found]
    assert [one.model_dump().get("interface") for one in published] == [None, "words"]


def test_the_day_ends_at_midnight_utc(desk: Desk) -> None:
    late = NOON.replace(hour=23, minute=59)
    for agent in range(3):
        desk.enter(agent, now=late)
    with pytest.raises(TooMuchError, match="the next day begins at 2030-06-02 00:00 UTC"):
        desk.enter(3, now=late)
    desk.enter(3, "owls", late)  # the quota is each team's own
    desk.enter(3, now=late + timedelta(minutes=1))


def captain_of(session: Session, team: str) -> Account:
    captain = find_account(session, f"{team}-captain")
    assert captain is not None
    return captain


def found_another(desk: Desk, other: str) -> None:
    """Let the captain of the foxes leave them, and make another team."""
    with desk.database.writing() as session:
        leave_team(session, captain_of(session, "foxes"))
        make_team(session, captain_of(session, "foxes"), other, "", NOON)


def test_the_quota_is_each_accounts_too_whatever_its_team(desk: Desk) -> None:
    for agent in range(2):
        desk.enter(agent)
    found_another(desk, "hares")
    desk.enter(2, "hares")
    with pytest.raises(TooMuchError, match="you have, in this team and others, used today's 3 submissions"):
        desk.enter(3, "hares")


def test_who_submitted_for_a_disqualified_team_submits_for_no_other_one(desk: Desk) -> None:
    desk.enter(0)
    found_another(desk, "hares")
    desk.disqualify("copied")
    with pytest.raises(RefusalError, match="foxes, for which you submitted, is disqualified: copied"):
        desk.enter(1, "hares")


def test_a_disqualified_team_hands_nothing_in_and_its_members_stay_in_it(desk: Desk) -> None:
    desk.disqualify("it copied the owls")
    with pytest.raises(RefusalError, match="disqualified: it copied the owls"):
        desk.enter(0)
    with desk.database.writing() as session, pytest.raises(RefusalError, match="members cannot leave it"):
        leave_team(session, captain_of(session, "foxes"))


@pytest.mark.parametrize(
    ("message", "left_out", "says"), [("x" * 201, "", "message"), ("", "agent.py", "no file")]
)
def test_nothing_is_kept_of_an_upload_that_is_refused(
    *, desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, message: str, left_out: str, says: str
) -> None:
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "cache"))
    (desk.agents[0] / left_out).unlink() if left_out else None
    upload = Path(shutil.make_archive(str(tmp_path / "upload" / "submission"), "gztar", desk.agents[0]))
    with desk.database.reading() as session:
        captain = captain_of(session, "foxes")
    with pytest.raises(RefusalError, match=says):
        take_upload(desk.database, desk.season, captain, upload, message, NOON)
    assert not desk.season.archives.exists()
    assert not (tmp_path / "cache" / "submissions").exists()


def test_a_fault_of_the_platform_is_never_charged(desk: Desk) -> None:
    for agent in range(3):
        one = desk.enter(agent)
    with desk.database.writing() as session:
        found = session.get_one(Submission, one.id)
        for _ in range(2):  # an attempt that the platform broke, and another one
            move(session, found, states.QUEUED, NOON)
            move(session, found, states.BUILDING, NOON)
        move(session, found, states.FAILED, NOON, fault="platform", reason="the disk was full")
        quota = quota_view(session, desk.season, find_team(session, "foxes"), NOON)
    assert (quota.used_today, quota.left_today) == (2, 1)
    desk.enter(3)


def test_a_fault_of_the_agent_and_a_withdrawal_stay_charged(desk: Desk) -> None:
    first, second = (desk.enter(agent) for agent in range(2))
    with desk.database.writing() as session:
        move(session, session.get_one(Submission, first.id), states.FAILED, NOON, fault="agent")
        move(session, session.get_one(Submission, second.id), states.CANCELLED, NOON)
        quota = quota_view(session, desk.season, find_team(session, "foxes"), NOON)
    assert quota.used_today == 2


@pytest.mark.parametrize(
    ("when", "why"),
    [(NOON - timedelta(days=2), "opens at 2030-05-31"), (NOON + timedelta(days=9), "closed at 2030-06-10")],
)
def test_nothing_is_accepted_before_the_season_or_after_it(desk: Desk, when: datetime, why: str) -> None:
    with pytest.raises(RefusalError, match=why):
        desk.enter(0, now=when)


def test_the_same_content_is_not_taken_twice(desk: Desk) -> None:
    first = desk.enter(0)
    with pytest.raises(RefusalError, match=f"submission {first.id} has the same content"):
        desk.enter(0)
    desk.enter(0, "owls")  # another team may have had the same idea
    step(desk, first, states.CANCELLED)
    desk.enter(0)


@pytest.mark.parametrize(
    ("steps", "fault", "advice"),
    [
        ((*PLAYS, states.DISABLED), None, "restore it"),
        ((states.QUEUED, states.FAILED), "agent", "change what made it fail"),
        ((states.QUEUED, states.FAILED), "platform", None),
    ],
)
def test_a_new_version_string_is_no_new_content_even_of_a_submission_that_is_over(
    desk: Desk, steps: tuple[str, ...], fault: str | None, advice: str | None
) -> None:
    first = desk.enter(0)
    step(desk, first, *steps, fault=fault)
    manifest = desk.agents[0] / "submission.toml"
    manifest.write_text(manifest.read_text().replace('"1"', '"1.1"') + '\nauthor = "a fox"\n')
    if advice is None:
        desk.enter(0)
        return
    with pytest.raises(RefusalError, match=rf"submission {first.id} has the same content .*{advice}"):
        desk.enter(0)
    manifest.write_text(manifest.read_text().replace("navigation", "battle"))
    desk.enter(0)  # on no track of the first


def test_a_state_that_cannot_follow_is_refused(desk: Desk) -> None:
    one = desk.enter(0)
    with pytest.raises(StateError, match=f"submission {one.id} is submitted, and cannot become active"):
        step(desk, one, states.ACTIVE)


def test_a_team_that_submits_much_delays_nobody_but_itself(desk: Desk) -> None:
    many = [desk.enter(agent) for agent in range(3)]
    other = desk.enter(3, "owls")
    with desk.database.reading() as session:
        assert [one.id for one in queue(session)] == [many[0].id, other.id, many[1].id, many[2].id]
        shown = submission_view(session, desk.season, other, None, NOON)
        assert shown.queue_position == 2
        assert shown.expected_wait == 120.0  # nothing is known yet: a minute each
    with desk.database.writing() as session:
        write_state(session, NODES, {"validations": 2}, NOON)
        shown = submission_view(session, desk.season, other, None, NOON)
        assert shown.expected_wait == 60.0  # beside the first


def test_two_uploads_at_once_do_not_exceed_the_quota(desk: Desk) -> None:
    archives = [checked(desk.season, folder) for folder in desk.agents]

    def try_one(archive: CheckedArchive) -> bool:
        try:
            with desk.database.writing() as session:
                team, captain = find_team(session, "foxes"), captain_of(session, "foxes")
                hand_in(session, desk.season, team, captain, archive, "", NOON)
        except TooMuchError:
            return False
        return True

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(try_one, archives)) == 3
