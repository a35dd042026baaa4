"""What a tournament shows and saves: progress, standings, the paths of its files, and errors."""

from pathlib import Path

from wildscav.terminal.console import console, print_json
from wildscav_evaluator.cli.result_tables import (
    MAX_OPPONENTS,
    legend,
    pairs_table,
    standings_table,
    timing_table,
)
from wildscav_evaluator.cli.sessions.evaluate import show_notes, total_failures
from wildscav_evaluator.cli.sessions.playing import playing, raise_errors, saving_errors, say, say_files
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.layout import STANDINGS_PICTURE, TOURNAMENT_FILE
from wildscav_evaluator.output.results import Results
from wildscav_evaluator.plans.tournament import TournamentPlan
from wildscav_evaluator.ratings.picture import draw_standings
from wildscav_evaluator.tournaments.tournament_file import Tournament, tournament_of


def run_tournament(
    plan: TournamentPlan,
    options: MonitorOptions,
    executor: Executor | None = None,
    *,
    as_json: bool = False,
) -> None:
    """Play a tournament, and show and save its standings. Errors: see ``run_session``."""
    with playing(plan, options, executor) as (results, ledger):
        tournament = tournament_of(results)
        # Written before anything is shown, so that closing the terminal loses nothing.
        errors = saving_errors(results, plan.out, ledger, lambda: _write_ratings(tournament, plan.out))
        _show(tournament, results)
        if as_json:
            document = {"folder": str(plan.out), "tournament": tournament.as_json()}
            print_json(document | {"results": results.as_json()})
        if not errors:
            say("standings", str(plan.out / TOURNAMENT_FILE))
            if (plan.out / STANDINGS_PICTURE).exists():
                say("", f"drawn in {plan.out / STANDINGS_PICTURE}")
            say_files(plan, ledger, results)
        errors += total_failures(results, plan.out)
    raise_errors(errors)


def show_ratings(tournament: Tournament) -> None:
    """Print the standings, who cannot be told apart, and who won against whom."""
    console.print(standings_table(tournament))
    console.print(f"\n{legend(tournament)}\n", style="dim")
    if len(tournament.ratings.standings) <= MAX_OPPONENTS:
        console.print(pairs_table(tournament))
        console.print()


def _show(tournament: Tournament, results: Results) -> None:
    """Print the ratings, and how the agents used their time."""
    console.print()
    show_ratings(tournament)
    times = timing_table(results)
    if times.rows:  # there are none if all entrants are robots
        console.print(times)
    show_notes(results)


def _write_ratings(tournament: Tournament, out: Path) -> None:
    tournament.write(out / TOURNAMENT_FILE)
    if tournament.ratings.standings:
        draw_standings(tournament.ratings, tournament.title, out / STANDINGS_PICTURE)
