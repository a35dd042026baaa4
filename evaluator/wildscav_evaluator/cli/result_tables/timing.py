"""The table of how agents used their time, and the lines about their sandbox and its limits."""

import statistics
from collections.abc import Iterator, Mapping

from rich.table import Table
from rich.text import Text

from wildscav_evaluator.cli.result_tables.ranking import add_columns, plain_table
from wildscav_evaluator.output.results import KeptLimits, Results, SeatTiming
from wildscav_evaluator.scores.number_format import NOTHING
from wildscav_evaluator.seats import ROBOT_ENTRANT

UNITS = ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB"))


def timing_table(results: Results) -> Table:
    """Return how each submission used its time on each track, over all its matches and seats."""
    table = plain_table("time of the agents, measured at the engine")
    table.add_column("track", vertical="bottom", no_wrap=True)
    table.add_column("agent", vertical="bottom", min_width=7)
    add_columns(table, "answer\nmedian", "worst\np99", "longest", "used in\na match")
    add_columns(table, "late\nsteps", "least\nin bank", "start-\nup")
    for evaluation in results.evaluations:
        track, name = evaluation.track, evaluation.submission
        seats = [seat for timing in results.timings_of(evaluation) for seat in timing.seats]
        if seats or not name.startswith(ROBOT_ENTRANT):
            table.add_row(track, name, *(_cells(seats) if seats else [NOTHING] * 7))
    return table


def _cells(seats: list[SeatTiming]) -> Iterator[Text | str]:
    """Yield the cells that sum up some seats, at least one."""
    late, steps = sum(seat.late_steps for seat in seats), sum(seat.steps for seat in seats)
    yield _time(statistics.median(seat.latency_p50 for seat in seats))
    yield _time(max(seat.latency_p99 for seat in seats))
    yield _time(max(seat.latency_max for seat in seats))
    yield _time(statistics.fmean(seat.time_used for seat in seats))
    yield Text(f"{late / steps:.1%}", "red") if late else "0"
    yield _time(min(seat.time_bank for seat in seats))
    starts = [seat.start_up for seat in seats if seat.start_up is not None]
    yield _time(max(starts)) if starts else NOTHING


def _time(seconds: float) -> str:
    """Return a time with its unit, short enough for a narrow column."""
    if seconds < 1.0:
        return f"{seconds * 1e3:.1f} ms" if seconds < 0.01 else f"{seconds * 1e3:.0f} ms"
    return f"{seconds:.1f} s"


def sandbox_and_limits(sandbox: str, limits: Mapping[str, KeptLimits]) -> Iterator[str]:
    """Yield the sandbox and its limits, one line for each set of tracks with equal limits."""
    tracks_by_limits: dict[str, list[str]] = {}
    for track, kept in limits.items():
        tracks_by_limits.setdefault(limits_in_words(kept), []).append(track)
    if not tracks_by_limits:
        yield sandbox
    for words, tracks in tracks_by_limits.items():
        where = "" if len(tracks_by_limits) == 1 else f" on {', '.join(tracks)}"
        yield f"{sandbox}; each agent{where}: {words}"


def limits_in_words(limits: KeptLimits) -> str:
    """Return limits in one line, without those that the sandbox does not enforce."""
    words = []
    if limits.cpus is not None:
        words.append(f"{limits.cpus:g} {'core' if limits.cpus == 1 else 'cores'}")
    if limits.memory is not None:
        words.append(f"{_size(limits.memory)} of memory")
    if limits.processes is not None:
        words.append(f"{limits.processes:,} processes")
    if limits.open_files is not None:
        words.append(f"{limits.open_files:,} open files")
    if limits.tmp_size is not None:
        words.append(f"{_size(limits.tmp_size)} in /tmp")
    if limits.output is not None:
        words.append(f"{_size(limits.output)} of output")
    if limits.wall_clock is not None:
        words.append(f"matches of {limits.wall_clock:,g} s at most")
    return ", ".join(words)


def _size(count: int) -> str:
    """Return a number of bytes in a unit that makes it round, if there is one."""
    for unit, name in UNITS:
        if count % unit == 0:
            return f"{count // unit:,} {name}"
    return f"{count / 1e6:,g} MB" if count % 1000 == 0 else f"{count:,} bytes"
