"""What ``wildscav leaderboard`` shows of the results in folders."""

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from rich.table import Table

from wildscav.errors import UserError
from wildscav.terminal.console import console, error_console, print_json
from wildscav.terminal.suggestions import did_you_mean
from wildscav_evaluator.cli import result_tables
from wildscav_evaluator.cli.result_tables import legend, sandbox_and_limits, standings_table
from wildscav_evaluator.output.results import KeptLimits, Results, of_clock
from wildscav_evaluator.scores.leaderboard import (
    Conditions,
    Found,
    Standings,
    document,
    document_of_overall,
    find_results,
    is_meant,
    latest_tournaments,
    overall_standings,
    standings,
)
from wildscav_evaluator.tournaments.tournament_file import Tournament


def show_standings(
    places: Sequence[Path], track: str | None = None, suite: str | None = None, *, as_json: bool = False
) -> None:
    """Print the standings and the latest tournaments of the results in some files and folders.

    UserError if a place does not exist or is not readable, or there is nothing of the track and the suite.
    """
    with error_console.status("reading results"):
        results = find_results(places)
    for line in results.unreadable:
        error_console.print(f"left out: {line}")
    ranked_tables = list(standings(results.evaluations, track, suite))
    rated = latest_tournaments(results, track, suite)
    if not ranked_tables and not rated:
        raise UserError(_nothing_found(results, track, suite, ", ".join(map(str, places))))
    across = list(overall_standings(results.evaluations, suite)) if track is None else []
    if as_json:
        documents = {
            "standings": [document(one) for one in ranked_tables],
            "overall": [document_of_overall(one) for one in across],
            "tournaments": [one.as_json() for one in rated],
        }
        print_json(documents)
    for one in ranked_tables:
        _show(one)
    if ranked_tables:
        console.print(result_tables.LEGEND, style="dim")
    for each in across:
        shared = each.conditions
        title = (
            f"suite {shared.suite} · seed {shared.seed_label}{_rounds(shared.rounds)}{of_clock(shared.clock)}"
        )
        console.print()
        console.print(result_tables.overall_table(title, each.rows))
        _say_conditions(shared, shared.limits)
        console.print()
        console.print(result_tables.OVERALL_LEGEND, style="dim")
    for tournament in rated:
        _show_tournament(tournament)


def _show(one: Standings) -> None:
    conditions = one.conditions
    kept = {} if conditions.limits == KeptLimits() else {conditions.track: conditions.limits}
    console.print(evaluations_table(one))
    _say_conditions(conditions, kept)
    days = (f"on {row.started[: len('2030-01-01')]}" for row in one.rows)
    console.print(f"started: {_grouped(one, days)}")
    keys = (None if row.key is None else f"with the key {row.key}" for row in one.rows)
    console.print(f"signed: {_grouped(one, keys) or 'none'}\n")


def _show_tournament(one: Tournament) -> None:
    """Print the standings of a tournament."""
    console.print()
    console.print(standings_table(one))
    _say_conditions(one, {one.track: one.limits})
    console.print()
    console.print(legend(one), style="dim")


def _say_conditions(shared: Conditions | Results | Tournament, limits: Mapping[str, KeptLimits]) -> None:
    """Print where something was played, with which model, and by which versions."""
    for line in sandbox_and_limits(shared.sandbox, limits):
        console.print(f"played in {line}")
    if shared.model is not None:
        console.print(f"model: {shared.model}")
    console.print(f"played by {shared.versions}")


def evaluations_table(one: Standings) -> Table:
    """Return the table of comparable evaluations on one track: the submissions from best to worst."""
    shared = one.conditions
    title = f"{shared.track} · suite {shared.suite} · seed {shared.seed}{_rounds(shared.rounds)}"
    table = result_tables.ranking_table(f"{title}{of_clock(shared.clock)}")
    result_tables.add_metrics(table, one.rows[0].evaluation.metrics)
    result_tables.add_columns(table, "matches\nfailed")
    for row in one.rows:
        table.add_row(*result_tables.evaluation_cells(row.rank, row.evaluation))
    return table


def _rounds(rounds: int) -> str:
    return "" if rounds == 1 else f" · {rounds} rounds"


def _grouped(one: Standings, texts: Iterable[str | None]) -> str:
    """Return in one line what each row has, such as its date, with the names of those that have the same."""
    having: dict[str, list[str]] = {}
    for row, text in zip(one.rows, texts, strict=True):
        if text is not None:
            having.setdefault(text, []).append(row.evaluation.title)
    return "; ".join(
        f"{'all' if len(names) == len(one.rows) else ', '.join(names)} {text}"
        for text, names in having.items()
    )


def _nothing_found(results: Found, track: str | None, suite: str | None, places: str) -> str:
    """Return why there is no table, with a suggestion of a similar name."""
    everything = [one.conditions for one in standings(results.evaluations)]
    for what, asked, known in (
        ("track", track, dict.fromkeys(one.track for one in everything)),
        ("suite", suite, dict.fromkeys(one.suite for one in everything)),
    ):
        if asked is not None and known and not any(is_meant(asked, name) for name in known):
            near = did_you_mean(asked, known)
            return f"there are no evaluations of {what} {asked}{near} in {places}; it has {', '.join(known)}"
    wanted = "".join(f" of {what} {name}" for what, name in (("track", track), ("suite", suite)) if name)
    return f"there are no evaluations{wanted} in {places}: `wildscav evaluate` makes them"
