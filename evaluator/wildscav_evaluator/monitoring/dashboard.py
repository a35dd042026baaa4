"""The dashboard of an evaluation: what a terminal shows while it runs."""

from collections.abc import Iterator

from rich.console import Group, RenderableType
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from wildscav.terminal.console import counted
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_evaluator.monitoring.tally import RunningMatch, Tally, TrackProgress
from wildscav_evaluator.scores.number_format import NOTHING, number, unit_and_title

BAR = 18  # columns
NAME = 22  # columns that a submission's name takes at most
SHOWN = 8  # running matches, at most
LINES = 24  # submissions on a track, at most
WIDE = 78  # columns from which there is space for bars and intervals
NUMBER_COLUMNS = 31  # columns that the numbers of a narrow line take


def dashboard(tally: Tally, title: str, width: int = WIDE) -> RenderableType:
    """Return the dashboard as it is now; a narrow terminal gets no bars and no intervals."""
    wide = width >= WIDE
    name = NAME if wide else max(6, min(NAME, width - NUMBER_COLUMNS))
    return Group(
        *_head(tally, title, wide=wide),
        *_tracks(tally, name, wide=wide),
        *_nodes(tally, name),
        *_running(tally, name, wide=wide),
    )


def _head(tally: Tally, title: str, *, wide: bool) -> Iterator[RenderableType]:
    done, total = len(tally.done), len(tally.jobs)
    times = f"{duration(tally.elapsed)} elapsed"
    if (left := tally.time_left()) is not None and done < total:
        times += f", about {duration(left)} left"
    yield Text(title, "bold")
    if wide:
        table = Table.grid(padding=(0, 2))
        table.add_row(ProgressBar(total, done, width=BAR), match_counts(tally))
        yield table
    else:
        yield match_counts(tally)
    yield Text(times)


def match_counts(tally: Tally) -> Text:
    """Return how many matches are done, running, waiting and failed."""
    text = Text(f"{len(tally.done):,} of {counted(len(tally.jobs), 'match')} done")
    if tally.running:
        text.append(f", {len(tally.running)} running", "cyan")
    if tally.waiting:
        text.append(f", {tally.waiting:,} waiting", "dim")
    text.append(f", {tally.failed:,} failed", "red" if tally.failed else "dim")
    if tally.broken:
        text.append(f", {tally.broken:,} played again", "yellow")
    return text


def _tracks(tally: Tally, name: int, *, wide: bool) -> Iterator[RenderableType]:
    """Yield a table for each track: the progress of each submission, and its score so far."""
    lines = tuple(tally.lines.values())
    width = min(name, max(len(line.submission) for line in lines))
    for track in dict.fromkeys(line.track for line in lines):
        of_track = [line for line in lines if line.track == track]
        metric = of_track[0].metric
        arrow = "↓" if metric.lower_is_better else "↑"
        yield Text.assemble("\n", (track, "bold"), (f"  {unit_and_title(metric)} {arrow}", "dim"))
        table = Table.grid(padding=(0, 2))
        table.add_column(width=width, no_wrap=True)
        if wide:
            table.add_column()
        for columns in (9, 7, 15) if wide else (7, 6):
            table.add_column(width=columns, justify="right", no_wrap=True)
        table.add_column(no_wrap=True)
        for line in of_track[:LINES]:
            table.add_row(*_cells(line, wide=wide))
        yield table
        if len(of_track) > LINES:
            yield Text(f"and {len(of_track) - LINES:,} more", "dim")


def _cells(line: TrackProgress, *, wide: bool) -> Iterator[RenderableType]:
    yield Text(line.submission)
    if wide:
        yield ProgressBar(line.total, line.done, width=BAR // 2)
    yield f"{line.done}/{line.total}"
    yield Text(NOTHING if line.summary is None else number(line.summary.mean, line.metric), "bold")
    if wide:
        yield _interval(line)
    yield _state(line)


def _interval(line: TrackProgress) -> str:
    if line.summary is None or len(line.scores) == 1:
        return ""
    return f"{number(line.summary.low, line.metric)}–{number(line.summary.high, line.metric)}"


def _state(line: TrackProgress) -> Text:
    if line.failed:
        return Text(f"{line.failed} failed", "red")
    if line.complete:
        return Text("done", "green")
    return Text("running", "cyan") if line.running else Text("waiting" if line.done == 0 else "", "dim")


def _nodes(tally: Tally, name: int) -> Iterator[RenderableType]:
    """Yield what each machine of a cluster does; nothing without a cluster."""
    nodes = tally.nodes()
    if not nodes:
        return
    used = [node for node in nodes if not node.problem]
    cores = sum(node.cores for node in used)
    yield Text.assemble("\n", ("nodes", "bold"), (f"  {len(used)} with {counted(cores, 'core')}", "dim"))
    table = Table.grid(padding=(0, 2))
    table.add_column(width=min(name, max(len(node.name) for node in nodes)), no_wrap=True)
    for _ in range(2):
        table.add_column(justify="right", no_wrap=True)
    table.add_column(no_wrap=True)
    for node in sorted(nodes, key=lambda node: (bool(node.problem), -node.running))[:SHOWN]:
        state = Text("not used", "red") if node.problem else Text(f"{node.running} running", "cyan")
        table.add_row(Text(node.name), counted(node.cores, "core"), f"{node.done:,} done", state)
    yield table
    if len(nodes) > SHOWN:
        yield Text(f"and {len(nodes) - SHOWN} more", "dim")


def _running(tally: Tally, name: int, *, wide: bool) -> Iterator[RenderableType]:
    """Yield the matches that are being played, each with its progress."""
    running = sorted(tally.running.values(), key=lambda one: one.since)
    if not running:
        return
    table = Table.grid(padding=(0, 2))
    longest = max(len(one.job.stem) for one in running[:SHOWN])
    table.add_column(width=min(2 * NAME if wide else name + NUMBER_COLUMNS // 2, longest), no_wrap=True)
    for one in running[:SHOWN]:
        table.add_row(*_match(one, wide=wide))
    yield Text.assemble("\n", ("playing", "bold"), (f"  {tally.speed:,.0f} steps/s", "dim"))
    yield table
    if len(running) > SHOWN:
        yield Text(f"and {len(running) - SHOWN} more", "dim")


def _match(one: RunningMatch, *, wide: bool) -> Iterator[RenderableType]:
    spec, frames = one.job.spec, one.heartbeat.frames if one.heartbeat else 0
    yield Text(one.job.stem)
    if wide:
        yield ProgressBar(spec.frame_limit, frames, width=BAR // 2)
    if one.heartbeat is None:
        yield Text("starting", "dim")
    else:
        yield Text(f"{frames / FRAMES_PER_SECOND:,.0f} of {spec.time_limit:,.0f} s")


def duration(seconds: float) -> str:
    """Return a duration in readable units, such as "4 min 05 s"."""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    minutes, rest = divmod(whole, 60)
    if minutes < 60:
        return f"{minutes} min {rest:02} s"
    return f"{minutes // 60} h {minutes % 60:02} min"
