"""Builds and validates submissions beside the matches, several at once, each in a process of its own."""

import threading
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from datetime import UTC, datetime
from typing import Any, Self, TypeVar

from wildscav.errors import WildscavError, describe
from wildscav.system.worker_pool import WorkerPool
from wildscav_leaderboard.conductor import steps, work
from wildscav_leaderboard.conductor.lease import Holding, LeaseLostError
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.database.connection import Database
from wildscav_leaderboard.seasons.disk import check_room
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.in_force import in_force
from wildscav_leaderboard.submissions.models import Submission
from wildscav_server.monitoring.logs import Log

Value = TypeVar("Value")


class ChildError(WildscavError):
    """The child process died, or was ended because it took too long."""


class Child:
    """One child process, started when it is needed, and again when it is gone, until ``close``.

    One thread calls functions in it; any other may close it meanwhile.
    """

    def __init__(self) -> None:
        self._pool: WorkerPool | None = None
        self._closed, self._lock = False, threading.RLock()

    def close(self) -> None:
        """End the child, whatever it is doing, and start none again."""
        with self._lock:
            self._closed = True
            self._end()

    def call(self, function: Callable[..., Value], *arguments: Any, timeout: float) -> Value:
        """Call a function of a module in the child, and return its value.

        Args:
            function: The function; it gets and returns what can be pickled, and its errors are raised here.
            timeout: How long it may take, s.

        Raises:
            ChildError: The child died, took longer, or was closed.
        """
        future = self._begin(function, *arguments)
        try:
            return future.result(timeout)
        except TimeoutError:
            if future.done():
                raise
            self._end()
            raise ChildError(f"it did not end within {timeout:,.0f} s") from None
        except BrokenProcessPool:
            self._end()
            raise ChildError("the process that worked on it died") from None

    def _begin(self, function: Callable[..., Value], *arguments: Any) -> Future[Value]:
        with self._lock:
            if self._closed:
                raise ChildError("it was closed")
            if self._pool is None:
                self._pool = WorkerPool(1)
            return self._pool.submit(function, *arguments)

    def _end(self) -> None:
        """Kill the child. What it started ends with it, or is swept away by the next sandbox."""
        with self._lock:
            if self._pool is None:
                return
            pool, self._pool = self._pool, None
            pool.kill()


IDLE = 1.0  # s between two looks when there is nothing to do


def now() -> datetime:
    """Return the time."""
    return datetime.now(UTC)


class Validators:
    """Threads that each take the next submission, and have a child process do the work. A context manager."""

    def __init__(self, season: Season, database: Database, holding: Holding, sandbox: str, log: Log) -> None:
        self._season, self._database, self._holding = season, database, holding
        self._sandbox, self._log = sandbox, log
        self._stopping = threading.Event()
        self._children = [Child() for _ in range(season.settings.execution.validations)]
        self._pool = ThreadPoolExecutor(len(self._children), "validator")

    def __enter__(self) -> Self:
        self._threads = [self._pool.submit(self._work, child) for child in self._children]
        return self

    def __exit__(self, *_: object) -> None:
        """End the work, which the next conductor does again."""
        self._stopping.set()
        for child in self._children:
            child.close()
        self._pool.shutdown()

    def check(self) -> None:
        """Raise what ended a thread, if one has ended."""
        for thread in self._threads:
            if thread.done():
                thread.result()

    def _work(self, child: Child) -> None:
        while not self._stopping.is_set():
            if not self._handle(child):
                self._stopping.wait(IDLE)

    def _handle(self, child: Child) -> bool:
        """Build and validate the submission whose turn it is; return whether there was one."""
        check_room(self._season)
        with self._database.writing() as session:
            season = in_force(session, self._season)
            steps.admit(session, now())
            attempt = steps.take_submission(session, season, self._holding, now())
            if attempt is None:
                return False
            submission = session.get_one(Submission, attempt.submission_id)
        self._log.info("submission_begun", submission=submission.id)
        arguments = (season, submission.archive, submission.entrant, self._sandbox)
        deadlines = season.settings.deadlines
        if self._tried(child, season, attempt, work.build, arguments, deadlines.building) is None:
            return True
        with self._database.writing() as session:
            following = steps.built(session, season, self._holding, attempt.id, now())
        if following is None:
            return True
        of_validation = work.validate, (*arguments, submission.id), deadlines.validating
        warnings = self._tried(child, season, following, *of_validation)
        if warnings is not None:
            with self._database.writing() as session:
                season, held = in_force(session, season), self._holding
                steps.validated(session, season, held, following.id, now(), warnings)
            self._log.info("submission_active", submission=submission.id)
        return True

    def _tried(
        self,
        child: Child,
        season: Season,
        attempt: Attempt,
        function: Callable[..., work.Rejection | str],
        arguments: tuple[object, ...],
        lasts: float,
    ) -> str | None:
        """Do a part of the work on a submission; return of what to warn its team, None if it failed."""
        try:
            rejection = child.call(function, *arguments, timeout=lasts)
        except LeaseLostError:
            raise
        except Exception as error:  # noqa: BLE001 (whatever it is, it is not the competitor's fault)
            if not self._stopping.is_set():
                why = describe(error)
                self._log.warning("attempt_broke", attempt=attempt.id, fault="platform", reason=why)
                with self._database.writing() as session:
                    steps.broke(session, season, self._holding, attempt.id, now(), why)
            return None
        if isinstance(rejection, str):
            return rejection
        with self._database.writing() as session:
            steps.rejected(
                session,
                self._holding,
                attempt.id,
                now(),
                reason=rejection.reason,
                last_lines=rejection.last_lines,
                command=rejection.command,
            )
        self._log.info("submission_rejected", submission=attempt.submission_id, reason=rejection.reason)
        return None
