"""The table of the changes since the last evaluation of the same submissions."""

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from wildscav_evaluator.cli.result_tables.ranking import add_columns, plain_table
from wildscav_evaluator.output.numbered_folders import number_of
from wildscav_evaluator.scores.changes import Change
from wildscav_evaluator.scores.compare import FEWEST_PAIRS, Comparison
from wildscav_evaluator.scores.number_format import number, signed


def changes_table(since: Sequence[Change]) -> Table:
    """Return the table: one line per submission and track, with its score."""
    table = plain_table("since last time")
    table.add_column("track", no_wrap=True, vertical="bottom")
    table.add_column("agent", min_width=7, vertical="bottom")
    add_columns(table, "since", "before", "now", "change", "95 %\ninterval")
    table.add_column("", vertical="bottom", min_width=8)
    for one in since:
        score = one.comparison.differences[0]
        table.add_row(
            f"{one.comparison.track} {'↓' if score.metric.lower_is_better else '↑'}",
            one.comparison.first,
            f"{number_of(Path(one.folder)):04} {one.version}",
            number(score.second, score.metric),
            number(score.first, score.metric),
            signed(score.difference, score.metric),
            f"{signed(score.low, score.metric)} to {signed(score.high, score.metric)}",
            verdict(one.comparison),
        )
    return table


def verdict(one: Comparison) -> Text:
    """Return in a few words whether a score has changed by more than chance explains."""
    score = one.differences[0]
    if score.difference == score.low == score.high == 0.0:
        return Text("no change")
    match one.verdict:
        case "first":
            return Text("better", "green")
        case "second":
            return Text("worse", "red")
        case "tied":
            return Text("within the noise", "yellow")
        case _:
            return Text(f"too few: {one.pairs} of {FEWEST_PAIRS} matches", "yellow")
