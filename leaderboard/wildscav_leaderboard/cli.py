"""The command ``wildscav leaderboard``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from wildscav.cli.json_option import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from wildscav_evaluator.output.results import MetricInfo, Summary
    from wildscav_leaderboard.models import Score
    from wildscav_leaderboard.standings import Standings


def leaderboard(
    db: Annotated[Path, typer.Option(help="The leaderboard's database.")] = Path("out/wildscav.db"),
    track: Annotated[
        str | None, typer.Option(help="Only this track, or tracks whose names begin with this.")
    ] = None,
    suite: Annotated[
        str | None,
        typer.Option(help="Only this suite; spring also finds your own suite spring@19da5d55."),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Show the standings on every track: the latest evaluation of each submission."""
    from wildscav_evaluator.cli.result_tables.ranking import LEGEND
    from wildscav_leaderboard.database import reading
    from wildscav_leaderboard.standings import standings
    from wildscav_leaderboard.standings_json import document

    with reading(db) as session:
        found = list(standings(session, track, suite))
        tables = [(_table(one), _conditions(one), _versions(one), _signed(one)) for one in found]
        documents = [document(one) for one in found]
        if not found:
            raise UserError(_nothing_found(list(standings(session)), track, suite, db))
    if as_json:
        print_json({"standings": documents})
    for table, conditions, versions, signed in tables:
        console.print(table)
        for text in (
            f"played in {conditions}",
            f"played by {versions}",
            f"signed: {signed or 'none'}\n",
        ):
            console.print(text, soft_wrap=True, highlight=False)
    console.print(LEGEND, style="dim")


def _nothing_found(everything: "list[Standings]", track: str | None, suite: str | None, db: Path) -> str:
    """Return why there is no table, with a suggestion of a similar name."""
    from wildscav_leaderboard.standings import is_meant

    for what, asked, known in (
        ("track", track, dict.fromkeys(one.track for one in everything)),
        ("suite", suite, dict.fromkeys(one.suite for one in everything)),
    ):
        if asked is not None and known and not any(is_meant(asked, name) for name in known):
            near = did_you_mean(asked, known)
            return f"there are no evaluations of {what} {asked}{near} in {db}; it has {', '.join(known)}"
    wanted = "".join(f" of {what} {name}" for what, name in (("track", track), ("suite", suite)) if name)
    return f"there are no evaluations{wanted} in {db}: `wildscav evaluate` stores them there"


def _table(one: "Standings") -> Table:
    from wildscav_evaluator.cli.result_tables import ranking
    from wildscav_evaluator.scores.number_format import NOTHING

    table = ranking.ranking_table(f"{one.track} · suite {one.suite} · seed {one.seed}")
    # Rows without a score come last, so the first row has the metrics if any row does.
    metrics = [_metric(score) for score in one.rows[0].evaluation.scores]
    ranking.add_metrics(table, metrics)
    ranking.add_columns(table, "matches\nfailed", "date")
    for row in one.rows:
        evaluation = row.evaluation
        table.add_row(
            NOTHING if row.rank is None else str(row.rank),
            f"{evaluation.submission.name} {evaluation.submission.version}",
            *ranking.metric_cells(metrics, {score.name: _summary(score) for score in evaluation.scores}),
            ranking.fault_cell(evaluation.faults, len(evaluation.matches)),
            f"{evaluation.started:%Y-%m-%d}",
        )
    return table


def _versions(one: "Standings") -> str:
    """Return in one line the versions with which a table's matches were played."""
    from wildscav_leaderboard.models import UNKNOWN_VERSION

    parts = {
        "simulation": one.simulation_version,
        "generator": one.generator_version,
        "records": one.record_version,
    }
    known = [f"{name} {'unknown' if number == UNKNOWN_VERSION else number}" for name, number in parts.items()]
    return ", ".join([f"engine {one.engine_version}", *known])


def _signed(one: "Standings") -> str:
    """Return in one line whose ledgers are signed, and with which key."""
    by_key: dict[str, list[str]] = {}
    for row in one.rows:
        if row.evaluation.key is not None:
            by_key.setdefault(row.evaluation.key, []).append(row.evaluation.submission.name)
    return "; ".join(
        f"{'all' if len(names) == len(one.rows) else ', '.join(names)} with the key {key}"
        for key, names in by_key.items()
    )


def _conditions(one: "Standings") -> str:
    """Return in one line the sandbox and the limits of the agents."""
    from wildscav_evaluator.cli.result_tables.timing import sandbox_and_limits
    from wildscav_evaluator.output.results import KeptLimits

    limits = KeptLimits.model_validate_json(one.limits)
    kept = {one.track: limits} if limits != KeptLimits() else {}
    return "".join(sandbox_and_limits(one.sandbox, kept))


def _metric(score: "Score") -> "MetricInfo":
    from wildscav_evaluator.output.results import MetricInfo

    return MetricInfo(
        name=score.name, title=score.title, unit=score.unit, lower_is_better=score.lower_is_better
    )


def _summary(score: "Score") -> "Summary":
    from wildscav_evaluator.output.results import Summary

    return Summary(mean=score.mean, std=score.std, low=score.low, high=score.high)
