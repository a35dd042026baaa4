"""A season whose conductor's steps are taken by hand."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import datetime, timedelta
from hashlib import blake2b
from pathlib import Path
from typing import TypeVar

from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.results_made import made_result
from tests.leaderboard.seasons_made import NOON, opened, team_with_member

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.accounts.service import Caller, known_account
from wildscav_leaderboard.boards.documents import BoardDocument
from wildscav_leaderboard.boards.kept import read_board
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.conductor import lease, steps
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.lease import Holding
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.matches.service import find_match, seats_of
from wildscav_leaderboard.organizing.team_acts import do_team_act
from wildscav_leaderboard.seasons.acts import Act, Doing
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.archives import CheckedArchive
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import hand_in
from wildscav_leaderboard.teams.models import Member
from wildscav_leaderboard.teams.service import find_team
from wildscav_leaderboard.visibility import PUBLIC
from wildscav_server.hosting.manifest import Manifest

Value = TypeVar("Value")


def made_archive(number: int, tracks: tuple[str, ...] = ("navigation",)) -> CheckedArchive:
    """Return an archive that nobody unpacks, with other content for each number."""
    digest = blake2b(str(number).encode(), digest_size=16).hexdigest()
    manifest = Manifest(name="runner", version="1", entry_point="agent:Agent", tracks=tracks)
    return CheckedArchive(Path("none"), ".zip", manifest, list(tracks), digest, digest, digest * 2, 1000)


@dataclass
class Conducted:
    """A season, its conductor's lease, and the time."""

    season: Season
    database: Database
    holding: Holding = Holding("nobody", 0)  # noqa: RUF009 (it cannot be changed)
    now: datetime = NOON
    handed_in: int = 0

    def take_over(self) -> Holding:
        """Let another process be the conductor."""
        self.now += lease.LASTS
        found = self.write(lambda session: lease.acquire(session, lease.new_holder(), self.now))
        assert found is not None
        self.holding = found
        self.write(lambda session: begin_editions(session, self.season, self.now))
        return found

    def wait(self, seconds: float) -> None:
        """Let time pass."""
        self.now += timedelta(seconds=seconds)

    def write(self, act: Callable[[Session], Value]) -> Value:
        """Do something in a transaction."""
        with self.database.writing() as session:
            return act(session)

    def submission(self, number: int) -> Submission:
        """Return a submission as it is now."""
        with self.database.reading() as session:
            return session.get_one(Submission, number)

    def match(self, number: int) -> Match:
        """Return a match as it is now."""
        with self.database.reading() as session:
            return session.get_one(Match, number)

    def hand_in(
        self, team: str = "foxes", tracks: tuple[str, ...] = ("navigation",), replaces: int | None = None
    ) -> int:
        """Hand in something new, and return its number."""
        self.handed_in += 1

        def act(session: Session) -> int:
            found, archive = find_team(session, team), made_archive(self.handed_in, tracks)
            account = session.scalars(select(Account).join(Member).where(Member.team_id == found.id)).one()
            return hand_in(session, self.season, found, account, archive, "", self.now, replaces).id

        number = self.write(act)
        self.write(lambda session: steps.admit(session, self.now))
        return number

    def _step(self, act: Callable[..., Value], *attempt: int, more: tuple[object, ...] = ()) -> Value:
        """Take a step of the conductor."""
        return self.write(lambda session: act(session, self.season, self.holding, *attempt, self.now, *more))

    def take(self) -> Attempt | None:
        """Take the submission whose turn it is."""
        return self._step(steps.take_submission)

    def taken(self) -> Attempt:
        """Take a submission that waits."""
        attempt = self.take()
        assert attempt is not None
        return attempt

    def built(self, attempt: int) -> Attempt | None:
        """Bring the news that a submission is built."""
        return self._step(steps.built, attempt)

    def validated(self, attempt: int) -> bool:
        """Bring the news that a submission is valid."""
        return self._step(steps.validated, attempt)

    def broke(self, attempt: int, why: str = "the disk is full") -> bool:
        """Bring the news that the platform broke an attempt."""
        return self._step(steps.broke, attempt, more=(why,))

    def expire(self) -> int:
        """Try again what never ended."""
        return self._step(steps.expire)

    def passed(self, attempt: Attempt) -> None:
        """Let a submission that was taken pass its validation."""
        following = self.built(attempt.id)
        assert following is not None
        assert self.validated(following.id)

    def active(
        self, team: str = "foxes", tracks: tuple[str, ...] = ("navigation",), replaces: int | None = None
    ) -> int:
        """Return the number of a new submission that takes part."""
        number = self.hand_in(team, tracks, replaces)
        self.passed(self.taken())
        return number

    def take_matches(self, count: int, *, begun: bool = True) -> list[tuple[Attempt, Match]]:
        """Take the next matches, and begin them."""
        taken = self._step(steps.take_matches, more=(count,))
        for attempt, _ in taken if begun else ():
            self.begin(attempt)
        return taken

    def begin(self, attempt: Attempt) -> bool:
        """Begin a match that was taken."""
        return self.write(lambda session: steps.begun(session, self.holding, attempt.id, self.now))

    def played(self, attempt: Attempt, score: float = 1.0) -> bool:
        """Bring the result of a match."""

        def act(session: Session) -> bool:
            match = find_match(session, attempt.match_id or 0)
            seats = seats_of(session, [match.id])[match.id]
            result = made_result(match, seats, [score + place for place in range(len(seats))])
            return steps.played(session, self.holding, attempt.id, *result, self.now)

        return self.write(act)

    def act(self, act: Act, *what: object, **more: object) -> None:
        """Let an organizer act."""
        self.write(lambda session: act(Doing(session, self.season, "chief", self.now), *what, **more))

    def decide(self, act: str, number: int, team: str = "foxes") -> None:
        """Let a member of a team do an act on a submission."""

        def decide(session: Session) -> None:
            caller = Caller(known_account(session, f"{team}-captain"))
            do_team_act(session, self.season, caller, act, number, self.now)

        self.write(decide)

    def plan(self) -> int:
        """Plan the next matches of ladders; return how many are new."""
        return self.write(lambda session: plan_ladders(session, self.season, self.now))

    def refresh(self, *scores: SuiteScores) -> list[str]:
        """Bring the boards up to date; return the tracks whose boards changed."""
        return self.write(lambda session: refresh(session, self.season, self.now, *scores))

    def board(self, track: str, audience: str = PUBLIC) -> BoardDocument | None:
        """Return a board; None if there is none yet."""
        with self.database.reading() as session:
            return read_board(session, track, audience)


@contextmanager
def conducting(season: Season) -> Iterator[Conducted]:
    """Give a season with the teams foxes and owls, of which this process is the conductor."""
    with opened(season) as database:
        conducted = Conducted(season, database)
        with database.writing() as session:
            for team in ("foxes", "owls"):
                team_with_member(session, team)
        conducted.take_over()
        yield conducted
