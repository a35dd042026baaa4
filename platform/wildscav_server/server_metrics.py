"""The Prometheus metrics of a server. They are computed on request, so that they add nothing to a step."""

from bisect import bisect_left
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import TYPE_CHECKING

from prometheus_client.core import (
    CounterMetricFamily,
    GaugeMetricFamily,
    HistogramMetricFamily,
    Metric,
)
from prometheus_client.registry import Collector

if TYPE_CHECKING:
    from wildscav_server.hosting.hosted_match import HostedMatch

BOUNDS = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 5.0, 30.0)  # s, of step latencies


class ServerMetrics(Collector):
    """The counts of one server."""

    def __init__(
        self, matches: "Callable[[], Iterable[HostedMatch]]", pending_streams: Callable[[], int]
    ) -> None:
        self._matches, self._pending_streams = matches, pending_streams
        self._ended: Counter[tuple[str, ...]] = Counter()  # by track and how
        self._seats: Counter[tuple[str, ...]] = Counter()  # by outcome and fault
        self._refusals: Counter[tuple[str, ...]] = Counter()  # by reason
        self._steps = self._late = 0  # of matches that ended
        self._latencies = [0] * (len(BOUNDS) + 1)
        self._latency_sum = 0.0  # s

    # The interface for the server.

    def refused(self, reason: str) -> None:
        """Count a stream that was refused or ended by the server."""
        self._refusals[(reason,)] += 1

    def ended(self, match: "HostedMatch", how: str) -> None:
        """Count a match that is over: "finished", "failed" or "cancelled"."""
        self._ended[match.match.spec.track, how] += 1
        self._steps += match.match.step_number
        for seat in match.seats.values():
            self._late += seat.conduct.late_steps
            self._latency_sum += sum(seat.times)
            for time in seat.times:
                self._latencies[bisect_left(BOUNDS, time)] += 1
            if how == "finished":
                status = seat.conduct.status
                self._seats[status.value, status.fault or ""] += 1
            elif how == "failed":
                self._seats["failed", "platform"] += 1

    # The interface for Prometheus.

    def collect(self) -> Iterator[Metric]:
        """Yield the current value of every metric."""
        open_now = list(self._matches())
        yield from self._of_matches(open_now)
        yield from self._of_steps(open_now)
        yield _counter(
            "refusals", "Streams refused or ended by the server, by reason.", self._refusals, "reason"
        )
        yield GaugeMetricFamily(
            "wildscav_server_strangers",
            "Streams that have not joined a seat yet.",
            self._pending_streams(),
        )

    def _of_matches(self, open_now: "list[HostedMatch]") -> Iterator[Metric]:
        yield _counter(
            "matches", "Matches that are over, by track and by how they ended.", self._ended, "track", "how"
        )
        opened = GaugeMetricFamily(
            "wildscav_server_matches_open", "Matches that are being joined or played.", labels=("state",)
        )
        playing = sum(match.playing for match in open_now)
        opened.add_metric(("joining",), len(open_now) - playing)
        opened.add_metric(("playing",), playing)
        yield opened
        text = "Seats of matches that are over, by outcome and fault."
        yield _counter("seats", text, self._seats, "status", "fault")

    def _of_steps(self, open_now: "list[HostedMatch]") -> Iterator[Metric]:
        running = sum(match.match.step_number for match in open_now)
        yield CounterMetricFamily(
            "wildscav_server_steps", "Steps played; their rate is steps per second.", self._steps + running
        )
        late = sum(seat.conduct.late_steps for match in open_now for seat in match.seats.values())
        yield CounterMetricFamily(
            "wildscav_server_late_steps", "Steps that a seat was late for.", self._late + late
        )
        total, buckets = 0, []
        for bound, count in zip((*map(str, BOUNDS), "+Inf"), self._latencies, strict=True):
            total += count
            buckets.append((bound, total))
        latency = HistogramMetricFamily(
            "wildscav_server_step_latency_seconds",
            "From sending an observation to receiving its answer, in matches that are over.",
        )
        latency.add_metric((), buckets, self._latency_sum)
        yield latency


def _counter(
    name: str, text: str, counts: Mapping[tuple[str, ...], int], *labels: str
) -> CounterMetricFamily:
    """Return a metric with a count for each combination of its labels."""
    metric = CounterMetricFamily(f"wildscav_server_{name}", text, labels=labels)
    for values, count in counts.items():
        metric.add_metric(values, count)
    return metric
