"""Playing the matches of a plan: resuming, progress, the ledger, and interruption."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from rich.text import Text

from wildscav.errors import INTERRUPTED, UserError, describe
from wildscav.terminal.console import command, console, counted, error_console
from wildscav_engine.compilation.engine_progress import preparing
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.executors import Executor, ExecutorError
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.matches.jobs import (
    AttemptFailed,
    Job,
    JobEvent,
    JobResult,
    KeptMatch,
    RenderingReplay,
)
from wildscav_evaluator.monitoring.dashboard import duration
from wildscav_evaluator.monitoring.monitor import Monitor, MonitorOptions
from wildscav_evaluator.output.folder import check_out, keep_only, output_folder
from wildscav_evaluator.output.layout import (
    EXCHANGES,
    LEDGER_FILE,
    LOGS,
    RECORDS,
    REPLAYS,
    RESULTS_FILE,
    SUITE_FILE,
)
from wildscav_evaluator.output.lock import Lock
from wildscav_evaluator.output.numbered_folders import OUT
from wildscav_evaluator.output.results import Results, read_results, write_results
from wildscav_evaluator.plans.plan import Plan
from wildscav_evaluator.submissions.submission import check_unchanged
from wildscav_server.time_limits import Clock


@contextmanager
def playing(
    plan: Plan, options: MonitorOptions, executor: Executor | None = None
) -> Iterator[tuple[Results, LedgerWriter]]:
    """Play the matches of a plan that are not played yet, and lock its output folder while the block lasts.

    Yields the results, and the ledger, which the caller closes with them. UserError if the matches cannot be
    played, or the evaluation was interrupted.
    """
    check_out(plan.out, plan.submissions)
    jobs = plan.make_jobs()
    with output_folder(plan.out, plan.identity(), fresh=plan.fresh) as lock:
        if plan.suite.source is not None:
            write_whole(plan.out / SUITE_FILE, plan.suite.source)
        ledger = LedgerWriter(plan.out, plan.identity(), plan.key)
        try:
            done = _play(plan, jobs, lock, ledger, options, executor or LocalExecutor(plan.jobs))
            if ledger.closed is not None:  # nothing was played, so the results stay those of that command
                plan = replace(plan, jobs=_jobs_before(plan))
            results = plan.collect(done)
        except KeyboardInterrupt:
            raise UserError(f"interrupted: {_saved(plan, ledger, jobs)}", INTERRUPTED) from None
        except ExecutorError as error:
            raise ExecutorError(f"{error}: {_saved(plan, ledger, jobs)}") from error
        yield results, ledger


def _jobs_before(plan: Plan) -> int:
    """Return how many matches the results say were played at once; the plan's if they cannot be read."""
    try:
        return read_results(plan.out / RESULTS_FILE).timings.jobs
    except UserError:
        return plan.jobs


def _play(
    plan: Plan,
    jobs: Sequence[Job],
    lock: Lock,
    ledger: LedgerWriter,
    options: MonitorOptions,
    executor: Executor,
) -> list[JobResult]:
    """Play the matches that no earlier run has played, and return the results of all."""
    done = ledger.kept(jobs)
    keep_only(plan.out, (result.job.stem for result in done))
    if done:
        console.print(_resumption(len(done), len(jobs)))
    monitor = Monitor(jobs, plan.jobs, plan.title, options, lambda: executor.nodes)
    for result in done:
        monitor.add_earlier(result)
    complete = {result.job.stem for result in done if not result.to_render}
    kept = {result.job.stem: KeptMatch(result.row, result.timing) for result in done}
    waiting = [replace(job, kept=kept.get(job.stem)) for job in jobs if job.stem not in complete]
    if waiting:
        longest = _longest(waiting)
        console.print(f"a match lasts at most {duration(longest)} by its agents' time limits")
        with ExitStack() as stack:
            with preparing(console):
                players = stack.enter_context(executor.players(waiting, lock))
            with monitor.shown():
                for result in players.run(waiting, *_listeners(ledger, monitor)):
                    _enter(ledger, result)
                    monitor.add(result)
    return list(monitor.tally.done.values())


def _longest(jobs: Sequence[Job]) -> float:
    """Return how long a match lasts at most, s; UserError if one cannot end within its longest time."""
    try:
        return max(Clock(longest=job.limits.wall_clock).bound(job.spec) for job in jobs)
    except ValueError as error:
        raise UserError(str(error), exit_code=2) from error


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
        elif isinstance(event, RenderingReplay) and event.kept is not None:
            _enter(ledger, JobResult(job, *event.kept))  # it counts, whatever becomes of its replay
        monitor.handle(job, event)

    return begin, handle


def _enter(ledger: LedgerWriter, result: JobResult) -> None:
    """Enter how a match ended; SubmissionError if the files of an agent changed since its digest was made."""
    for submission in {one.folder: one for one in result.job.submissions}.values():
        check_unchanged(submission)
    ledger.end(result)


def _resumption(done: int, jobs: int) -> str:
    some = f"{done:,} of {counted(jobs, 'match')} {'was' if done == 1 else 'were'} played before"
    return some if done < jobs else f"all {counted(jobs, 'match')} were played before"


def _saved(plan: Plan, ledger: LedgerWriter, jobs: Sequence[Job]) -> str:
    return (
        f"{len(ledger.played):,} of {counted(len(jobs), 'match')} are saved in {plan.out}; "
        "run the same command again to play the rest"
    )


def saving_errors(
    results: Results, out: Path, ledger: LedgerWriter, write_more: Callable[[], None] = lambda: None
) -> list[str]:
    """Write the results, and whatever else there is; close the ledger with them, and return the errors."""
    try:
        write_more()
        ledger.close(results, write_results(results, out))
    except OSError as error:
        return [f"the results could not be saved: {describe(error)}"]
    except UserError as error:  # raised by the ledger
        return [str(error)]
    return []


def say_files(plan: Plan, ledger: LedgerWriter, results: Results, replay: str | None = None) -> None:
    """Print where everything is, and the commands that look at it; suggest a replay, or the first."""
    say("results", str(plan.out / RESULTS_FILE))
    say_ledger(plan, ledger)
    places = () if OUT in plan.out.parents else (plan.out,)
    say("", f"standings: {command('wildscav', 'leaderboard', *places)}")
    rows = [row for one in results.evaluations for row in one.matches]
    recorded = len({row.record for row in rows if row.record is not None})
    say("records", f"{plan.out / RECORDS} ({counted(recorded, 'match')})")
    say("", f"check them: {command('wildscav', 'verify', plan.out)}")
    say("", f"watch them in 3D: {command('wildscav', 'watch', plan.out)}")
    if any(row.logs for row in rows):
        say("logs", f"{plan.out / LOGS} (what the agents printed)")
    if results.model is not None:
        say(
            "model",
            f"{plan.out / EXCHANGES} (what agents asked it: secret as long as the records are)",
        )
    replays = sorted({row.replay for row in rows if row.replay is not None})
    if replays:
        say("replays", f"{plan.out / REPLAYS} ({counted(len(replays), 'match')}), to watch in Rerun")
        say("", f"watch one: {command('rerun')} {plan.out / (replay or replays[0])}")


def say_ledger(plan: Plan, ledger: LedgerWriter) -> None:
    """Print where the ledger is, and which key signed it."""
    signed = "not signed" if plan.public_key is None else f"signed with the key {plan.public_key}"
    say("ledger", f"{plan.out / LEDGER_FILE}, {signed}")
    if plan.public_key is not None:
        say("", f"its head, to be published with the results: {ledger.head}")


def say(what: str, text: str) -> None:
    """Print a label and a text on one line."""
    console.print(f"{what:<9} {text}")


def print_note(text: str | None) -> None:
    """Print a note, if there is one."""
    if text is not None:
        console.print(Text.assemble(("note: ", "yellow"), text))


def raise_errors(errors: Sequence[str]) -> None:
    """Print all errors but the last, each on a line as the command line does, and raise that."""
    if not errors:
        return
    for error in errors[:-1]:
        error_console.print(Text(f"wildscav: {' '.join(error.split())}"))
    raise UserError(errors[-1])
