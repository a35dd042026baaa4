"""Live progress of an evaluation: a dashboard on a terminal, plain lines elsewhere."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from rich.console import Console
from rich.live import Live
from rich.text import Text

from wildscav.terminal.console import counted
from wildscav_evaluator.executors import Node
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.monitoring.dashboard import dashboard, duration, match_counts
from wildscav_evaluator.monitoring.tally import Tally, TrackProgress
from wildscav_evaluator.scores.number_format import number, unit_and_title

EVERY = 30.0  # s between lines if the output is not a terminal


class EvaluationProgress:
    """Shows the progress that a tally counts.

    Args:
        console: The console to print to.
        tally: The tally to show.
        title: A short description of what is evaluated.
        quiet: Whether to show only failures.
    """

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
