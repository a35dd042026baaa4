"""Readable tables of results, narrow enough for a terminal of 80 columns, and the lines below them.

Fields that a track does not have are counted in the results without a line, because an agent for several
tracks may set them.
"""

import statistics
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from rich.table import Table
from rich.text import Text

from wildscav.terminal.console import counted
from wildscav.terminal.tables import FittingTable
from wildscav.wire.actions import MAX_WALK_SPEED
from wildscav_evaluator.output.results import (
    Evaluation,
    KeptLimits,
    MatchTiming,
    MetricInfo,
    Overall,
    Results,
    SeatTiming,
    Summary,
    with_interface,
)
from wildscav_evaluator.scores.leaderboard import ranked
from wildscav_evaluator.scores.number_format import NOTHING, number
from wildscav_evaluator.seats import ROBOT_ENTRANT

if TYPE_CHECKING:  # they load SciPy, which most commands can do without
    from wildscav_evaluator.ratings.standings import Standing
    from wildscav_evaluator.tournaments.tournament_file import Tournament

HEADING_WIDTH = 8
LEGEND = "↓ lower is better, ↑ higher is better. The first metric decides the rank."
UNITS = ((1 << 30, "GiB"), (1 << 20, "MiB"), (1 << 10, "KiB"))
MAX_OPPONENTS = 8  # in the table of pairs; the picture and the file have all
MAX_ROWS = 100  # of the standings; the file has all
LETTERS = 26
OVERALL_LEGEND = (
    "Across tracks, random has 0 and the suite's reference on each track 1. IQM is the mean of the middle "
    "half of all matches. The mean decides the rank."
)
RATING_LEGEND = (
    "Entrants that share a letter cannot be told apart. Ratings are on the scale of Elo: 400 more are odds "
    "of 10 : 1. Wins are first places, + shared ones."
)
GROUPS = (
    " The entrants form {} groups that never met each other: ratings, ranks and letters can be compared only "
    "within a group. More --rounds or --seats connect them."
)


def track_table(results: Results, track: str) -> Table:
    """Return the table of one track: the submissions from best to worst."""
    evaluations = [one for one in results.evaluations if one.track == track]
    table = ranking_table(f"{track} · suite {results.suite} · seed {results.seed_label}")
    add_metrics(table, evaluations[0].metrics)
    add_columns(table, "matches\nfailed")
    for rank, one in ranked(evaluations):
        table.add_row(*evaluation_cells(rank, one))
    return table


def evaluation_cells(rank: int | None, one: Evaluation) -> Iterator[Text | str]:
    """Yield the cells of an evaluation in a table of standings."""
    yield NOTHING if rank is None else str(rank)
    yield one.title
    yield from metric_cells(one.metrics, one.summary)
    yield fault_cell(one.faults, len(one.matches))


def overall_table(title: str, rows: Iterable[tuple[int, Overall]]) -> Table:
    """Return the table of submissions across all tracks, each with its rank; best first."""
    table, ranked_rows = ranking_table(f"all tracks · {title}"), list(rows)
    add_columns(table, "mean ↑", "95 %\ninterval", "IQM ↑")
    add_columns(table, *(f"{track[:4]}.\n↑" for track in ranked_rows[0][1].tracks))
    for rank, one in ranked_rows:
        table.add_row(
            str(rank),
            with_interface(f"{one.submission} {one.version}", one.interface),
            Text(f"{one.mean.value:.2f}", "bold"),
            f"{one.mean.low:.2f} to {one.mean.high:.2f}",
            *(f"{each.value:.2f}" for each in (one.iqm, *one.tracks.values())),
        )
    return table


def plain_table(title: str) -> FittingTable:
    """Return a table without columns, in the style of all result tables."""
    return FittingTable(title)


def ranking_table(title: str) -> Table:
    """Return a table with the first columns of every table of standings."""
    table = plain_table(title)
    add_columns(table, "#")
    table.add_column("submission", vertical="bottom", min_width=12)
    return table


def add_metrics(table: Table, metrics: Iterable[MetricInfo]) -> None:
    """Add the columns of a track's metrics; the interval of the first follows it."""
    for position, metric in enumerate(metrics):
        add_columns(table, heading(metric))
        if position == 0:
            add_columns(table, "95 %\ninterval")


def add_columns(table: Table, *headings: str) -> None:
    """Add right-aligned columns of numbers."""
    for text in headings:
        table.add_column(text, justify="right", vertical="bottom", no_wrap=True)


def heading(metric: MetricInfo) -> str:
    """Return a column's heading: title, unit, and an arrow for the better direction."""
    unit = f" [{metric.unit}]" if metric.unit else ""
    text = f"{metric.title}{unit} {'↓' if metric.lower_is_better else '↑'}"
    return "\n".join(wrap(text, HEADING_WIDTH, break_long_words=False))


def metric_cells(metrics: Iterable[MetricInfo], summary: dict[str, Summary]) -> Iterator[Text | str]:
    """Yield the cells under the columns of ``add_metrics``."""
    for position, metric in enumerate(metrics):
        values = summary.get(metric.name)
        mean = NOTHING if values is None else number(values.mean, metric)
        yield Text(mean, "bold") if position == 0 else mean
        if position == 0:
            yield (
                NOTHING if values is None else f"{number(values.low, metric)}–{number(values.high, metric)}"
            )


def fault_cell(faults: int, matches: int) -> Text:
    """Return how many matches failed, in red if any did."""
    return Text(f"{faults} of {matches}", "red" if faults else "")


def legend(tournament: "Tournament") -> str:
    """Return the explanation of the standings, which names the groups if there are several."""
    groups = len({one.group for one in tournament.ratings.standings})
    return RATING_LEGEND + (GROUPS.format(groups) if groups > 1 else "")


def standings_table(tournament: "Tournament") -> Table:
    """Return the standings: every entrant from best to worst."""
    standings, entries = tournament.ratings.standings, {one.name: one for one in tournament.entrants}
    failed = any(one.faults for one in tournament.entrants)
    table = plain_table(tournament.title)
    add_columns(table, "ranks", "bands")
    table.add_column("entrant", vertical="bottom", min_width=12)
    add_columns(table, "rating\n± 95 %", "matches", "wins", "mean\nplace")
    add_columns(table, heading(tournament.score), *(["failed"] if failed else []))
    for one in standings[:MAX_ROWS]:
        entry = entries[one.entrant]
        table.add_row(
            one.ranks,
            "".join(map(letters, one.bands)),
            with_interface(one.entrant, entry.interface),
            Text.assemble((f"{one.rating:.0f}", "bold"), _interval(one)),
            f"{one.matches:,}",
            one.first_places,
            f"{one.mean_place:.2f}",
            NOTHING if entry.score is None else number(entry.score.mean, tournament.score),
            *([fault_cell(entry.faults, one.matches)] if failed else []),
        )
    if len(standings) > MAX_ROWS:
        table.caption = f"and {len(standings) - MAX_ROWS:,} more"
    return table


def _interval(one: "Standing") -> str:
    """Return half the width of a rating's interval, which is symmetric; nothing after a single game."""
    return "" if one.low is None or one.high is None else f" ±{(one.high - one.low) / 2:.0f}"


def pairs_table(tournament: "Tournament") -> Table:
    """Return who was placed better than whom: wins, ties and losses of the row against the column."""
    names = [one.entrant for one in tournament.ratings.standings][:MAX_OPPONENTS]
    found = {}
    for pair in tournament.ratings.pairs:
        found[pair.first, pair.second] = (pair.wins, pair.ties, pair.losses)
        found[pair.second, pair.first] = (pair.losses, pair.ties, pair.wins)
    table = plain_table("better places – ties – worse places, of the row against the column")
    table.add_column("", min_width=10)
    add_columns(table, *(str(number) for number in range(1, len(names) + 1)))
    for place, name in enumerate(names, start=1):
        cells = [
            ""
            if name == other
            else "–".join(map(str, found[name, other]))
            if (name, other) in found
            else NOTHING
            for other in names
        ]
        table.add_row(f"{place} {name}", *cells)
    return table


def letters(number: int) -> str:
    """Return the letter of a band, which is numbered from 1: a to z, then z2 and so on."""
    return chr(ord("a") + number - 1) if number <= LETTERS else f"z{number - LETTERS + 1}"


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


LIMITS: dict[str, Callable[[Any], str]] = {
    "cpus": lambda cores: f"{cores:g} {'core' if cores == 1 else 'cores'}",
    "memory": lambda size: f"{_size(size)} of memory",
    "processes": lambda count: f"{count:,} processes",
    "open_files": lambda count: f"{count:,} open files",
    "tmp_size": lambda size: f"{_size(size)} in /tmp",
    "output": lambda size: f"{_size(size)} of output",
    "wall_clock": lambda seconds: f"matches of {seconds:,g} s at most",
}


def limits_in_words(limits: KeptLimits) -> str:
    """Return limits in one line, without those that the sandbox does not enforce."""
    return ", ".join(LIMITS[name](value) for name, value in limits if value is not None)


def _size(count: int) -> str:
    """Return a number of bytes in a unit that makes it round, if there is one."""
    for unit, name in UNITS:
        if count % unit == 0:
            return f"{count // unit:,} {name}"
    return f"{count / 1e6:,g} MB" if count % 1000 == 0 else f"{count:,} bytes"


def evaluation_actions_note(evaluation: Evaluation) -> str | None:
    """Return a line about a submission's invalid actions on one track, or None if there were none."""
    seats = [seat for row in evaluation.matches for seat in row.seats]
    return invalid_actions_note(
        f"{evaluation.submission} on {evaluation.track}",
        actions=sum(seat.actions for seat in seats),
        invalid=sum(seat.invalid_actions for seat in seats),
    )


def evaluation_waits_note(evaluation: Evaluation, timings: Iterable[MatchTiming]) -> str | None:
    """Return a line about a submission's waits for a processor on a track; None if none were credited."""
    credited = [seat.credited or 0.0 for timing in timings for seat in timing.seats]
    return waits_note(f"{evaluation.submission} on {evaluation.track}", credited)


def waits_note(who: str, credited: Sequence[float]) -> str | None:
    """Return a line about the waits for a processor that were credited to some seats, s; None without any."""
    if not any(credited):
        return None
    return (
        f"{who}: the machine was so busy that the agent waited for a processor; its time banks did not pay "
        f"{sum(credited):.1f} s of that, at most {max(credited):.1f} s in a match"
    )


def invalid_actions_note(who: str, *, actions: int, invalid: int) -> str | None:
    """Return a line about an agent's actions of which a number was out of its range; None without any."""
    if not invalid:
        return None
    return (
        f"{who}: {invalid:,} of {counted(actions, 'action')} {'was' if invalid == 1 else 'were'} invalid and "
        f"played as no action (walk_speed must be 0 to {MAX_WALK_SPEED:g} m/s, every angle a finite number)"
    )
