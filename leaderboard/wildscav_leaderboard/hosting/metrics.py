"""The metrics of a season for Prometheus. What is in the database is counted on request."""

from collections.abc import Iterable
from datetime import UTC, datetime

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric
from prometheus_client.registry import Collector
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from wildscav_leaderboard.conductor.lease import holder_of
from wildscav_leaderboard.conductor.models import Attempt
from wildscav_leaderboard.database.connection import Database, DatabaseError, clock
from wildscav_leaderboard.hosting.web_counts import WebCounts
from wildscav_leaderboard.matches.models import Match
from wildscav_leaderboard.seasons import state as season_state
from wildscav_leaderboard.seasons.disk import free_bytes
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions import states
from wildscav_leaderboard.submissions.models import Submission
from wildscav_leaderboard.webhooks.models import Delivery

PREFIX = "wildscav_season"


class SeasonMetrics(Collector):
    """The metrics of a season.

    Args:
        season: The season.
        database: Its database.
        counts: What this process counts.
    """

    def __init__(self, season: Season, database: Database, counts: WebCounts) -> None:
        self._season, self._database, self._counts = season, database, counts

    def collect(self) -> Iterable[Metric]:
        """Return all metrics; without the database's ones while it does not answer."""
        yield from self._counts.collect()
        free = GaugeMetricFamily(
            f"{PREFIX}_disk_free_bytes",
            "What is free for the season's files, and for caches.",
            labels=("disk",),
        )
        for disk, left in free_bytes(self._season).items():
            free.add_metric((disk,), left)
        yield free
        answers = GaugeMetricFamily(f"{PREFIX}_database_up", "1 while the database answers, else 0.")
        try:
            with self._database.reading() as session:
                found = list(_of_database(session, datetime.now(UTC)))
        except DatabaseError:
            answers.add_metric((), 0)
            yield answers
            return
        answers.add_metric((), 1)
        yield answers
        yield from found


def _of_database(session: Session, now: datetime) -> Iterable[Metric]:
    conductor = GaugeMetricFamily(
        f"{PREFIX}_conductor_up", "1 while a conductor holds the lease and can have matches played, else 0."
    )
    failed = season_state.read_state(session, season_state.FAILED)
    conductor.add_metric((), float(holder_of(session, clock(session)) is not None and failed is None))
    yield conductor
    paused = GaugeMetricFamily(f"{PREFIX}_paused", "1 while the season is paused, else 0.")
    paused.add_metric((), float(season_state.read_state(session, season_state.PAUSED) is not None))
    yield paused
    yield _submissions(session)
    yield _oldest(session, now)
    yield _matches(session)
    yield _attempts(session)
    yield _overdue(session, now)
    yield _restarts(session)


def _submissions(session: Session) -> Metric:
    family = GaugeMetricFamily(f"{PREFIX}_submissions", "Submissions in each state.", labels=("state",))
    counted = select(Submission.state, func.count()).group_by(Submission.state)
    for state, count in session.execute(counted.order_by(Submission.state)):
        family.add_metric((state,), count)
    return family


def _oldest(session: Session, now: datetime) -> Metric:
    family = GaugeMetricFamily(
        f"{PREFIX}_queue_oldest_seconds", "How long the submission has waited that has waited longest."
    )
    waiting = select(func.min(Submission.since)).where(
        Submission.state.in_((states.SUBMITTED, states.QUEUED))
    )
    family.add_metric((), _passed(session.scalar(waiting), now))
    return family


def _passed(since: datetime | None, now: datetime) -> float:
    return 0.0 if since is None else max(0.0, (now - since).total_seconds())


def _matches(session: Session) -> Metric:
    family = GaugeMetricFamily(f"{PREFIX}_matches", "Matches in each state.", labels=("track", "state"))
    counted = select(Match.track, Match.state, func.count()).group_by(Match.track, Match.state)
    for track, state, count in session.execute(counted.order_by(Match.track, Match.state)):
        family.add_metric((track, state), count)
    return family


def _attempts(session: Session) -> Metric:
    family = CounterMetricFamily(
        f"{PREFIX}_attempts", "Attempts at work that have ended.", labels=("kind", "outcome")
    )
    counted = (
        select(Attempt.kind, Attempt.outcome, func.count())
        .where(Attempt.outcome.is_not(None))
        .group_by(Attempt.kind, Attempt.outcome)
    )
    for kind, outcome, count in session.execute(counted.order_by(Attempt.kind, Attempt.outcome)):
        family.add_metric((kind, outcome or ""), count)
    return family


def _overdue(session: Session, now: datetime) -> Metric:
    family = GaugeMetricFamily(
        f"{PREFIX}_webhooks_overdue_seconds", "How long the message has been due that has been due longest."
    )
    family.add_metric((), _passed(session.scalar(select(func.min(Delivery.next_at))), now))
    return family


def _restarts(session: Session) -> Metric:
    family = CounterMetricFamily(
        f"{PREFIX}_restarts", "How often threads of the conductor broke and began again.", labels=("thread",)
    )
    for thread, count in (season_state.read_state(session, season_state.RESTARTS) or {}).items():
        family.add_metric((thread,), count)
    return family
