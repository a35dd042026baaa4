"""What an evaluation shows: progress, tables, the paths of its files, and errors."""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from rich.text import Text

from wildscav.errors import UserError, describe
from wildscav.terminal.console import command, console, counted, print_json
from wildscav_engine.record import SUFFIX
from wildscav_evaluator.cli.result_tables.changes import changes_table
from wildscav_evaluator.cli.result_tables.ranking import LEGEND, ranked, track_table
from wildscav_evaluator.cli.result_tables.timing import sandbox_and_limits, timing_table
from wildscav_evaluator.cli.sessions.errors import raise_errors
from wildscav_evaluator.cli.sessions.playing import playing, say, say_ledger
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.layout import LOGS, RECORDS, REPLAYS, RESULTS_FILE
from wildscav_evaluator.output.results import Evaluation, Results, write_results
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.result_sinks import ResultSink, sinks
from wildscav_evaluator.scores.changes import Change, changes_since_last
from wildscav_evaluator.scores.notes import evaluation_actions_note, evaluation_waits_note

DASHBOARD_ONLY = MonitorOptions()


def run_session(
    plan: EvaluationPlan,
    database: Path,
    options: MonitorOptions = DASHBOARD_ONLY,
    executor: Executor | None = None,
    *,
    as_json: bool = False,
) -> None:
    """Evaluate, and show and save the results.

    Args:
        plan: What to evaluate.
        database: The leaderboard's database.
        options: How to show the progress.
        executor: Where to play; processes on this machine if None.
        as_json: Whether to print a JSON document as well.

    Raises:
        UserError: Nothing could be evaluated; or, after everything else was shown and saved, something could
            not be saved or a submission failed in all its matches.
    """
    kept_by = tuple(sinks(str(database)))
    for sink in kept_by:
        sink.check()
    with playing(plan, options, executor) as (results, ledger):
        # Written before anything is shown, so that closing the terminal loses nothing.
        errors = list(_written(results, plan.out, ledger))
        since = changes_since_last(results, plan.out)
        _show(results, since)
        if as_json:
            print_json(document(results, plan.out, since))
        if not errors:
            say("results", str(plan.out / RESULTS_FILE))
            say_ledger(plan, ledger)
        errors += _keep(results, plan, kept_by, database)
        errors += [all_failed(one, plan.out) for one in results.evaluations if one.faults == len(one.matches)]
    raise_errors(errors)


def show_notes(results: Results) -> None:
    """Print which submissions sent invalid actions, and which late steps are not their fault."""
    lines = [line for one in results.evaluations if (line := evaluation_actions_note(one))]
    lines += [
        line for one in results.evaluations if (line := evaluation_waits_note(one, results.timings_of(one)))
    ]
    if lines:
        console.print()
    for line in lines:
        console.print(Text.assemble(("note: ", "yellow"), line))


def _written(results: Results, out: Path, ledger: LedgerWriter) -> Iterator[str]:
    """Write the results, close the ledger with them, and yield the errors."""
    try:
        ledger.close(results, write_results(results, out))
    except OSError as error:
        yield f"the results could not be saved: {describe(error)}"
    except UserError as error:  # raised by the ledger
        yield str(error)


def document(results: Results, out: Path, since: Sequence[Change]) -> dict[str, object]:
    """Return what ``wildscav evaluate --json`` prints."""
    return {
        "folder": str(out),
        "results": results.as_json(),
        "since_last": [one.as_json() for one in since],
    }


def _show(results: Results, since: Sequence[Change] = ()) -> None:
    """Print the tables, notes on invalid actions and late steps, and the sandbox."""
    for track in results.tracks:
        console.print()
        console.print(track_table(results, track))
    console.print(f"\n{LEGEND}\n", style="dim")
    if since:
        console.print(changes_table(since))
        console.print()
    console.print(timing_table(results))
    show_notes(results)
    console.print()
    for position, line in enumerate(sandbox_and_limits(results.sandbox, results.limits)):
        say("" if position else "sandbox", line)


def _keep(
    results: Results, plan: EvaluationPlan, kept_by: Iterable[ResultSink], database: Path
) -> Iterator[str]:
    """Store the results in the sinks, print where everything is, and yield the errors."""
    rows = [row for one in results.evaluations for row in one.matches]
    recorded = sum(row.record is not None for row in rows)
    say("records", f"{plan.out / RECORDS} ({counted(recorded, 'match')})")
    say("", f"check them: {command('wildscav')} verify {plan.out / RECORDS}/*{SUFFIX}")
    for sink in kept_by:
        try:
            say("database", sink.store(results))
            say("", f"standings: {command('wildscav')} leaderboard --db {database}")
        except UserError as error:
            yield str(error)
    if any(row.logs for row in rows):
        say("logs", f"{plan.out / LOGS} (what the agents printed)")
    replays = sum(row.replay is not None for row in rows)
    if replays:
        say("replays", f"{plan.out / REPLAYS} ({counted(replays, 'match')}), to watch in Rerun")
    shown = _replay_to_show(results)
    if shown is not None:
        say("", f"watch one: {command('rerun')} {plan.out / shown}")


def _replay_to_show(results: Results) -> str | None:
    """Return the replay to suggest: that of the best agent on the last track, the most eventful one."""
    for track in reversed(results.tracks):
        for _, one in ranked(one for one in results.evaluations if one.track == track):
            for row in one.matches:
                if row.replay is not None:
                    return row.replay
    return None


def all_failed(evaluation: Evaluation, out: Path) -> str:
    """Return the error that a submission, or the platform, failed in every match of a track, and why."""
    first = evaluation.matches[0]
    if all(row.fault == "platform" for row in evaluation.matches):
        return f"no match of {evaluation.track} could be played for {evaluation.submission}: {first.detail}"
    # The log of the seat that failed, which need not be the first.
    log = next((seat.log for seat in first.seats if seat.fault is not None), None)
    see = f" (its log: {out / log})" if log else ""
    return f"{evaluation.submission} failed in every match of {evaluation.track}: {first.detail}{see}"
