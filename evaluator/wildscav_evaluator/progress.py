"""Live progress of an evaluation."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console, Group
from rich.live import Live
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

from wildscav.console import counted
from wildscav_evaluator.jobs import Job, JobResult
from wildscav_evaluator.run import metric_infos
from wildscav_evaluator.tables import number


class Line:
    """One submission on one track, as far as it has come."""

    def __init__(self, track: str, submission: str) -> None:
        self.track, self.submission = track, submission
        self.total = self.done = self.faults = 0
        self.scores: list[float] = []
        self.metric = metric_infos(track)[0]

    def add(self, result: JobResult) -> None:
        """Count a match."""
        self.done += 1
        self.faults += result.row.fault is not None
        if result.row.metrics is not None:
            self.scores.append(result.row.metrics[self.metric.name])

    @property
    def score(self) -> str:
        """The mean score so far, as text."""
        if not self.scores:
            return "-"
        unit = f" {self.metric.unit}" if self.metric.unit and not self.metric.title.endswith("rate") else ""
        return f"{number(sum(self.scores) / len(self.scores), self.metric)}{unit} {self.metric.title}"


class EvaluationProgress:
    """An overall bar, and a line for every submission and track."""

    def __init__(self, console: Console, jobs: Sequence[Job]) -> None:
        self._console = console
        self._lines: dict[tuple[str, str], Line] = {}
        for job in jobs:
            key = (job.track, job.submission.name)
            self._lines.setdefault(key, Line(*key)).total += 1
        self._bar = Progress(
            TextColumn("matches"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), console=console
        )
        self._task = self._bar.add_task("matches", total=len(jobs))
        self._live = Live(get_renderable=self._render, console=console, refresh_per_second=4, transient=True)

    @contextmanager
    def shown(self) -> Iterator[None]:
        """Show it for as long as the block lasts. Where nobody watches, finished lines are printed."""
        if not self._console.is_terminal:
            yield
            return
        with self._live:
            yield

    def add(self, result: JobResult) -> None:
        """Count a match that ended, and say at once what went wrong in it."""
        line = self._lines[result.job.track, result.job.submission.name]
        line.add(result)
        self._bar.advance(self._task)
        row = result.row
        if row.fault is not None:
            self._say(f"{result.job.stem}: {row.status}, {row.fault}'s fault", row.detail, "red")
        if result.complaint:
            self._say("note", result.complaint, "yellow")
        if line.done == line.total and not self._console.is_terminal:
            self._say(f"{line.submission} on {line.track}", f"{counted(line.done, 'match')}, {line.score}")

    def _say(self, what: str, detail: str, style: str = "") -> None:
        # One text with no options: the table below it is drawn again with the options of this print.
        self._console.print(Text.assemble((what, style), f": {detail}"))

    def _render(self) -> Group:
        table = Table.grid(padding=(0, 2))
        for line in self._lines.values():
            faults = f"[red]{line.faults} failed[/red]" if line.faults else ""
            done = line.done == line.total
            state = "[green]done[/green]" if done else "[dim]waiting[/dim]" if line.done == 0 else "running"
            table.add_row(line.submission, line.track, f"{line.done}/{line.total}", state, line.score, faults)
        return Group(table, self._bar)
