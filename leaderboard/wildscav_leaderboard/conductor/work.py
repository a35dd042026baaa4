"""The work that the conductor hands out: building and validating submissions, and playing matches.

Validation is `wildscav check` with the suites of the season's tracks and their limits, on fresh seeds.
Matches are played by an executor of the evaluator, each into a folder of its own. A match counts once its
result is in the database, so one that ended in the moment of a crash is played again.
"""

import os
import shutil
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from wildscav.errors import UserError
from wildscav_engine.record import FILE_LIMIT
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.files import read_limited, write_whole
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.check.findings import Finding, Verdict
from wildscav_evaluator.check.trials import Trial, run_checks
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.layout import LOGS, RECORDS
from wildscav_evaluator.output.results import MatchRow
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.process import DANGER, WARNING
from wildscav_evaluator.seats import robot_entrant
from wildscav_evaluator.submissions.images import BuildError, build_image, lacks_packages, with_images
from wildscav_evaluator.submissions.submission import Submission
from wildscav_leaderboard.boards.matchmaking import seated
from wildscav_leaderboard.matches.models import LADDER, Match
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.matches.service import PlayedRecord, Seat
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.spectating.live import key_of
from wildscav_leaderboard.submissions.archives import load_archive
from wildscav_server.hosting.manifest import SubmissionError
from wildscav_server.hosting.precompile import precompile_for
from wildscav_server.monitoring.logs import Log

VARIABLE = "WILDSCAV_SANDBOX"
WEAK = f"{DANGER}. For code that you do not trust, set sandbox = 'bubblewrap' or 'oci' under [execution]"
LAST_LINES = 20  # of a failing agent's output that are kept


def chosen_sandbox(season: Season, executor: Executor, log: Log) -> str:
    """Return the sandbox that the settings or the environment name, else the strongest that works.

    Agents of strangers never run without one by mistake.

    Raises:
        UserError: None that isolates agents works, and the settings do not say to do without.
    """
    asked = season.settings.execution.sandbox or os.environ.get(VARIABLE) or None
    choice, _ = executor.choose_sandbox(asked, [])
    if asked is None and not choice.sandbox.isolated:
        why = "; ".join(choice.warnings[1:])
        raise UserError(
            f"no sandbox works here ({why}): `wildscav doctor` tells more. With sandbox = 'process' in the "
            "settings, agents run without one, which is for agents that you trust"
        )
    for warning in choice.warnings:
        log.warning("sandbox_is_weak", reason=WEAK if warning == WARNING else warning)
    return choice.sandbox.name


@dataclass(frozen=True)
class Rejection:
    """Why a submission cannot take part, by its own fault."""

    reason: str
    last_lines: tuple[str, ...] = ()
    command: str = ""  # that shows it again on the competitor's machine


def build(season: Season, archive: str, entrant: str, sandbox: str) -> Rejection | str:
    """Unpack a submission, and build its image if the sandbox runs images and it names packages.

    Raises:
        UserError: The archive is missing, or no image can be built on this machine.
        OSError: The disk is full.
    """
    try:
        submission = load_archive(season, archive, entrant)
    except SubmissionError as error:
        return Rejection(str(error))
    try:
        if SANDBOXES[sandbox].runs_images and lacks_packages(submission):
            build_image(submission)
    except BuildError as error:
        return Rejection(str(error), error.last_lines, "wildscav build DIR")
    return ""


def validate(season: Season, archive: str, entrant: str, sandbox: str, number: int) -> Rejection | str:
    """Try a submission on each track that it enters; return why it fails, or else of what to warn its team.

    Raises:
        WildscavError: The platform failed.
        OSError: A file cannot be written.
    """
    (submission,) = with_images([load_archive(season, archive, entrant)], sandbox)
    logs, file = season.submission_folder(number) / "logs", season.validation_file(number)
    logs.mkdir(parents=True, exist_ok=True)
    write_whole(file, b"getting ready")
    precompile_for([submission.sensors])
    tracks = [track for track in submission.manifest.tracks if track in season.settings.tracks]
    trials = {track: trial_of(season, track, submission.name) for track in tracks}
    tell, warnings = partial(_tell, file), []
    for finding in run_checks(submission, SANDBOXES[sandbox], logs, trials, tell=tell):
        if finding.verdict == Verdict.BROKEN:
            command = f"wildscav check DIR --season {season.settings.web.address}"
            return _rejection(finding, command, submission.folder)
        if finding.verdict == Verdict.DOUBTFUL:
            warnings.append(f"{finding.check}: {finding.seen}")
    return "; ".join(warnings)


def _tell(file: Path, line: str) -> None:
    """Write how far a validation is; if that fails, only a page lacks a line."""
    with suppress(OSError):
        write_whole(file, line.encode())


def trial_of(season: Season, track: str, entrant: str) -> Trial:
    """Return a match for validation that its agents cannot tell from one of the season."""
    trial, settings = Trial.of(season.suite(track), track, season.limits(track)), season.track(track)
    trial = trial._replace(model=season.settings.model)
    if settings.mode == "suite":
        return trial
    others = [robot_entrant(TRACKS[track].robot)] * (settings.seats - 1)
    spec, _ = seated(trial.spec, 0, sorted([entrant, *others]))
    return trial._replace(spec=spec)


def _rejection(finding: Finding, command: str, folder: Path) -> Rejection:
    reason = f"{finding.check}: {finding.seen}" + (f". {finding.advice}" if finding.advice else "")
    # Tracebacks name files by where they lie here, which is nobody's business.
    lines = tuple(line.replace(f"{folder}{os.sep}", "") for line in finding.last_lines[-LAST_LINES:])
    return Rejection(reason, lines, command)


def job_of(
    season: Season, match: Match, seats: Sequence[Seat], archives: dict[int, str], sandbox: str
) -> Job:
    """Return the job of a match.

    Args:
        seats: Its seats with an entrant.

    Raises:
        UserError: An archive is missing, or a submission's image was not built on this machine.
    """
    by_seat = {one.seat: one for one in seats}
    spec = MatchSpec.model_validate(match.spec)
    loaded: dict[int, Submission] = {}
    for one in seats:
        if one.submission_id is not None and one.submission_id not in loaded:
            found = load_archive(season, archives[one.submission_id], one.entrant)
            (loaded[one.submission_id],) = with_images([found], sandbox)
    is_ladder = match.kind == LADDER
    out = season.match_folder(match.id)
    for name in (RECORDS, LOGS):
        (out / name).mkdir(parents=True, exist_ok=True)
    submissions = tuple(
        loaded[number] for seat in sorted(by_seat) if (number := by_seat[seat].submission_id) is not None
    )
    seed = season.final_seed if match.decides else season.seed
    return Job(
        submissions=submissions,
        track=match.track,
        index=match.number,
        spec=spec,
        out=out,
        replay=False,
        key=key_of(match.id),
        sandbox=sandbox,
        limits=season.limits(match.track),
        evaluated=None if is_ladder else seats[0].entrant,
        robots=tuple(seat for seat, one in sorted(by_seat.items()) if one.submission_id is None),
        seeds=seed.private(spec, [one.digest for one in submissions]),
        model=season.settings.model,
        watched=is_ladder,  # nobody else plays it, so anyone may see its map
    )


def keep_record(result: JobResult) -> tuple[MatchRow, PlayedRecord]:
    """Keep a match's record under a name with its digest; return its result, and what is stored of it.

    A worker of a conductor that lost its lease may still write a record of the same match. It cannot change
    the one that is kept.

    Raises:
        UserError: The match has no record.
        OSError: It cannot be read or kept.
    """
    if result.row.record is None:
        raise UserError(f"the match {result.job.key} has no record")
    written = result.job.out / result.row.record
    fresh = written.with_name(f".{written.name}.{os.getpid()}")
    fresh.unlink(missing_ok=True)
    try:
        try:
            os.link(written, fresh)
        except OSError:  # not every file system has hard links
            shutil.copyfile(written, fresh)
        digest = record_digest(read_limited(fresh, FILE_LIMIT))
        kept = written.with_name(f"{written.stem}-{digest}{written.suffix}")
        fresh.rename(kept)
    finally:
        fresh.unlink(missing_ok=True)
    row = result.row.model_copy(update={"record": kept.relative_to(result.job.out).as_posix()})
    return row, PlayedRecord(digest, kept.stat().st_size)
