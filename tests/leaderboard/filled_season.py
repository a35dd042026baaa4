"""A season in full swing, for tests of pages and the API: submissions in every state, boards with results.

Everything goes through the real services. The matches are not played: their results are drawn from how strong
each submission is said to be.
"""

import pickle
import shutil
from dataclasses import dataclass, field
from datetime import UTC, datetime, timedelta
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from sqlalchemy.orm import Session
from tests.evaluator.results_by_hand import timing_of_a_seat
from tests.leaderboard.made_once import made_once
from tests.leaderboard.results_made import made_timing
from tests.leaderboard.seasons_made import checked, make_season

from wildscav_evaluator.output.results import MatchRow, SeatRow, SeatTiming, metric_infos
from wildscav_leaderboard.accounts.models import COMPETITOR, ORGANIZER
from wildscav_leaderboard.accounts.passwords import hashed
from wildscav_leaderboard.accounts.service import add_account, find_account, new_token, open_web_session
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.conductor import lease, steps
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import LADDER, Match, MatchSeat
from wildscav_leaderboard.matches.service import PlayedRecord, seats_of
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import hand_in, move
from wildscav_leaderboard.teams.service import find_team, make_team
from wildscav_leaderboard.webhooks.service import add_webhook

PASSWORD = "a long enough password"  # noqa: S105 (of every account here)
SANDBOX = "process"
NODE = {"name": "arena-1", "cores": 2, "running": 1, "problem": None}
BATCH = 24  # matches between two refreshes of the boards
GAMES = 24  # matches of each submission on the ladder
MORE = f"matches = {GAMES}\n\n[web]\nrequests_per_minute = 1000000\n"
SUITE = """
name = "tiny"

[map]
size = 60

[tracks.navigation]
maps = 12
episodes = 1
match = { time_limit = 60 }

[tracks.battle]
maps = 4
episodes = 1
match = { time_limit = 30, seats = ["submission", "fighter"] }
"""
COOKIE = "wildscav-trial"  # of a browser that is logged in
MANIFEST = 'name = "{name}"\nversion = "{version}"\nentry_point = "agent:Player"\ntracks = {tracks}\n'
AGENT = "from wildscav import Action, Agent\n\nclass Player(Agent):\n    def act(self, observation):\n"
AGENT += "        return Action()\n"


class Words(NamedTuple):
    """The texts that people and agents write into a season."""

    title: str = "Night Owls"  # of the team owls
    message: str = "Looks twice before it leaps"  # of its submissions
    announcement: str = "Maintenance on Friday"
    text: str = "Nothing is played from 18:00 to 18:30 UTC."
    reason: str = "it asked other agents for help"  # why the team newts is disqualified
    failure: str = "RuntimeError: lost the thread"
    output: str = "step 6\nstep 7"
    label: str = "laptop"  # of a token, an invitation and a paused season
    address: str = "https://example.org/hook"


HOSTILE = Words(
    title="<script>alert('title')</script> \"Owls\"",
    message="\"><script>alert('message')</script>",
    announcement="<script>alert('announcement')</script>",
    text="</article><script>alert('text')</script>",
    reason="<script>alert('reason')</script>",
    failure="<script>alert('failure')</script>\x1b[2J",
    output="<script>alert('output')</script>\n\x1b[2J\x1b]0;title\x07 \u202e",
    label="<script>alert('label')</script>'\"",
    address="https://example.org/<script>alert('address')</script>'\"",
)


PEOPLE = {"boss": "organizer", "passer-by": "other", "owls": "owner", "foxes": "opponent"}


@dataclass(frozen=True)
class Person:
    """Somebody who can log in."""

    name: str
    token: str
    cookie: str
    csrf: str


class Entry(NamedTuple):
    """A submission that takes part, and how good it is."""

    team: str
    title: str
    name: str
    version: str
    skill: float


ENTRIES = (
    Entry("owls", "", "night-owl", "1.0", 0.7),
    Entry("foxes", "Red Foxes", "pathfinder", "0.9", 0.9),
    Entry("hares", "Hares & Hounds", "zigzag", "2.1", 0.5),
    Entry("newts", "Newts", "copycat", "1.0", 0.99),
    Entry("owls", "", "night-owl", "1.1", 0.8),
)


@dataclass
class FilledSeason:
    """A season, its database, and what is in it."""

    season: Season
    database: Database
    words: Words
    # organizer, owner, opponent, and other, who is of no team
    people: dict[str, Person] = field(default_factory=dict)
    submissions: dict[str, int] = field(default_factory=dict)  # active, failed, queued, building, …
    # By kind: suite, and one of the owner's there (own_suite); ladder, which may be seen; playing.
    matches: dict[str, int] = field(default_factory=dict)

    def give_records(self, content: bytes) -> None:
        """Let every match that was played have a record with some content."""
        for log in self.season.files.rglob("seat.log"):
            log.with_name("match.wsr").write_bytes(content)


class _Filling:
    """Fills a season as its conductor, competitors and organizers would, with a clock of its own."""

    def __init__(self, filled: FilledSeason, folder: Path) -> None:
        self.filled, self.season, self.words = filled, filled.season, filled.words
        self._agents = folder
        self._random = np.random.default_rng(5)
        self._skills: dict[int | None, float] = {None: 0.3}
        self._end = datetime.now(UTC).replace(microsecond=0)
        self.now = self.season.settings.opens + timedelta(minutes=1)
        self._holding = lease.Holding("", 0)

    def _wait(self, minutes: float) -> None:
        self.now = min(self.now + timedelta(minutes=minutes), self._end)

    def fill(self, session: Session) -> None:
        holding = lease.acquire(session, "arena-1/4711/0a1b2c3d", self.now)
        assert holding is not None
        self._holding = holding
        begin_editions(session, self.season, self.now)
        self._people(session)
        for entry in ENTRIES:
            number = self._entered(session, entry.team, entry.name, entry.version)
            self._skills[number] = entry.skill
            self._take_part(session)
            self.filled.submissions["active"] = number
            self._play(session, BATCH)
        while self._play(session, BATCH):
            pass
        self._failures(session)
        self._acts(session)
        self._waiting(session)
        refresh(session, self.season, self._end)
        lease.renew(session, self._holding, datetime.now(UTC))

    def _people(self, session: Session) -> None:
        secret = hashed(PASSWORD)
        teams = {entry.team: entry.title or self.words.title for entry in ENTRIES}
        for name, role in {"boss": ORGANIZER, "passer-by": COMPETITOR, **dict.fromkeys(teams, "")}.items():
            account = add_account(session, name, secret, role or COMPETITOR, self.now)
            if name in teams:
                make_team(session, account, name, teams[name], self.now)
            if (person := PEOPLE.get(name)) is not None:
                token = new_token(session, account, self.words.label, self.now)
                cookie, csrf = open_web_session(session, account, datetime.now(UTC))
                self.filled.people[person] = Person(name, token, cookie, csrf)

    def _entered(self, session: Session, team: str, name: str, version: str, tracks: str = "") -> int:
        folder = self._agents / f"{team}-{name}-{version}"
        folder.mkdir(parents=True)
        tracks = tracks or '["navigation", "battle"]'
        (folder / "submission.toml").write_text(MANIFEST.format(name=name, version=version, tracks=tracks))
        (folder / "agent.py").write_text(f"{AGENT}# {version}\n")
        account = find_account(session, team)
        assert account is not None
        archive = checked(self.season, folder)
        found, message = find_team(session, team), self.words.message
        entered = hand_in(session, self.season, found, account, archive, message, self.now)
        self._wait(1)
        steps.admit(session, self.now)
        return entered.id

    def _begun(self, session: Session) -> Attempt:
        self._wait(1)
        attempt = steps.take_submission(session, self.season, self._holding, self.now)
        assert attempt is not None
        return attempt

    def _validating(self, session: Session) -> Attempt:
        attempt = self._begun(session)
        self._wait(1)
        following = steps.built(session, self.season, self._holding, attempt.id, self.now)
        assert following is not None
        return following

    def _take_part(self, session: Session) -> None:
        attempt = self._validating(session)
        self._wait(1)
        assert steps.validated(session, self.season, self._holding, attempt.id, self.now)

    def _play(self, session: Session, count: int) -> int:
        """Play the next matches; return how many there were."""
        plan_ladders(session, self.season, self.now)
        taken = steps.take_matches(session, self.season, self._holding, self.now, count)
        seats = seats_of(session, [match.id for _, match in taken])
        for attempt, match in taken:
            self._wait(0.5)
            self._end_match(session, attempt, match, seats[match.id])
        refresh(session, self.season, self.now)
        return len(taken)

    def _end_match(self, session: Session, attempt: Attempt, match: Match, seats: list[MatchSeat]) -> None:
        rows = tuple(self._row(match, seat) for seat in seats)
        if match.kind != LADDER:
            rows = tuple(row.model_copy(update={"submission": None}) for row in rows)
        entrant = None if match.kind == LADDER else seats[0].entrant
        timing = made_timing(match, *(self._timing(seat.seat) for seat in seats), entrant=entrant)
        timing = timing.model_copy(update={"started": self.now.timestamp(), "wall": 12.0, "steps": 150})
        row = MatchRow.of(match.number, rows, self._stored(match))
        record = PlayedRecord("ab" * 16, 1000)
        steps.played(session, self._holding, attempt.id, row, timing, record, self.now)
        self.filled.matches[match.kind] = match.id
        if match.kind != LADDER and seats[0].entrant.startswith("night-owl"):
            self.filled.matches["own_suite"] = match.id

    def _stored(self, match: Match) -> str:
        """Store the log of a match; return the path of its record, of which there is none."""
        folder = self.season.match_folder(match.id)
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "seat.log").write_text(self.words.output)
        return "match.wsr"

    def _row(self, match: Match, seat: MatchSeat) -> SeatRow:
        skill = self._skills[seat.submission_id]
        luck = float(self._random.normal(skill, 0.15))
        used = round(float(np.clip(60.0 * (1.2 - luck), 5.0, 60.0)), 2)
        values = {
            "time": used if used < 60.0 else 120.0,
            "used_time": used,
            "punish_time": 0.0 if used < 60.0 else 60.0,
            "success": float(used < 60.0),
            "supplies": max(0.0, round(20.0 * luck)),
            "kills": max(0.0, round(4.0 * luck)),
            "deaths": max(0.0, round(3.0 * (1.0 - luck))),
        }
        names = {metric.name for metric in metric_infos(match.track)}
        broken = self._random.random() < 0.02
        return SeatRow(
            seat=seat.seat,
            submission=seat.entrant,
            status="crashed" if broken else "finished",
            fault="agent" if broken else None,
            detail=self.words.failure if broken else "",
            actions=150,
            metrics={name: value for name, value in values.items() if name in names},
            log="seat.log",
        )

    def _timing(self, seat: int) -> SeatTiming:
        median = float(self._random.uniform(0.002, 0.004))
        latencies = {"latency_p50": median, "latency_p99": 3.0 * median, "latency_max": 9.0 * median}
        return timing_of_a_seat(seat=seat, steps=150, late_steps=0, time_bank=29.0, **latencies)

    def _failures(self, session: Session) -> None:
        """Let a submission fail by its own fault, and another by the platform's."""
        failed = self._entered(session, "owls", "night-owl", "2.0-rc1")
        attempt = self._validating(session)
        steps.rejected(
            session,
            self._holding,
            attempt.id,
            self.now,
            reason=f"finishes a match: {self.words.failure}",
            last_lines=self.words.output.splitlines(),
            command="wildscav check DIR --sandbox process",
        )
        broken = self._entered(session, "hares", "zigzag", "2.2")
        while session.get_one(Submission, broken).state != "failed":
            attempt = self._begun(session)
            why = "no space left on the device"
            steps.broke(session, self.season, self._holding, attempt.id, self.now, why)
        self.filled.submissions |= {"failed": failed, "broken": broken}

    def _acts(self, session: Session) -> None:
        """Do privileged acts, and what competitors do besides submitting."""
        words, now = self.words, self._end - timedelta(minutes=50)
        doing = Doing(session, self.season, "boss", now)
        acts.announce(doing, words.announcement, words.text)
        acts.invite(doing, label=words.label)
        acts.disqualify_team(doing, "newts", reason=words.reason)
        acts.pause(doing, reason=words.label)
        add_webhook(session, find_team(session, "owls"), words.address, now)
        value = {"sandbox": SANDBOX, "executor": "local", "at_once": 2, "nodes": [NODE], "holder": "arena-1"}
        season_state.write_state(session, season_state.NODES, value, now)
        acts.resume(doing)

    def _waiting(self, session: Session) -> None:
        """Leave some work undone: a match that is played, and submissions that are built and that wait."""
        self.now = self._end - timedelta(minutes=30)
        self._skills[self._entered(session, "foxes", "pathfinder", "1.0")] = 0.9
        self._take_part(session)
        self._play(session, 5)
        ((_, playing),) = steps.take_matches(session, self.season, self._holding, self.now, 1)
        self.filled.matches["playing"] = playing.id
        self.now = self._end - timedelta(minutes=3)
        withdrawn = self._entered(session, "foxes", "pathfinder", "0.9.1")
        move(session, session.get_one(Submission, withdrawn), "cancelled", self.now)
        building = self._entered(session, "hares", "zigzag", "2.3")
        self._begun(session)
        waiting = self._entered(session, "owls", "night-owl", "2.0", '["battle"]')
        self.filled.submissions |= {"cancelled": withdrawn, "building": building, "queued": waiting}


def filled_season(shared: Path, folder: Path, *, words: Words = Words(), web: str = "") -> FilledSeason:  # noqa: B008
    """Copy a filled season into a folder, which is made.

    Args:
        shared: A folder of all processes of the tests. The first one that asks fills the season there.
        folder: Where to copy it to.
        words: What people and agents write.
        web: More settings of the web site.
    """
    original = shared / ("hostile" if words == HOSTILE else "plain")
    shutil.copytree(made_once(original, partial(_fill, words)), folder)
    settings = folder / "season" / "season.toml"
    settings.write_text(settings.read_text().replace("[web]", f"[web]\n{web}"))
    season = Season.open(folder / "season")
    people, submissions, matches = pickle.loads((folder / "contents").read_bytes())  # noqa: S301 (our own)
    return FilledSeason(season, season.database(), words, people, submissions, matches)


def _fill(words: Words, folder: Path) -> None:
    """Make a season in a folder, and fill it."""
    # What took part was handed in on other days, so that the quotas of today are left at any hour.
    opens = datetime.now(UTC) - timedelta(days=2)
    make_season(folder / "season", MORE, current=True, opens=opens)
    (folder / "season" / "tiny.toml").write_text(SUITE)
    season = Season.open(folder / "season")
    database = season.database()
    database.upgrade()
    filled = FilledSeason(season, database, words)
    with database.writing() as session:
        _Filling(filled, folder / "agents").fill(session)
    database.close()
    contents = (filled.people, filled.submissions, filled.matches)
    (folder / "contents").write_bytes(pickle.dumps(contents))
