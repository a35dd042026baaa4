"""Readable tables of results, narrow enough for a terminal of 80 columns."""

from collections.abc import Iterable, Iterator
from textwrap import wrap

from rich.table import Table
from rich.text import Text

from wildscav.terminal.tables import FittingTable
from wildscav_evaluator.output.results import Evaluation, MetricInfo, Results, Summary
from wildscav_evaluator.scores.leaderboard import ranked
from wildscav_evaluator.scores.number_format import NOTHING, number

HEADING_WIDTH = 8
LEGEND = "↓ lower is better, ↑ higher is better. The first metric decides the rank."


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
    yield f"{one.submission} {one.version}"
    yield from metric_cells(one.metrics, one.summary)
    yield fault_cell(one.faults, len(one.matches))


def plain_table(title: str) -> Table:
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
