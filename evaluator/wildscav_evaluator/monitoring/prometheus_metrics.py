"""Prometheus metrics of an evaluation, read from its tally at each request."""

from collections import Counter
from collections.abc import Iterator

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric, SummaryMetricFamily
from prometheus_client.registry import Collector

from wildscav_evaluator.matches.jobs import JobResult
from wildscav_evaluator.monitoring.tally import Tally
from wildscav_evaluator.output.results import SeatTiming


class EvaluationMetrics(Collector):
    """The metrics of one evaluation.

    Args:
        tally: The tally from which the metrics are read.
    """

    def __init__(self, tally: Tally) -> None:
        self._tally = tally

    def collect(self) -> Iterator[Metric]:
        """Yield every metric with its current value."""
        done = tuple(self._tally.done.values())
        yield from self._matches(done)
        yield from self._queue()
        yield from _steps(done)
        yield from self._nodes()
        yield GaugeMetricFamily(
            "wildscav_steps_per_second", "Steps a second of all matches being played.", self._tally.speed
        )

    def _matches(self, done: tuple[JobResult, ...]) -> Iterator[Metric]:
        matches = CounterMetricFamily(
            "wildscav_matches",
            "Matches that ended, including those of earlier runs.",
            labels=("track", "submission", "status"),
        )
        keys = [(one.job.track, name, row.status) for one in done for name, row in one.rows.items()]
        for key, count in Counter(keys).items():
            matches.add_metric(key, count)
        yield matches
        faults = CounterMetricFamily(
            "wildscav_faults", "Matches in which something went wrong, by whose fault.", labels=("fault",)
        )
        for fault in ("agent", "platform"):
            faults.add_metric((fault,), sum(one.row.fault == fault for one in done))
        yield faults
        yield CounterMetricFamily(
            "wildscav_platform_retries",
            "Matches played again because the platform broke them.",
            self._tally.broken,
        )

    def _queue(self) -> Iterator[Metric]:
        yield GaugeMetricFamily("wildscav_matches_running", "Matches being played.", len(self._tally.running))
        yield GaugeMetricFamily(
            "wildscav_matches_waiting", "Matches that have not begun.", self._tally.waiting
        )

    def _nodes(self) -> Iterator[Metric]:
        """Yield what each machine of a cluster does; nothing without a cluster."""
        nodes = self._tally.nodes()
        if not nodes:
            return
        used = GaugeMetricFamily("wildscav_node_used", "1 if a node gets work, else 0.", labels=("node",))
        cores = GaugeMetricFamily("wildscav_node_cores", "Cores of a node.", labels=("node",))
        running = GaugeMetricFamily(
            "wildscav_node_matches_running", "Matches being played on a node.", labels=("node",)
        )
        done = CounterMetricFamily("wildscav_node_matches", "Matches that ended on a node.", labels=("node",))
        for node in nodes:
            used.add_metric((node.name,), not node.problem)
            cores.add_metric((node.name,), node.cores)
            running.add_metric((node.name,), node.running)
            done.add_metric((node.name,), node.done)
        yield from (used, cores, running, done)


def _steps(done: tuple[JobResult, ...]) -> Iterator[Metric]:
    steps = CounterMetricFamily("wildscav_steps", "Steps of matches that ended.", labels=("track",))
    late = CounterMetricFamily("wildscav_late_steps", "Steps without an answer in time.", labels=("track",))
    latency = SummaryMetricFamily(
        "wildscav_step_latency_seconds",
        "From an observation sent to its answer received, of matches that ended.",
        labels=("track", "submission"),
    )
    timed = [(one.job, one.timing) for one in done if one.timing is not None]
    for track in dict.fromkeys(job.track for job, _ in timed):
        of_track = [(job, timing) for job, timing in timed if job.track == track]
        steps.add_metric((track,), sum(timing.steps for _, timing in of_track))
        own: dict[str, list[SeatTiming]] = {}
        for job, timing in of_track:
            for seat in timing.seats:
                own.setdefault(job.entrants[seat.seat], []).append(seat)
        late.add_metric((track,), sum(seat.late_steps for seats in own.values() for seat in seats))
        for submission, seats in own.items():
            latency.add_metric(
                (track, submission),
                count_value=sum(seat.steps for seat in seats),
                sum_value=sum(seat.time_used for seat in seats),
            )
    yield from (steps, late, latency)
