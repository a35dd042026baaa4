"""A season in which everything happens that can: nothing is lost, nothing twice, nothing stuck.

Several conductors, each with a clock of its own, take the real steps on a real database. Any transaction may
be cut off at any statement, its process may die before or after it, and results come late, twice or never.
"""

from contextlib import suppress
from datetime import datetime, timedelta
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st
from hypothesis.stateful import initialize, invariant, precondition, rule, run_state_machine_as_test
from sqlalchemy import select
from sqlalchemy.orm import Session
from tests.leaderboard.conductor.conducted import made_archive
from tests.leaderboard.conductor.season_promises import check_always, check_faults, check_quiet
from tests.leaderboard.conductor.storm import CONDUCTORS, NEVER, TEAMS, CutOffError, Process, Storm
from tests.leaderboard.results_made import made_result

from wildscav_leaderboard.accounts.models import Account
from wildscav_leaderboard.boards.models import LadderStep
from wildscav_leaderboard.boards.service import refresh
from wildscav_leaderboard.conductor import lease, steps
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.lease import Holding
from wildscav_leaderboard.conductor.models import BUILD, Attempt
from wildscav_leaderboard.conductor.plans import plan_ladders
from wildscav_leaderboard.matches.models import MatchResult
from wildscav_leaderboard.matches.service import find_match, seats_of
from wildscav_leaderboard.organizing import acts
from wildscav_leaderboard.seasons.acts import Doing
from wildscav_leaderboard.seasons.refusals import RefusalError
from wildscav_leaderboard.seasons.state import PAUSED, read_state
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.submissions.service import hand_in, move
from wildscav_leaderboard.teams.service import find_team

ACTS = ("disqualify", "run again", "run again", "pause or resume", "ban")
ROUNDS = 400  # until a season is quiet, at most; a storm leaves far less work
conductors = st.sampled_from(CONDUCTORS)
whoever_conducts = st.one_of(st.none(), st.none(), conductors)
# Most transactions are stored; some end at one of their statements, and some conductors end just afterwards.
fates = st.one_of(st.just(NEVER), st.just(NEVER), st.integers(0, 12))
chances = st.integers(0, 1 << 16)


class StormySeason(Storm):
    """Whatever happens, nothing is lost, nothing happens twice, and nothing is stuck."""

    # Competitors and organizers.

    @rule(team=st.sampled_from(TEAMS), tracks=st.sampled_from(("navigation", "battle", "both")))
    def a_team_hands_something_in(self, team: str, tracks: str) -> None:
        self.number += 1
        both = ("navigation", "battle") if tracks == "both" else (tracks,)
        archive = made_archive(self.number, both)
        with suppress(RefusalError), self.transaction() as session:
            found = find_team(session, team)
            account = session.scalars(select(Account)).first()
            assert account is not None
            hand_in(session, self.season, found, account, archive, "", self.time)

    def _submission(self, session: Session, chance: int) -> Submission | None:
        found = session.scalars(select(Submission).order_by(Submission.id)).all()
        return found[chance % len(found)] if found else None

    @precondition(lambda self: self.number)
    @rule(chance=chances)
    def a_team_cancels(self, chance: int) -> None:
        with suppress(RefusalError), self.transaction() as session:
            if (submission := self._submission(session, chance)) is not None:
                move(session, submission, "cancelled", self.time)

    @precondition(lambda self: self.number)
    @rule(chance=chances, act=st.sampled_from(ACTS))
    def the_organizers_act(self, chance: int, act: str) -> None:
        with suppress(RefusalError), self.transaction() as session:
            submission, doing = self._submission(session, chance), self._doing(session)
            if act == "pause or resume":
                self._pause_or_resume(doing)
            elif act == "ban" and chance % 4 == 0:  # rarely, since nothing happens to a team afterwards
                acts.disqualify_team(doing, TEAMS[chance % 3 % 2], reason="it cheats")
            elif act == "disqualify" and submission is not None:
                acts.disqualify_submission(doing, submission.id, reason="it cheats")
            elif act == "run again" and submission is not None:
                was_failed = submission.state == "failed"
                acts.rerun(doing, submission.id)
                if was_failed:
                    last = session.scalars(select(Attempt.id).order_by(Attempt.id.desc())).first()
                    self.forgiven[submission.id] = last or 0

    def _doing(self, session: Session) -> Doing:
        return Doing(session, self.season, "chief", self.time)

    def _pause_or_resume(self, doing: Doing) -> None:
        if read_state(doing.session, PAUSED) is None:
            acts.pause(doing, reason="maintenance")
        else:
            acts.resume(doing)

    # Time.

    @rule(seconds=st.sampled_from((1, 31, 101, 4000)), name=st.none() | conductors, back=st.booleans())
    def time_passes(self, seconds: int, name: str | None = None, back: bool = False) -> None:
        """Let time pass, or set the clock of one conductor alone."""
        if name is None:
            self.time += timedelta(seconds=seconds)
        else:
            self.processes[name].ahead = timedelta(seconds=-25 * seconds if back else seconds)

    # Conductors.

    @rule(name=conductors, fate=fates)
    def a_conductor_wants_the_lease(self, name: str, fate: int) -> None:
        process = self.processes[name]
        try:
            with self.transaction(fate) as session:
                holding = lease.acquire(session, f"{name}/{self.started}", self.time + process.ahead)
                if holding is not None:
                    begin_editions(session, self.season, self.time)
        except CutOffError:
            return
        if holding is not None:
            assert holding.epoch == self.epoch + 1
            self.die(process)
            process.holding, self.epoch = holding, holding.epoch
            self.started += 1

    @rule(name=conductors, fate=fates, how=st.sampled_from(("renews", "ends", "is killed")))
    def a_conductor_goes_on_or_ends(self, name: str, fate: int, how: str) -> None:
        process = self.processes[name]
        if how == "renews":
            self.step(process, fate, lambda session, now: lease.renew(session, process.holding, now))
            return
        if how == "ends":
            self.step(process, fate, lambda session, now: lease.release(session, process.holding, now))
        self.die(process)

    @rule(name=whoever_conducts, fate=fates)
    def a_conductor_looks_round(self, name: str | None, fate: int) -> None:
        process = self.process(name)

        def act(session: Session, now: datetime) -> None:
            steps.expire(session, self.season, process.holding, now)
            steps.admit(session, now)

        self.step(process, fate, act)

    @rule(name=whoever_conducts, fate=fates)
    def a_conductor_takes_a_submission(self, name: str | None, fate: int) -> None:
        process = self.process(name)
        attempt = self.step(
            process,
            fate,
            lambda session, now: steps.take_submission(session, self.season, process.holding, now),
        )
        process.work += [] if attempt is None else [attempt.id]

    @rule(name=whoever_conducts, fate=fates, count=st.integers(1, 5))
    def a_conductor_takes_matches(self, name: str | None, fate: int, count: int) -> None:
        process = self.process(name)

        def act(session: Session, now: datetime) -> list[Any]:
            plan_ladders(session, self.season, now)
            return steps.take_matches(session, self.season, process.holding, now, count)

        taken = self.step(process, fate, act)
        process.work += [attempt.id for attempt, _ in taken or ()]

    @precondition(lambda self: any(one.work for one in self.processes.values()))
    @rule(
        name=whoever_conducts,
        chance=chances,
        how=st.sampled_from(("well", "well", "well", "badly", "broken")),
        fate=fates,
        kept=st.booleans(),
    )
    def work_ends(self, name: str | None, chance: int, how: str, fate: int, kept: bool) -> None:
        process = self.process(name)
        if not process.work:
            return
        attempt = process.work[chance % len(process.work)]
        if not kept:
            process.work.remove(attempt)
        process.past.append(attempt)
        self.bring_news(process, attempt, how, fate, chance)

    @precondition(lambda self: any(one.work for one in self.processes.values()))
    @rule(name=whoever_conducts, chance=chances, fate=fates)
    def a_match_begins(self, name: str | None, chance: int, fate: int) -> None:
        process = self.process(name)
        if not process.work:
            return
        number = process.work[chance % len(process.work)]
        with self.database.reading() as session:
            is_match = session.get_one(Attempt, number).match_id is not None
        if is_match:
            self.step(process, fate, lambda session, now: steps.begun(session, process.holding, number, now))

    @precondition(lambda self: any(one.past for one in self.processes.values()))
    @rule(name=whoever_conducts, chance=chances, how=st.sampled_from(("well", "badly", "broken")), fate=fates)
    def old_news_comes_again(self, name: str | None, chance: int, how: str, fate: int) -> None:
        past = [number for one in self.processes.values() for number in one.past]
        self.bring_news(self.process(name), past[-1 - chance % min(len(past), 4)], how, fate, chance)

    def bring_news(self, process: Process, number: int, how: str, fate: int, chance: int) -> None:
        """Let a conductor store how an attempt ended."""
        with self.database.reading() as session:
            attempt = session.get_one(Attempt, number)
        season, holding = self.season, process.holding

        def act(session: Session, now: datetime) -> Any:
            if how == "broken":
                return steps.broke(session, season, holding, number, now, "the disk is full")
            if attempt.match_id is not None:
                return self._play(session, holding, attempt, now, chance)
            if how == "badly":
                return steps.rejected(session, holding, number, now, reason="it crashed")
            if attempt.kind == BUILD:
                return steps.built(session, season, holding, number, now)
            return steps.validated(session, season, holding, number, now)

        following = self.step(process, fate, act)
        if isinstance(following, Attempt):
            process.work.append(following.id)

    @staticmethod
    def _play(session: Session, holding: Holding, attempt: Attempt, now: datetime, chance: int) -> bool:
        match = find_match(session, attempt.match_id or 0)
        seats = seats_of(session, [match.id])[match.id]
        scores = [float((chance >> 4 * place) % 7) for place in range(len(seats))]
        return steps.played(session, holding, attempt.id, *made_result(match, seats, scores), now)

    @rule(name=whoever_conducts, fate=fates)
    def a_conductor_refreshes_the_boards(self, name: str | None, fate: int) -> None:
        process = self.process(name)

        def act(session: Session, now: datetime) -> None:
            lease.check(session, process.holding)
            refresh(session, self.season, now)

        self.step(process, fate, act)

    # What is promised.

    @initialize()
    def begin(self) -> None:
        """Begin with a conductor and submissions, since little happens without them."""
        self.a_conductor_wants_the_lease(CONDUCTORS[0], NEVER)
        for team in TEAMS:
            self.a_team_hands_something_in(team, "both")
        self.a_conductor_looks_round(None, NEVER)

    @invariant()
    def promises_hold(self) -> None:
        with self.database.reading() as session:
            check_always(session, self.season)
            check_faults(session, self.forgiven)
            self._check_history(session)

    def _check_history(self, session: Session) -> None:
        """What was stored once stays as it was: the first result of a match, and the history of a ladder."""
        stored = session.execute(select(MatchResult.match_id, MatchResult.record))
        results = {match: record for match, record in stored}  # noqa: C416 (rows are no pairs to mypy)
        assert self.results.items() <= results.items()
        self.results = results
        order = (LadderStep.match_id, LadderStep.entrant)
        steps = session.execute(select(*order, LadderStep.place).order_by(*order))
        ladder = [(match, entrant, place) for match, entrant, place in steps]
        assert ladder[: len(self.ladder)] == self.ladder
        self.ladder = ladder

    def teardown(self) -> None:
        """Let a last conductor finish what is left."""
        try:
            self._become_quiet()
            with self.database.reading() as session:
                check_always(session, self.season)
                self._check_history(session)
                check_quiet(session, self.season)
        finally:
            self.database.close()
            self._folder.cleanup()

    def _become_quiet(self) -> None:
        for process in self.processes.values():
            self.die(process)
        with self.database.reading() as session:
            paused = read_state(session, PAUSED) is not None
        if paused:
            self.the_organizers_act(0, "pause or resume")
        name, process = CONDUCTORS[0], self.processes[CONDUCTORS[0]]
        process.ahead = timedelta()
        for _ in range(ROUNDS):
            if not process.holding.epoch:
                self.time_passes(31)
                self.a_conductor_wants_the_lease(name, NEVER)
                continue
            self.a_conductor_looks_round(name, NEVER)
            self.a_conductor_takes_a_submission(name, NEVER)
            self.a_conductor_takes_matches(name, NEVER, 5)
            if not process.work:
                break
            while process.work:
                self.bring_news(process, process.work.pop(), "well", NEVER, 1)
        else:
            raise AssertionError(f"something is still under way after {ROUNDS} rounds")
        self.a_conductor_refreshes_the_boards(name, NEVER)


pytestmark = pytest.mark.slow
STORMS = settings(
    max_examples=10, stateful_step_count=60, deadline=None, suppress_health_check=list(HealthCheck)
)


def test_a_season_survives_many_storms() -> None:
    run_state_machine_as_test(StormySeason, settings=STORMS)
