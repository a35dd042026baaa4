"""The metrics of a season for Prometheus. What is in the database is counted on request."""

from collections.abc import Iterable, Mapping
from datetime import UTC, datetime
from typing import Any

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from sqlalchemy import func, select, true
from sqlalchemy.orm import Session

from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.database.connection import Database, DatabaseError, clock
from wildscav_leaderboard.hosting.request_log import WebCounts
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.disk import free_bytes
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.webhooks.models import Delivery

PREFIX = "wildscav_season"


class SeasonMetrics(Collector):
    """The metrics of a season."""

    def __init__(self, season: Season, database: Database, counts: WebCounts) -> None:
        self._season, self._database, self._counts = season, database, counts

    def collect(self) -> Iterable[Metric]:
        """Return all metrics; without the database's ones while it does not answer."""
        yield from self._counts.collect()
        free = {(disk,): left for disk, left in free_bytes(self._season).items()}
        yield _metric("disk_free_bytes", "What is free for the season's files, and for caches.", free, "disk")
        try:
            with self._database.reading() as session:
                found = list(_of_database(session, datetime.now(UTC)))
        except DatabaseError:
            found = []
        yield _metric("database_up", "1 while the database answers, else 0.", {(): bool(found)})
        yield from found


def _metric(
    name: str,
    about: str,
    values: Mapping[Any, float],  # by the values of the labels
    *labels: str,
    family: type[GaugeMetricFamily | CounterMetricFamily] = GaugeMetricFamily,
) -> Metric:
    made = family(f"{PREFIX}_{name}", about, labels=labels)
    for key, value in values.items():
        made.add_metric(key, float(value))
    return made


def _of_database(session: Session, now: datetime) -> Iterable[Metric]:
    state = season_state.state_of(session)
    conducts = holder_of(session, clock(session)) is not None and season_state.FAILED not in state
    about = "1 while a conductor holds the lease and can have matches played, else 0."
    yield _metric("conductor_up", about, {(): conducts})
    yield _metric("paused", "1 while the season is paused, else 0.", {(): season_state.PAUSED in state})
    submissions = _counted(session, Submission.state)
    yield _metric("submissions", "Submissions in each state.", submissions, "state")
    waiting = select(func.min(Submission.since)).where(
        Submission.state.in_((states.SUBMITTED, states.QUEUED))
    )
    about = "Age of the oldest submission in the queue, s."
    yield _metric("queue_oldest_seconds", about, {(): _passed(session.scalar(waiting), now)})
    matches = _counted(session, Match.track, Match.state)
    yield _metric("matches", "Matches in each state.", matches, "track", "state")
    ended = _counted(session, Attempt.kind, Attempt.outcome, where=Attempt.outcome.is_not(None))
    about = "Pieces of work that have ended, by kind and outcome; platform and lost are your faults."
    yield _metric("attempts", about, ended, "kind", "outcome", family=CounterMetricFamily)
    due = session.scalar(select(func.min(Delivery.next_at)))
    about = "How long the oldest message to a webhook has been due, s."
    yield _metric("webhooks_overdue_seconds", about, {(): _passed(due, now)})
    restarts = {(thread,): count for thread, count in state.get(season_state.RESTARTS, {}).items()}
    about = "How often threads of the conductor broke and began again, by thread; the log has the reason."
    yield _metric("restarts", about, restarts, "thread", family=CounterMetricFamily)


def _counted(session: Session, *columns: Any, where: Any = true()) -> dict[tuple[str, ...], int]:  # noqa: B008
    """Return how many rows have the same values in some columns, by these."""
    wanted = select(*columns, func.count()).where(where).group_by(*columns).order_by(*columns)
    return {tuple(values): count for *values, count in session.execute(wanted)}


def _passed(since: datetime | None, now: datetime) -> float:
    return 0.0 if since is None else max(0.0, (now - since).total_seconds())
