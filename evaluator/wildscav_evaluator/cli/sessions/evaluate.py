"""What an evaluation shows: progress, tables, the paths of its files, and errors."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rich.text import Text

from wildscav.errors import UserError, describe
from wildscav.terminal.console import command, console, counted, print_json
from wildscav.terminal.engine_progress import preparing
from wildscav_engine.record import SUFFIX
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.cli.result_tables.changes import changes_table
from wildscav_evaluator.cli.result_tables.ranking import LEGEND, ranked, track_table
from wildscav_evaluator.cli.result_tables.timing import sandbox_and_limits, timing_table
from wildscav_evaluator.cli.sessions.errors import raise_errors
from wildscav_evaluator.evaluation import Plan, check_names, collect, identity, make_jobs
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.matches.jobs import AttemptFailed, Job, JobEvent, JobResult, sensors_read
from wildscav_evaluator.matches.run_job import kept_result
from wildscav_evaluator.matches.workers import WorkerDiedError, Workers
from wildscav_evaluator.monitoring.monitor import Monitor, MonitorOptions
from wildscav_evaluator.output.folder import check_out, keep_only, output_folder
from wildscav_evaluator.output.layout import LEDGER_FILE, LOGS, RECORDS, REPLAYS, RESULTS_FILE, SUITE_FILE
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.output.result_sinks import ResultSink, sinks
from wildscav_evaluator.output.results import Evaluation, Results, write_results
from wildscav_evaluator.scores.changes import Change, changes_since_last
from wildscav_evaluator.scores.notes import evaluation_actions_note, evaluation_lateness_note

INTERRUPTED = 130  # exit code, by the convention of shells
DASHBOARD_ONLY = MonitorOptions()


def run_session(
    plan: Plan, database: Path, options: MonitorOptions = DASHBOARD_ONLY, *, as_json: bool = False
) -> None:
    """Evaluate, and show and save the results.

    Raises:
        UserError: Nothing could be evaluated; or, after everything else was shown and saved, something could
            not be saved or a submission failed in all its matches.
    """
    kept_by = tuple(sinks(str(database)))
    for sink in kept_by:
        sink.check()
    with evaluating(plan, options) as (results, ledger):
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


@contextmanager
def evaluating(plan: Plan, options: MonitorOptions) -> Iterator[tuple[Results, LedgerWriter]]:
    """Play the matches of a plan that are not played yet, and lock its output folder while the block lasts.

    Yields:
        The results, and the ledger, which the caller closes with them.

    Raises:
        UserError: The matches cannot be played, or the evaluation was interrupted.
    """
    check_names(plan.submissions)
    check_out(plan.out, plan.submissions)
    jobs = make_jobs(plan)
    with output_folder(plan.out, identity(plan), fresh=plan.fresh) as lock:
        if plan.suite.source is not None:
            write_whole(plan.out / SUITE_FILE, plan.suite.source)
        ledger = LedgerWriter(plan.out, identity(plan), plan.key)
        try:
            results = collect(plan, _play(plan, jobs, lock, ledger, options))
        except KeyboardInterrupt:
            raise UserError(_interrupted(plan, jobs), INTERRUPTED) from None
        except WorkerDiedError as error:
            raise UserError(str(error)) from error
        yield results, ledger


def _play(
    plan: Plan, jobs: Sequence[Job], lock: Lock, ledger: LedgerWriter, options: MonitorOptions
) -> list[JobResult]:
    """Play the matches that no earlier run has played, and return the results of all."""
    done = ledger.confirm([result for job in jobs if (result := kept_result(job)) is not None])
    keep_only(plan.out, (result.job.stem for result in done))
    if done:
        console.print(_resumption(len(done), len(jobs)))
    monitor = Monitor(jobs, plan.jobs, plan.title, options)
    for result in done:
        monitor.add_earlier(result)
    complete = {result.job.stem for result in done if not result.to_render}
    waiting = [job for job in jobs if job.stem not in complete]
    if waiting:
        with Workers(min(plan.jobs, len(waiting)), lock) as workers:
            with preparing(console):
                workers.precompile(sensors_read(waiting))
            with monitor.shown():
                for result in workers.run(waiting, *_listeners(ledger, monitor)):
                    ledger.end(result)
                    monitor.add(result)
    return list(monitor.tally.done.values())


def _listeners(
    ledger: LedgerWriter, monitor: Monitor
) -> tuple[Callable[[Job], None], Callable[[Job, JobEvent], None]]:
    """Return the callbacks for the start of a match and for its events."""

    def begin(job: Job) -> None:
        ledger.begin(job.stem)
        monitor.start(job)

    def handle(job: Job, event: JobEvent) -> None:
        if isinstance(event, AttemptFailed):
            ledger.broke(job.stem, event.reason)
        monitor.handle(job, event)

    return begin, handle


def _resumption(done: int, jobs: int) -> str:
    some = f"{done:,} of {counted(jobs, 'match')} {'was' if done == 1 else 'were'} played before"
    return some if done < jobs else f"all {counted(jobs, 'match')} were played before"


def _interrupted(plan: Plan, jobs: Sequence[Job]) -> str:
    done = sum(kept_result(job) is not None for job in jobs)
    return (
        f"interrupted: {done:,} of {counted(len(jobs), 'match')} are saved in {plan.out}; "
        "run the same command again to play the rest"
    )


def _show_notes(results: Results) -> None:
    """Print which submissions sent invalid actions, and which late steps are not their fault."""
    lines = [line for one in results.evaluations if (line := evaluation_actions_note(one))]
    lines += [
        line
        for one in results.evaluations
        if (line := evaluation_lateness_note(one, results.timings.matches))
    ]
    if lines:
        console.print()
    for line in lines:
        console.print(Text.assemble(("note: ", "yellow"), line))


def say_ledger(plan: Plan, ledger: LedgerWriter) -> None:
    """Print where the ledger is, and which key signed it."""
    signed = "not signed" if plan.public_key is None else f"signed with the key {plan.public_key}"
    say("ledger", f"{plan.out / LEDGER_FILE}, {signed}")
    if plan.public_key is not None:
        say("", f"its head, to be published with the results: {ledger.head}")


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
    _show_notes(results)
    console.print()
    for position, line in enumerate(sandbox_and_limits(results.sandbox, results.limits)):
        say("" if position else "sandbox", line)


def _keep(results: Results, plan: Plan, kept_by: Iterable[ResultSink], database: Path) -> Iterator[str]:
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


def say(what: str, text: str) -> None:
    """Print a label and a text on one line."""
    console.print(f"{what:<9} {text}", soft_wrap=True, highlight=False)


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
