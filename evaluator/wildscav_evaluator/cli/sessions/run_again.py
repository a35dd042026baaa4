"""What ``wildscav verify --agent`` does and shows."""

import asyncio
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from pydantic import ValidationError
from rich.text import Text

from wildscav.errors import INTERRUPTED, UserError
from wildscav.terminal.console import console, counted, print_json, printable
from wildscav_engine.compilation.engine_progress import preparing
from wildscav_engine.record import Record, RecordError, read_record, verify_record
from wildscav_engine.simulation.match import MatchSetupError
from wildscav_engine.specs.validation import one_line
from wildscav_evaluator.cli.sessions.playing import raise_errors
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, read_ledger
from wildscav_evaluator.matches.play import (
    MatchAssignment,
    PlayedMatch,
    play_match,
    prepare_logs,
    remove_empty_logs,
)
from wildscav_evaluator.matches.recorded_match import Agreement, RecordedMatch
from wildscav_evaluator.output.identity import Entrant
from wildscav_evaluator.output.layout import RECORDS
from wildscav_evaluator.output.results import FINISHED
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Limits
from wildscav_evaluator.seats import entrants_in_names, submission_seats
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.tournaments.names import submission_of
from wildscav_server.hosting.precompile import precompile_for

CAUTION = (
    "An agent that reads a clock, or uses threads or its own random numbers, may differ although its code is "
    "the same: replay it several times, and check whether it agrees with itself."
)


def run_again(
    path: Path,
    submission: Submission,
    *,
    seats: Sequence[int],
    logs: Path,
    sandbox: str,
    as_json: bool = False,
) -> None:
    """Run a submission again in a recorded match, and show how far it acts as recorded.

    Without ``seats``, those are compared that the record gives to the submission. UserError if the record is
    not valid or has no such seat or, after everything was shown, if the agent acts differently. OSError if a
    log could not be written.
    """
    record = _verified_record(path)
    ledger = _ledger(path)
    entries = _entries(ledger, submission)
    compared = _chosen_seats(record, submission, entries, seats, path)
    limits = _limits(path, record, submission, ledger, entries)
    everywhere = submission_seats(record.spec.seats)
    places = tuple(logs / f"{seat}-{submission.name}.log" for seat in everywhere)
    seating = MatchAssignment(record.spec, (submission,) * len(everywhere), places, limits)
    prepare_logs(places)
    try:
        played = _play(seating, record, compared, sandbox)
    finally:
        remove_empty_logs(places)
    match = played.match
    if not isinstance(match, RecordedMatch):
        raise TypeError("the match that was played is not the recorded one")
    if match.diverged_at is not None:
        raise UserError(f"{path} is not valid: the state differs in step {match.diverged_at}")
    agreements = match.agreements.values()
    if as_json:
        print_json({"record": str(path), "seats": [_document(one, played, record) for one in agreements]})
    raise_errors(list(_report(agreements, played, record)))


def _verified_record(path: Path) -> Record:
    """Return a record that holds; UserError if it does not."""
    try:
        record = read_record(path)
        with console.status("re-simulating the record"):
            verification = verify_record(record)
    except RecordError as error:
        raise UserError(str(error), exit_code=2) from error
    if not verification.holds:
        raise UserError(f"{path} is not valid: {verification.message}", exit_code=2)
    if record.spec.clock in ("running", "tokens"):
        raise UserError(
            f"{path}: its clock is {record.spec.clock}, so when it asked an agent depended on its thinking",
            exit_code=2,
        )
    return record


def _ledger(path: Path) -> Ledger | None:
    """Return the ledger of a record's evaluation; None if there is none, with a warning if it is broken."""
    folder = path.absolute().parent
    try:
        return read_ledger(folder.parent) if folder.name == RECORDS else None
    except LedgerError as error:
        _warn(str(error))
        return None


def _entries(ledger: Ledger | None, submission: Submission) -> tuple[Entrant, ...]:
    """Return the entrants of an evaluation that are entries of a submission.

    Several versions of it may have played a tournament. If one of them has the same files, it is that one.
    """
    entrants = () if ledger is None else ledger.identity.submissions
    own = tuple(one for one in entrants if submission_of(one.name) == submission.name)
    return tuple(one for one in own if one.digest == submission.digest) or own


def _chosen_seats(
    record: Record, submission: Submission, entries: Sequence[Entrant], asked: Sequence[int], path: Path
) -> tuple[int, ...]:
    """Return the seats to compare: those asked for, or all seats of the submission's entries.

    UserError if there are none, or a requested one is not filled by a submission.
    """
    filled = submission_seats(record.spec.seats)
    known = ", ".join(f"{seat} ({printable(record.names[seat])})" for seat in filled) or "none"
    if wrong := set(asked).difference(filled):
        raise UserError(
            f"--seat is {min(wrong)}: the seats of submissions in {path} are {known}", exit_code=2
        )
    names = {one.name for one in entries}
    seats = tuple(asked) or tuple(
        seat
        for seat, name in entrants_in_names(record.spec.seats, record.names).items()
        if seat in filled and (name in names if names else submission_of(name) == submission.name)
    )
    if not seats:
        raise UserError(
            f"no seat in {path} belongs to {submission.name!r}: the seats of submissions are {known}; name "
            "one with --seat",
            exit_code=2,
        )
    return seats


def _limits(
    path: Path,
    record: Record,
    submission: Submission,
    ledger: Ledger | None,
    entries: Sequence[Entrant],
) -> Limits:
    """Return the limits of a record's evaluation, and warn if the submission's files have changed."""
    if ledger is None:
        return DEFAULT_LIMITS
    out = path.absolute().parent.parent
    if not entries:
        _warn(f"{submission.name} is not among those evaluated in {out}")
    elif all(one.digest != submission.digest for one in entries):
        _warn(f"these are not the files of {submission.name} that were evaluated in {out}")
    kept = ledger.identity.limits.get(record.spec.track)
    try:
        return Limits.model_validate({} if kept is None else kept.model_dump(exclude_none=True))
    except ValidationError as error:
        raise UserError(f"{path}: the ledger's limits are not possible: {one_line(error)}", 2) from error


def _warn(text: str) -> None:
    console.print(Text.assemble(("warning: ", "yellow"), printable(text)))


def _play(seating: MatchAssignment, record: Record, compared: tuple[int, ...], sandbox: str) -> PlayedMatch:
    try:
        with preparing(console):
            precompile_for([submission.sensors for submission in seating.submissions])
        with console.status(f"running the agent again, {counted(record.steps, 'step')}"):
            return asyncio.run(
                play_match(
                    seating, sandbox=SANDBOXES[sandbox], make=lambda _: RecordedMatch(record, compared)
                )
            )
    except KeyboardInterrupt:
        raise UserError("interrupted: the match was not played to its end", INTERRUPTED) from None
    except MatchSetupError as error:
        raise UserError(str(error)) from error


def _report(agreements: Iterable[Agreement], played: PlayedMatch, record: Record) -> Iterator[str]:
    """Print how far each seat acted as recorded, and yield an error for each that did not."""
    differing = []
    for one in agreements:
        who, report = f"seat {one.seat} ({printable(record.names[one.seat])})", played.seats[one.seat]
        if report.status != FINISHED:
            _say(f"{who}: {report.status.value} in this replay: {report.detail}")
        if report.late_steps:
            _say(f"{who}: late in {counted(report.late_steps, 'step')} of this replay")
        if one.first is None:
            _say(f"{who}: all {counted(one.steps, 'step')} as recorded")
        else:
            differing.append(
                f"{who} acts differently than recorded in {one.differing:,} of {counted(one.steps, 'step')}, "
                f"first in step {one.first:,}: {one.difference}"
            )
    if differing:
        _say(CAUTION)
    yield from differing


def _document(one: Agreement, played: PlayedMatch, record: Record) -> dict[str, object]:
    """Return how far a seat acted as recorded, as ``--json`` prints it."""
    report = played.seats[one.seat]
    return {
        "seat": one.seat,
        "name": record.names[one.seat],
        "status": report.status.value,
        "late_steps": report.late_steps,
        "steps": one.steps,
        "differing": one.differing,
        "first": one.first,
        "difference": one.difference,
    }


def _say(text: str) -> None:
    console.print(Text(printable(text)))
