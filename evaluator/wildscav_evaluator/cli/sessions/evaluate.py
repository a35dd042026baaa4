"""What an evaluation shows: progress, tables, the paths of its files, and errors."""

from collections.abc import Sequence
from pathlib import Path

from rich.table import Table
from rich.text import Text

from wildscav.terminal.console import console, print_json
from wildscav_evaluator.cli.result_tables import (
    LEGEND,
    OVERALL_LEGEND,
    add_columns,
    evaluation_actions_note,
    evaluation_waits_note,
    overall_table,
    plain_table,
    sandbox_and_limits,
    timing_table,
    track_table,
)
from wildscav_evaluator.cli.sessions.playing import (
    playing,
    print_note,
    raise_errors,
    saving_errors,
    say,
    say_files,
)
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.monitoring.monitor import MonitorOptions
from wildscav_evaluator.output.numbered_folders import number_of
from wildscav_evaluator.output.results import Evaluation, Results
from wildscav_evaluator.plans.evaluation import EvaluationPlan
from wildscav_evaluator.scores.compare import FEWEST_PAIRS, Change, Comparison, changes_since_last
from wildscav_evaluator.scores.leaderboard import ranked, ranked_overall
from wildscav_evaluator.scores.number_format import number, signed

DASHBOARD_ONLY = MonitorOptions()


def run_session(
    plan: EvaluationPlan,
    options: MonitorOptions = DASHBOARD_ONLY,
    executor: Executor | None = None,
    *,
    as_json: bool = False,
) -> None:
    """Evaluate, and show and save the results.

    Without an executor, matches are played in processes on this machine. UserError if nothing could be
    evaluated or, after everything else was shown and saved, if something could not be saved or a submission
    failed in all its matches.
    """
    with playing(plan, options, executor) as (results, ledger):
        # Written before anything is shown, so that closing the terminal loses nothing.
        errors = saving_errors(results, plan.out, ledger)
        since = changes_since_last(results, plan.out)
        _show(results, since)
        if as_json:
            print_json(document(results, plan.out, since))
        if not errors:
            say_files(plan, ledger, results, _replay_to_show(results))
        errors += total_failures(results, plan.out)
    raise_errors(errors)


def show_notes(results: Results) -> None:
    """Print who sent invalid actions, which late steps are not the agents' fault, and the sandbox."""
    lines = [line for one in results.evaluations if (line := evaluation_actions_note(one))]
    lines += [
        line for one in results.evaluations if (line := evaluation_waits_note(one, results.timings_of(one)))
    ]
    if lines:
        console.print()
    for line in lines:
        print_note(line)
    console.print()
    for position, line in enumerate(sandbox_and_limits(results.sandbox, results.limits)):
        label = "" if position else "sandbox"
        console.print(f"{label:<9} {line}", soft_wrap=not console.is_terminal)
    if results.model is not None:
        say("model", str(results.model))


def document(results: Results, out: Path, since: Sequence[Change]) -> dict[str, object]:
    """Return what ``wildscav evaluate --json`` prints."""
    return {
        "folder": str(out),
        "results": results.as_json(),
        "since_last": [one.as_json() for one in since],
    }


def _show(results: Results, since: Sequence[Change] = ()) -> None:
    """Print the tables, notes on invalid actions and late steps, and the sandbox."""
    show_scores(results)
    if since:
        console.print(changes_table(since))
        console.print()
    console.print(timing_table(results))
    show_notes(results)


def show_scores(results: Results) -> None:
    """Print the table of each track, and the one across tracks if there is any."""
    for track in results.tracks:
        console.print()
        console.print(track_table(results, track))
    console.print(f"\n{LEGEND}\n", style="dim")
    if results.overall:
        title = f"suite {results.suite} · seed {results.seed_label}"
        console.print(overall_table(title, ranked_overall(results.overall)))
        console.print(f"\n{OVERALL_LEGEND}\n", style="dim")


def _replay_to_show(results: Results) -> str | None:
    """Return the replay to suggest: that of the best agent on the last track, the most eventful one."""
    for track in reversed(results.tracks):
        for _, one in ranked(one for one in results.evaluations if one.track == track):
            for row in one.matches:
                if row.replay is not None:
                    return row.replay
    return None


def total_failures(results: Results, out: Path) -> list[str]:
    """Return an error for every submission that failed in all its matches of a track."""
    return [all_failed(one, out) for one in results.evaluations if one.faults == len(one.matches)]


def all_failed(evaluation: Evaluation, out: Path) -> str:
    """Return the error that a submission, or the platform, failed in every match of a track, and why."""
    first = evaluation.matches[0]
    if all(row.fault == "platform" for row in evaluation.matches):
        return f"no match of {evaluation.track} could be played for {evaluation.submission}: {first.detail}"
    # The log of the seat that failed, which need not be the first.
    log = next((seat.log for seat in first.seats if seat.fault is not None), None)
    see = f" (its log: {out / log})" if log else ""
    return f"{evaluation.submission} failed in every match of {evaluation.track}: {first.detail}{see}"


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
