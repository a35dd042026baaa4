"""``wildscav replay-agent`` as its user sees it."""

import asyncio
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from rich.text import Text

from wildscav.errors import UserError
from wildscav.server.hosting.precompile import precompile_for
from wildscav.terminal.console import console, counted, printable
from wildscav.terminal.engine_progress import preparing
from wildscav_engine.record import Record, RecordError, read_record, verify_record
from wildscav_engine.simulation.match import MatchSetupError
from wildscav_evaluator.cli.sessions.errors import raise_errors
from wildscav_evaluator.cli.sessions.evaluate import INTERRUPTED
from wildscav_evaluator.ledger.ledger import LedgerError, read_ledger
from wildscav_evaluator.matches.play import PlayedMatch, Seating, play_match, prepare_logs, remove_empty_logs
from wildscav_evaluator.matches.recorded_match import Agreement, RecordedMatch
from wildscav_evaluator.output.layout import RECORDS
from wildscav_evaluator.output.results import FINISHED
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Limits
from wildscav_evaluator.seats import submission_seats
from wildscav_evaluator.submissions.submission import Submission

CAUTION = (
    "An agent that looks at a clock, uses threads, or random numbers of its own may differ though it is the "
    "same: replay it several times, and see whether it agrees with itself."
)


def run_again(path: Path, submission: Submission, *, seats: Sequence[int], logs: Path, sandbox: str) -> None:
    """Ask a submission again in a recorded match, and show how far it acts as recorded.

    Args:
        path: The record.
        submission: Who is asked.
        seats: Whose actions to compare; those that the record gives to the submission if none.
        logs: Folder for what the agents print.
        sandbox: In which they run.

    Raises:
        UserError: The record does not hold or has no such seat; or the agent acts otherwise, after all was
            shown.
        OSError: A log could not be written.
    """
    record = _whole(path)
    compared = _chosen_seats(record, submission, seats, path)
    limits = _limits(path, record, submission)
    everywhere = submission_seats(record.spec.seats)
    places = tuple(logs / f"{seat}-{submission.name}.log" for seat in everywhere)
    seating = Seating(record.spec, (submission,) * len(everywhere), places, limits)
    prepare_logs(places)
    try:
        played = _play(seating, record, compared, sandbox)
    finally:
        remove_empty_logs(places)
    match = played.match
    if not isinstance(match, RecordedMatch):
        raise TypeError("another match was played than the one asked for")
    if match.diverged_at is not None:
        raise UserError(f"{path} does not hold: step {match.diverged_at}: the state differs")
    raise_errors(list(_shown(match.agreements.values(), played, record)))


def _whole(path: Path) -> Record:
    """Return a record that holds.

    Raises:
        UserError: It does not.
    """
    try:
        record = read_record(path)
        with console.status("re-simulating the record"):
            found = verify_record(record)
    except RecordError as error:
        raise UserError(str(error), exit_code=2) from error
    if not found.holds:
        raise UserError(f"{path} does not hold: {found.message}", exit_code=2)
    return record


def _chosen_seats(
    record: Record, submission: Submission, asked: Sequence[int], path: Path
) -> tuple[int, ...]:
    """Return the seats to compare.

    Raises:
        UserError: There are none, or no submission fills one that is asked for.
    """
    filled = submission_seats(record.spec.seats)
    told = ", ".join(f"{seat} ({printable(record.names[seat])})" for seat in filled) or "none"
    if wrong := set(asked).difference(filled):
        raise UserError(f"--seat is {min(wrong)}: the seats of submissions in {path} are {told}", exit_code=2)
    own = re.compile(rf"{re.escape(submission.name)}( \d+)?")
    found = tuple(asked) or tuple(seat for seat in filled if own.fullmatch(record.names[seat]))
    if not found:
        raise UserError(
            f"no seat in {path} is that of {submission.name!r}: the seats of submissions are {told}; name "
            "one with --seat",
            exit_code=2,
        )
    return found


def _limits(path: Path, record: Record, submission: Submission) -> Limits:
    """Return the limits of a record's evaluation, having warned if these are not the files that played."""
    folder = path.absolute().parent
    try:
        ledger = read_ledger(folder.parent) if folder.name == RECORDS else None
    except LedgerError as error:
        _warn(str(error))
        return DEFAULT_LIMITS
    if ledger is None:
        return DEFAULT_LIMITS
    entrant = next((one for one in ledger.identity.submissions if one.name == submission.name), None)
    if entrant is None:
        _warn(f"{submission.name} is not among those evaluated in {folder.parent}")
    elif entrant.digest != submission.digest:
        _warn(f"these are not the files of {submission.name} that were evaluated in {folder.parent}")
    kept = ledger.identity.limits.get(record.spec.track)
    return DEFAULT_LIMITS if kept is None else Limits.model_validate(kept.model_dump(exclude_none=True))


def _warn(text: str) -> None:
    console.print(Text.assemble(("warning: ", "yellow"), printable(text)), soft_wrap=True)


def _play(seating: Seating, record: Record, compared: tuple[int, ...], sandbox: str) -> PlayedMatch:
    try:
        with preparing(console):
            precompile_for([submission.manifest.sensors for submission in seating.submissions])
        with console.status(f"asking the agent again, {counted(record.steps, 'step')}"):
            return asyncio.run(
                play_match(
                    seating, sandbox=SANDBOXES[sandbox], make=lambda _: RecordedMatch(record, compared)
                )
            )
    except KeyboardInterrupt:
        raise UserError("interrupted: the match was not played to its end", INTERRUPTED) from None
    except MatchSetupError as error:
        raise UserError(str(error)) from error


def _shown(agreements: Iterable[Agreement], played: PlayedMatch, record: Record) -> Iterator[str]:
    """Say how far each seat acted as recorded, and yield a line for each that did not."""
    differing = []
    for one in agreements:
        who, report = f"seat {one.seat} ({printable(record.names[one.seat])})", played.seats[one.seat]
        if report.status != FINISHED:
            _say(f"{who}: {report.status.value} now: {report.detail}")
        if report.late_steps:
            _say(f"{who}: late now in {counted(report.late_steps, 'step')}")
        if one.first is None:
            _say(f"{who}: all {counted(one.steps, 'step')} as recorded")
        else:
            differing.append(
                f"{who} acts otherwise than recorded in {one.differing:,} of {counted(one.steps, 'step')}, "
                f"first in step {one.first:,}: {one.difference}"
            )
    if differing:
        _say(CAUTION)
    yield from differing


def _say(text: str) -> None:
    console.print(Text(printable(text)), soft_wrap=True)
