"""The command ``wildscav leaderboard``."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer
from rich.table import Table

from wildscav.cli.shared_options import AsJson
from wildscav.errors import UserError
from wildscav.terminal.console import console, print_json
from wildscav.terminal.suggestions import did_you_mean

if TYPE_CHECKING:
    from wildscav_evaluator.tournaments.tournament_file import Tournament
    from wildscav_leaderboard.results.standings import Standings


Url = Annotated[
    str | None,
    typer.Argument(
        help="With --season: its address. Default: the one that you logged in to last.",
        metavar="URL",
        show_default=False,
    ),
]
OfSeason = Annotated[
    bool, typer.Option("--season", help="Show the boards of a season, in place of a database.")
]
DatabaseFile = Annotated[Path, typer.Option(help="The leaderboard's database.")]
Track = Annotated[str | None, typer.Option(help="Only this track, or tracks whose names begin with this.")]
SuiteName = Annotated[
    str | None, typer.Option(help="Only this suite; spring also finds your own suite spring@19da5d55.")
]


def leaderboard(
    url: Url = None,
    season: OfSeason = False,
    db: DatabaseFile = Path("out/wildscav.db"),
    track: Track = None,
    suite: SuiteName = None,
    as_json: AsJson = False,
) -> None:
    """Show the standings on every track: the latest evaluation of each submission, and tournaments.

    With --season, show the boards of a season; no account is needed for that.
    """
    if season or url is not None:
        from wildscav_leaderboard.competing.boards import show_boards

        if url is not None and Path(url).exists():
            raise UserError(f"{url} is a file: name a database with --db {url}", exit_code=2)
        if suite is not None:
            raise UserError("--suite is for a database: a season has one suite on each track", exit_code=2)
        show_boards(url, track, as_json=as_json)
    else:
        _show_database(db, track, suite, as_json=as_json)


def _show_database(db: Path, track: str | None, suite: str | None, *, as_json: bool) -> None:
    """Show the standings and the tournaments in a database."""
    from wildscav_evaluator.cli.result_tables.ranking import LEGEND
    from wildscav_evaluator.tournaments.tournament_file import Tournament
    from wildscav_leaderboard.results.database import reading
    from wildscav_leaderboard.results.standings import document, standings, tournaments

    with reading(db) as session:
        found = list(standings(session, track, suite))
        tables = [(_table(one), _conditions(one), _versions(one), _signed(one)) for one in found]
        documents = [document(one) for one in found]
        rated = [Tournament.model_validate(one.document) for one in tournaments(session, track, suite)]
        if not found and not rated:
            raise UserError(_nothing_found(list(standings(session)), track, suite, db))
    if as_json:
        print_json({"standings": documents, "tournaments": [one.as_json() for one in rated]})
    for table, conditions, versions, signed in tables:
        console.print(table)
        console.print(f"played in {conditions}", soft_wrap=True)
        console.print(f"played by {versions}", soft_wrap=True)
        console.print(f"signed: {signed or 'none'}\n", soft_wrap=True)
    if tables:
        console.print(LEGEND, style="dim")
    for one in rated:
        _show_tournament(one)


def _show_tournament(one: "Tournament") -> None:
    """Print the standings of a tournament."""
    from wildscav_evaluator.cli.result_tables.standings import legend, standings_table
    from wildscav_evaluator.cli.result_tables.timing import sandbox_and_limits

    console.print()
    console.print(standings_table(one))
    for line in sandbox_and_limits(one.sandbox, {one.track: one.limits}):
        console.print(f"played in {line}", soft_wrap=True)
    console.print(f"played by {one.versions}\n", soft_wrap=True)
    console.print(legend(one), style="dim")


def _nothing_found(everything: "list[Standings]", track: str | None, suite: str | None, db: Path) -> str:
    """Return why there is no table, with a suggestion of a similar name."""
    from wildscav_leaderboard.results.standings import is_meant

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
    from wildscav_evaluator.output.results import MetricInfo, Summary
    from wildscav_evaluator.scores.number_format import NOTHING

    table = ranking.ranking_table(f"{one.track} · suite {one.suite} · seed {one.seed}")
    # Rows without a score come last, so the first row has the metrics if any row does.
    metrics = [MetricInfo.about(score) for score in one.rows[0].evaluation.scores]
    ranking.add_metrics(table, metrics)
    ranking.add_columns(table, "matches\nfailed", "date")
    for row in one.rows:
        evaluation = row.evaluation
        table.add_row(
            NOTHING if row.rank is None else str(row.rank),
            f"{evaluation.submission.name} {evaluation.submission.version}",
            *ranking.metric_cells(metrics, {score.name: Summary.about(score) for score in evaluation.scores}),
            ranking.fault_cell(evaluation.faults, len(evaluation.matches)),
            f"{evaluation.started:%Y-%m-%d}",
        )
    return table


def _versions(one: "Standings") -> str:
    """Return in one line the versions with which a table's matches were played."""
    from wildscav_leaderboard.results.models import UNKNOWN_VERSION

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
