"""The monitor of a running evaluation, which feeds the dashboard, the log and the metrics."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

from wildscav.monitoring.logs import LogFormat, open_log
from wildscav.monitoring.metrics import serving_metrics
from wildscav.terminal.console import console
from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import AttemptFailed, Heartbeat, Job, JobEvent, JobResult
from wildscav_evaluator.monitoring.progress import EvaluationProgress
from wildscav_evaluator.monitoring.prometheus_metrics import EvaluationMetrics
from wildscav_evaluator.monitoring.tally import Tally


@dataclass(frozen=True)
class MonitorOptions:
    """The options for monitoring an evaluation."""

    log_format: LogFormat | None = None  # None for the dashboard, or plain lines
    metrics_port: int | None = None  # None for no metrics


class Monitor:
    """Passes the events of an evaluation on to dashboard, log and metrics.

    Args:
        jobs: All matches.
        at_once: How many are played at once.
        title: A short description of what is evaluated.
        how: The options.
        nodes: Returns the machines of the cluster that plays them, if there is one.
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
            "status": row.status,
            "fault": row.fault,
            "detail": row.detail,
            "metrics": row.metrics,
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
