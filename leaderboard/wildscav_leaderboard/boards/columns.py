"""The columns of boards: pages and ``wildscav leaderboard --season`` show these, in this order."""

from collections.abc import Callable
from typing import Any, Literal, NamedTuple

from wildscav.terminal.console import counted
from wildscav_evaluator.output.results import MetricInfo
from wildscav_evaluator.scores.number_format import number
from wildscav_leaderboard.boards.documents import BoardDocument, LadderBoard


class Column(NamedTuple):
    """A column between a row's team and its submission."""

    title: str
    text: Callable[[Any], str]  # of a row; empty if there is nothing to show
    kind: Literal["main", "interval", "figure", "faults"] = "figure"
    metric: MetricInfo | None = None  # whose mean it shows
    note: Callable[[Any], str] = lambda _: ""  # stands beside the text


def columns_of(board: BoardDocument) -> tuple[Column, ...]:
    """Return the columns of a board."""
    if isinstance(board, LadderBoard):
        return (*OF_LADDERS, *OF_ALL)
    score, *others = board.metrics
    return (
        _of_metric(score, "main"),
        Column("95 % interval", lambda row: _ends(row, score), "interval"),
        *(_of_metric(metric) for metric in others),
        *OF_ALL,
    )


def _of_metric(metric: MetricInfo, kind: Literal["main", "figure"] = "figure") -> Column:
    def text(row: Any) -> str:
        return number(row.metrics[metric.name].mean, metric) if metric.name in row.metrics else ""

    return Column(f"{metric.title}, {metric.unit}" if metric.unit else metric.title, text, kind, metric)


def _ends(row: Any, score: MetricInfo) -> str:
    found = row.metrics.get(score.name)
    return "" if found is None else f"{number(found.low, score)}–{number(found.high, score)}"


def _rated(text: Callable[[Any], str]) -> Callable[[Any], str]:
    """Return nothing before the first match: the rating with which all begin says nothing."""
    return lambda row: "" if row.rank is None else text(row)


OF_LADDERS = (
    Column(
        "rating",
        _rated(lambda row: f"{row.rating:,.0f}"),
        "main",
        note=_rated(lambda row: f"± {row.deviation:,.0f}" if row.is_measured else ""),
    ),
    Column(
        "95 % interval",
        _rated(
            lambda row: (
                f"{row.low:,.0f}–{row.high:,.0f}" if row.is_measured else counted(row.matches, "match")
            )
        ),
        "interval",
        note=_rated(lambda row: "provisional" if row.provisional else ""),
    ),
    Column("mean place", lambda row: "" if row.mean_place is None else f"{row.mean_place:.2f}"),
    Column("wins", lambda row: str(row.wins)),
)
OF_ALL = (
    Column(
        "matches",
        lambda row: f"{row.matches} of {row.planned}" if row.matches < row.planned else str(row.matches),
    ),
    Column("faults", lambda row: str(row.faults), "faults"),
)
