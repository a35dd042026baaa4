"""The conductor's loop: hold the lease, decide, have the work done, and go on."""

import os
import socket
import threading
import time
import traceback
from contextlib import ExitStack, suppress

from sqlalchemy.orm import Session

from wildscav.errors import WildscavError, describe
from wildscav_evaluator.executors import EXECUTORS, Executor, Node
from wildscav_evaluator.matches.jobs import Heartbeat, Job, JobEvent, JobResult
from wildscav_leaderboard.boards.service import apply_results, compute, store
from wildscav_leaderboard.boards.suite_scores import SuiteScores
from wildscav_leaderboard.conductor import lease, steps, work
from wildscav_leaderboard.conductor.attempts import matches_begun
from wildscav_leaderboard.conductor.editions import begin_editions
from wildscav_leaderboard.conductor.lease import Holding, LeaseKeeper, LeaseLostError
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.conductor.plans import plan_ladders, rate_ladders
from wildscav_leaderboard.conductor.validators import IDLE, Validators, now
from wildscav_leaderboard.database.connection import Database, DatabaseError, clock
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.matches.service import seats_of
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.disk import check_room
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force, model_of
from wildscav_leaderboard.spectating.live import LiveMatches
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.webhooks.delivery import Deliverer
from wildscav_server.monitoring.logs import Log, open_log

BATCH = 4  # matches for each that runs at once; then those come first that have become urgent
REFRESH_EVERY = 2.0  # s between two refreshes of the boards while matches are played, at least
BOARDS_PAUSE = 2.0  # times as long as boards took, the pause after them while matches are played
LONGEST_PAUSE = 30.0  # s after errors in a row


class Conductor:
    """Runs a season until it is stopped.

    Args:
        database: Its database, whose schema is current.
    """

    def __init__(self, season: Season, database: Database, log: Log | None = None) -> None:
        self.season, self.database = season, database
        self._log = log or open_log(None)
        self._holding = Holding("", 0)
        self._sandbox = ""
        self._due, self._scores = 0.0, SuiteScores()  # when the boards are, of the monotonic clock
        self._stopping = threading.Event()

    def stop(self) -> None:
        """Ask the loop to end after what it is doing."""
        self._stopping.set()

    def run(self) -> None:
        """Wait for the lease, and conduct until ``stop`` is called or the process is interrupted."""
        pause = IDLE
        while not self._stopping.is_set():
            try:
                if not self._acquire():
                    self._stopping.wait(IDLE)
                    continue
                self._conduct()
                pause = IDLE
            except LeaseLostError as error:
                self._log.warning("lease_lost", reason=str(error))
            except DatabaseError as error:
                self._log.warning("database_lost", reason=str(error))
                self._stopping.wait(pause)
                pause = min(2 * pause, LONGEST_PAUSE)
            except Exception as error:  # noqa: BLE001 (whatever it is, the season goes on)
                known = isinstance(error, WildscavError)
                trace = {} if known else {"trace": "".join(traceback.format_exception(error))}
                reason = str(error) or type(error).__name__
                self._log.warning("conductor_failed", reason=reason, **trace)
                self._note_failure(reason)
                self._stopping.wait(pause)
                pause = min(2 * pause, LONGEST_PAUSE)

    def _acquire(self) -> bool:
        with self.database.writing() as session:
            holding = lease.acquire(session, lease.new_holder(), clock(session))
        if holding is None:
            return False
        self._holding = holding
        self._log.info("lease_acquired", holder=holding.holder, epoch=holding.epoch)
        return True

    def _conduct(self) -> None:
        """Conduct while this process holds the lease."""
        settings = self.season.settings.execution
        with ExitStack() as stack:
            stack.enter_context(LeaseKeeper(self.database, self._holding, log=self._log))
            stack.push(self._release)  # another conductor may be able to play
            stack.enter_context(Deliverer(self.database, self.season.settings.webhooks, self._log))
            kind = EXECUTORS[settings.executor]
            executor = stack.enter_context(kind(settings.matches, settings.address))
            self._sandbox = work.chosen_sandbox(self.season, executor, self._log)
            if self.season.settings.model is not None and not executor.nodes:
                self.season.settings.model.key()  # each match looks it up, but then it is late to miss it
            with self.database.writing() as session:
                lease.check(session, self._holding)
                self._publish_nodes(session, executor)
                for change in begin_editions(session, self.season, now()):
                    self._log.warning("edition_waits", track=change.track, reason=change.text)
            self._live = LiveMatches(self.season.live)
            with suppress(OSError):
                self._live.clear()  # of a conductor that was killed
            validators = stack.enter_context(
                Validators(self.season, self.database, self._holding, self._sandbox, self._log)
            )
            failed = True  # perhaps a conductor before this one
            while not self._stopping.is_set():
                validators.check()
                is_busy = self.round(executor)
                if failed:
                    self._note_failure(None)
                    failed = False
                if not is_busy:
                    self._stopping.wait(IDLE)

    def _note_failure(self, reason: str | None) -> None:
        """Note for the metrics that nothing can be played, or that it can again."""
        with suppress(DatabaseError), self.database.writing() as session:
            season_state.write_state(
                session, season_state.FAILED, {"reason": reason} if reason else None, now()
            )

    def _release(self, error: type[BaseException] | None = None, *_: object) -> None:
        with suppress(LeaseLostError, DatabaseError), self.database.writing() as session:
            if error is None or error is KeyboardInterrupt:  # it was told to end
                steps.hand_back(session, self.season, self._holding, now())
            lease.release(session, self._holding, clock(session))

    def round(self, executor: Executor) -> bool:
        """Do everything once that there is to do; return whether there was anything."""
        check_room(self.season)
        with self.database.writing() as session:
            self.season = in_force(session, self.season)
            lost = steps.expire(session, self.season, self._holding, now())
        if lost:
            self._log.warning("attempts_lost", count=lost)
        busy = self._play_batch(executor)
        self._refresh(executor, at_once=True)
        return busy

    def _publish_nodes(self, session: Session, executor: Executor) -> None:
        """Store for the pages where matches are played."""
        here = Node(socket.gethostname(), os.cpu_count() or 1, matches_begun(session))
        nodes = [
            {"name": one.name, "cores": one.cores, "running": one.running, "problem": one.problem}
            for one in executor.nodes or (here,)
        ]
        model = model_of(self.season)
        value = {
            "holder": self._holding.holder,
            "sandbox": self._sandbox,
            "model": None if model is None else model.model_dump(mode="json"),
            "executor": executor.name,
            "at_once": executor.at_once,
            "validations": self.season.settings.execution.validations,
            "nodes": nodes,
        }
        if season_state.read_state(session, season_state.NODES) != value:
            season_state.write_state(session, season_state.NODES, value, now())

    def _broke(self, attempt: int, why: str) -> bool:
        """Note a fault of the platform; return False."""
        self._log.warning("attempt_broke", attempt=attempt, fault="platform", reason=why)
        with self.database.writing() as session:
            steps.broke(session, self.season, self._holding, attempt, now(), why)
        return False

    def _play_batch(self, executor: Executor) -> bool:
        """Play the next matches; return whether there were any."""
        with self.database.reading() as session:
            rate_ladders(session, self.season)
        with self.database.writing() as session:
            plan_ladders(session, self.season, now())
            count = BATCH * executor.at_once
            taken = steps.take_matches(session, self.season, self._holding, now(), count)
        jobs = self._jobs(taken)
        if not jobs:
            return bool(taken)
        attempts = {job.key: attempt for attempt, job in jobs}

        def begin(job: Job) -> bool:
            with self.database.writing() as session:
                return steps.begun(session, self._holding, attempts[job.key].id, now())

        def note(job: Job, event: JobEvent) -> None:
            if isinstance(event, Heartbeat) and event.snapshots:
                with suppress(OSError):  # that nobody can watch, on a full disk, say, stops no match
                    self._live.add(job.key, job.spec, job.seating.names, event.snapshots)
            self._refresh(executor)  # however long matches last

        with executor.players([job for _, job in jobs]) as players:
            for result in players.run([job for _, job in jobs], begin, note):
                self._deliver(attempts[result.job.key], result)
                with suppress(OSError):
                    self._live.end(result.job.key)  # its record tells everything
                self._refresh(executor)
                if self._stopping.is_set():
                    break
        return True

    def _jobs(self, taken: list[tuple[Attempt, Match]]) -> list[tuple[Attempt, Job]]:
        """Return the jobs of matches; one that cannot be prepared is the platform's fault."""
        with self.database.reading() as session:
            seats = seats_of(session, [match.id for _, match in taken])
            numbers = {one.submission_id for found in seats.values() for one in found}
            archives = {
                number: session.get_one(Submission, number).archive
                for number in numbers
                if number is not None
            }
        jobs = []
        for attempt, match in taken:
            try:
                jobs.append(
                    (attempt, work.job_of(self.season, match, seats[match.id], archives, self._sandbox))
                )
            except (WildscavError, OSError, ValueError) as error:
                self._broke(attempt.id, describe(error))
        return jobs

    def _deliver(self, attempt: Attempt, result: JobResult) -> None:
        """Store the result of a match."""
        if result.row.metrics is None or result.timing is None:
            self._broke(attempt.id, result.row.detail)
            return
        try:
            row, record = work.keep_record(result)
        except (WildscavError, OSError) as error:
            self._broke(attempt.id, describe(error))
            return
        with self.database.writing() as session:
            steps.played(session, self._holding, attempt.id, row, result.timing, record, now())
        (result.job.out / str(result.row.record)).unlink(missing_ok=True)  # it is kept under its other name
        self._log.info("match_played", match=attempt.match_id, status=result.row.status)

    def _refresh(self, executor: Executor, *, at_once: bool = False) -> None:
        """Bring boards and machines that are shown up to date, unless that was done a moment ago.

        Boards are computed while others may write, so that nobody waits for that. Those that others have made
        out of date meanwhile follow soon.
        """
        started = time.monotonic()
        if not at_once and started < self._due:
            return
        while self._apply_results():
            pass
        with self.database.reading() as session:
            computed = compute(session, self.season, now(), self._scores)
        with self.database.writing() as session:
            lease.check(session, self._holding)
            stored = store(session, self.season, computed)
            self._publish_nodes(session, executor)
        ended = time.monotonic()
        took, all_stored = ended - started, len(stored) == len(computed)
        self._due = ended + (
            max(REFRESH_EVERY, took * BOARDS_PAUSE) if all_stored else min(REFRESH_EVERY, took)
        )

    def _apply_results(self) -> int:
        """Apply the next results of ladders, after a freeze that is due; return how many there were."""
        with self.database.writing() as session:
            lease.check(session, self._holding)
            if steps.freeze_when_due(session, self.season, now()):
                self._log.info("boards_frozen")
            return apply_results(session, self.season)
