"""The command ``wildscav leaderboard``."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table
from wildscav.console import console
from wildscav.errors import UserError

if TYPE_CHECKING:
    from wildscav_evaluator.results import MetricInfo

    from wildscav_leaderboard.models import Score
    from wildscav_leaderboard.standings import Row, Standings


def leaderboard(
    db: Annotated[Path, typer.Option(help="The leaderboard's database.")] = Path("out/wildscav.db"),
    track: Annotated[str | None, typer.Option(help="Only this track.")] = None,
    suite: Annotated[str | None, typer.Option(help="Only this suite.")] = None,
) -> None:
    """Show the standings on every track: the latest evaluation of each submission."""
    from wildscav_leaderboard.database import reading
    from wildscav_leaderboard.standings import standings

    with reading(db) as session:
        tables = [_table(one) for one in standings(session, track, suite)]
    if not tables:
        wanted = "".join(f" of {what} {name}" for what, name in (("track", track), ("suite", suite)) if name)
        raise UserError(f"there are no evaluations{wanted} in {db}: `wildscav evaluate` puts them there")
    for table in tables:
        console.print(table)
        console.print()


def _table(one: "Standings") -> Table:
    from wildscav_evaluator.tables import heading

    table = Table(
        title=f"{one.track} · suite {one.suite} · seed {one.seed}", title_justify="left", title_style="bold"
    )
    # Rows without a score come last, so the first row knows the metrics if any row does.
    scores = one.rows[0].evaluation.scores
    table.add_column("rank", justify="right")
    table.add_column("submission")
    for score in scores:
        table.add_column(heading(_metric(score)), justify="right")
    for title in ("matches", "failures", "evaluated"):
        table.add_column(title, justify="right")
    for row in one.rows:
        table.add_row(*_cells(row, len(scores)))
    return table


def _cells(row: "Row", metrics: int) -> Iterator[str]:
    from wildscav_evaluator.results import Summary
    from wildscav_evaluator.tables import summary_text

    evaluation = row.evaluation
    yield "-" if row.rank is None else str(row.rank)
    yield f"{evaluation.submission.name} {evaluation.submission.version}"
    for score in evaluation.scores:
        summary = Summary(mean=score.mean, std=score.std, low=score.low, high=score.high)
        yield summary_text(summary, _metric(score), with_interval=score.position == 0)
    yield from ["-"] * (metrics - len(evaluation.scores))
    yield str(len(evaluation.matches))
    yield str(evaluation.faults)
    yield f"{evaluation.started:%Y-%m-%d %H:%M}"


def _metric(score: "Score") -> "MetricInfo":
    from wildscav_evaluator.results import MetricInfo

    return MetricInfo(
        name=score.name, title=score.title, unit=score.unit, lower_is_better=score.lower_is_better
    )
