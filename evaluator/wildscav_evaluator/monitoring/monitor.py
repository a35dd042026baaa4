"""The monitor of a running evaluation, which feeds the dashboard, the log and the metrics."""

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from prometheus_client.core import CounterMetricFamily, GaugeMetricFamily, Metric, SummaryMetricFamily
from prometheus_client.registry import Collector
from rich.console import Console
from rich.live import Live
from rich.text import Text

from wildscav.terminal.console import console, counted
from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import AttemptFailed, Heartbeat, Job, JobEvent, JobResult
from wildscav_evaluator.monitoring.dashboard import dashboard, duration, match_counts
from wildscav_evaluator.monitoring.tally import Tally, TrackProgress
from wildscav_evaluator.output.results import SeatTiming
from wildscav_evaluator.scores.number_format import number, unit_and_title
from wildscav_server.monitoring.logs import LogFormat, open_log
from wildscav_server.monitoring.metrics import serving_metrics

EVERY = 30.0  # s between lines if the output is not a terminal


class EvaluationMetrics(Collector):
    """The metrics of one evaluation, which are read from its tally."""

    def __init__(self, tally: Tally) -> None:
        self._tally = tally

    def collect(self) -> Iterator[Metric]:
        """Yield every metric with its current value."""
        done = tuple(self._tally.done.values())
        yield from self._matches(done)
        yield GaugeMetricFamily("wildscav_matches_running", "Matches being played.", len(self._tally.running))
        yield GaugeMetricFamily(
            "wildscav_matches_waiting", "Matches that have not begun.", self._tally.waiting
        )
        yield from _steps(done)
        yield from self._nodes()
        yield GaugeMetricFamily(
            "wildscav_steps_per_second", "Steps a second of all matches being played.", self._tally.speed
        )

    def _matches(self, done: tuple[JobResult, ...]) -> Iterator[Metric]:
        matches = CounterMetricFamily(
            "wildscav_matches",
            "Matches that ended, including those of earlier runs, by track, submission and status.",
            labels=("track", "submission", "status"),
        )
        keys = [(one.job.track, name, row.status) for one in done for name, row in one.rows.items()]
        for key, count in Counter(keys).items():
            matches.add_metric(key, count)
        yield matches
        faults = CounterMetricFamily(
            "wildscav_faults",
            "Matches in which something went wrong, by fault: agent or platform.",
            labels=("fault",),
        )
        for fault in ("agent", "platform"):
            faults.add_metric((fault,), sum(one.row.fault == fault for one in done))
        yield faults
        yield CounterMetricFamily(
            "wildscav_platform_retries",
            "Matches played again because the platform broke them.",
            self._tally.broken,
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
        "From an observation sent to its answer received, of matches that ended: sum and count.",
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


class EvaluationProgress:
    """Shows the progress that a tally counts; if it is to be quiet, only failures."""

    def __init__(self, console: Console, tally: Tally, title: str = "", *, quiet: bool = False) -> None:
        self._console, self._tally, self._quiet = console, tally, quiet
        self._said_at = tally.clock()
        self._live = Live(
            get_renderable=lambda: dashboard(tally, title, console.width),
            console=console,
            refresh_per_second=4,
            transient=True,
        )

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Show the dashboard for as long as the block lasts; if the output is not a terminal, print lines."""
        if not self._console.is_terminal or self._quiet:
            yield
            return
        # Drawn before anything else is printed: a print that finds no table does not expect one to appear.
        self._live.start(refresh=True)
        try:
            yield
        finally:
            self._live.stop()

    def note_broken(self, job: Job, reason: str) -> None:
        """Print at once that the platform broke a match, which is played again."""
        self._say(f"{job.stem}: played again, the platform's fault", reason, "yellow")

    def note_node(self, node: Node) -> None:
        """Print at once that a node gets no more work."""
        self._say(f"node {node.name} is not used", node.problem, "yellow")

    def add(self, result: JobResult, lines: Sequence[TrackProgress]) -> None:
        """Print at once what went wrong in a match; without a terminal, also the overall progress."""
        row = result.row
        if row.fault is not None:
            self._say(f"{result.job.stem}: {row.status}, {row.fault}'s fault", row.detail, "red")
        if result.replay_error:
            self._say("note", result.replay_error, "yellow")
        if self._console.is_terminal or self._quiet:
            return
        complete = [line for line in lines if line.complete]
        for line in complete:
            score = "-"
            if line.summary is not None:
                score = f"{number(line.summary.mean, line.metric)} {unit_and_title(line.metric)}"
            self._say(f"{line.submission} on {line.track}", f"{counted(line.done, 'match')}, {score}")
        if not complete and self._tally.clock() - self._said_at >= EVERY:
            left = self._tally.time_left()
            about = "" if left is None else f", about {duration(left)} left"
            self._console.print(match_counts(self._tally).append(about))
        elif not complete:
            return
        self._said_at = self._tally.clock()

    def _say(self, what: str, detail: str, style: str = "") -> None:
        # One text without options, because the table below it is redrawn with the options of this print.
        self._console.print(Text.assemble((what, style), f": {detail}"))


@dataclass(frozen=True)
class MonitorOptions:
    """The options for monitoring an evaluation."""

    log_format: LogFormat | None = None  # None for the dashboard, or plain lines
    metrics_port: int | None = None  # None for no metrics


class Monitor:
    """Passes the events of an evaluation on to dashboard, log and metrics.

    ``nodes`` returns the machines of the cluster that plays its matches, if there is one.
    """

    def __init__(
        self,
        jobs: Sequence[Job],
        at_once: int,
        title: str,
        how: MonitorOptions,
        nodes: Callable[[], tuple[Node, ...]] = tuple,
    ) -> None:
        self._how, self._title = how, title
        self.tally = Tally(jobs, at_once, nodes=nodes)
        # Problems that nodes had before were reported when they were examined.
        self._problems = {node.name: node.problem for node in nodes()}
        self._log = open_log(how.log_format)
        self._progress = EvaluationProgress(console, self.tally, title, quiet=how.log_format is not None)

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Show the evaluation for as long as the block lasts."""
        tally = self.tally
        with serving_metrics(EvaluationMetrics(tally), self._how.metrics_port) as address:
            if address is not None:
                console.print(f"metrics   {address}", highlight=False)
            kept = len(tally.done)
            self._log.info("evaluation_begins", what=self._title, matches=len(tally.jobs), kept=kept)
            with self._progress.shown():
                yield
            self._log.info("evaluation_ends", matches=len(tally.done), failed=tally.failed)

    def _note_nodes(self) -> None:
        """Report nodes that get no more work."""
        for node in self.tally.nodes():
            if node.problem != self._problems.get(node.name, ""):
                self._problems[node.name] = node.problem
                self._log.warning("node_not_used", node=node.name, detail=node.problem)
                self._progress.note_node(node)

    def start(self, job: Job) -> None:
        """Note that a match begins."""
        self._note_nodes()
        self.tally.start(job)
        self._log.info("match_begins", match=job.stem, waiting=self.tally.waiting)

    def handle(self, job: Job, event: JobEvent) -> None:
        """Note the progress of a match, or that the platform broke it and it is played again."""
        self._note_nodes()
        if isinstance(event, Heartbeat):
            self.tally.beat(job, event)
        elif isinstance(event, AttemptFailed):
            self.tally.note_broken(job)
            self._log.warning("match_broken", match=job.stem, fault="platform", detail=event.reason)
            self._progress.note_broken(job, event.reason)

    def add_earlier(self, result: JobResult) -> None:
        """Note a match that an earlier run played."""
        self._progress.add(result, self.tally.add_earlier(result))

    def add(self, result: JobResult) -> None:
        """Note that a match ended."""
        line = self.tally.add(result)
        self._write(result)
        self._progress.add(result, line)

    def _write(self, result: JobResult) -> None:
        row, timing = result.row, result.timing
        values: dict[str, Any] = {
            "match": result.job.stem,
            **row.model_dump(include={"status", "fault", "detail", "metrics"}),
        }
        if timing is not None:
            values |= {
                "wall": round(timing.wall, 3),
                "steps": timing.steps,
                "seats": [seat.model_dump() for seat in timing.seats],
                "platform_faults": list(timing.platform_faults),
            }
        write = self._log.info if row.fault is None else self._log.warning
        write("match_ends", **values)
