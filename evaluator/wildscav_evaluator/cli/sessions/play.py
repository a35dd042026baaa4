"""What ``wildscav play`` does and shows: the match's spec, its progress, its table and its files."""

import asyncio
import contextlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from pydantic import ValidationError
from rich.progress import TimeElapsedColumn
from rich.table import Table

from wildscav.errors import INTERRUPTED, UserError, describe
from wildscav.terminal.console import command, console, print_json, progress_bar
from wildscav_engine.compilation.engine_progress import preparing
from wildscav_engine.record import SUFFIX, RecordError, check_recordable, read_record, write_record
from wildscav_engine.simulation.match import MatchSetupError
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, RULES
from wildscav_engine.specs.thinking import ClockName
from wildscav_engine.specs.validation import one_line
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.cli.options.tournament import MAX_SEATS, robots_asked
from wildscav_evaluator.cli.result_tables import (
    add_columns,
    heading,
    invalid_actions_note,
    plain_table,
    waits_note,
)
from wildscav_evaluator.cli.sessions.playing import print_note, raise_errors
from wildscav_evaluator.matches.play import (
    MatchAssignment,
    PlayedMatch,
    play_match,
    prepare_logs,
    remove_empty_logs,
)
from wildscav_evaluator.model_gateway.settings import ModelSettings
from wildscav_evaluator.output.numbered_folders import PLAYED, make_next_folder
from wildscav_evaluator.output.results import FINISHED, metric_infos
from wildscav_evaluator.sandbox import SANDBOXES, Sandbox
from wildscav_evaluator.sandbox.agents.capped_log import is_cut
from wildscav_evaluator.scores.number_format import number
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.precompile import precompile_for

if TYPE_CHECKING:
    from wildscav_engine.specs.result import SeatResult

import tempfile

from wildscav_inspect.replay import check_name

EXCHANGES_FILE = "model.jsonl.gz"  # beside the logs: what agents asked a model
BATTLE_SEATS = 6  # by default
HOUSE_AREA = 2500.0  # m² of map for each house


def make_spec(
    track: str,
    *,
    submissions: int,
    robots: str | None,
    map_seed: int,
    size: int,
    seed: int,
    time_limit: float,
    rules: str,
    clock: ClockName = "bank",
) -> MatchSpec:
    """Return the spec of a match; the submissions have the first seats, robots the others.

    UserError if there can be no such match: the map's size is odd, say, or there are too many seats.
    """
    if size % 2:
        raise UserError(f"--size is {size}, must be even", exit_code=2)
    if robots is None:
        robots = str(max(0, BATTLE_SEATS - submissions)) if Field.SHOOT in TRACKS[track].fields else ""
    filled_by = robots_asked(robots, track, MAX_SEATS - submissions)
    houses = max(1, min(200, round(size * size / HOUSE_AREA)))
    try:
        return MatchSpec(
            track=track,
            map=MapSpec(config=MapConfig(size=size, houses=houses), seed=map_seed),
            seed=seed,
            seats=(SUBMISSION,) * submissions + filled_by,
            time_limit=time_limit,
            rules=RULES.validate_python(rules),
            clock=clock,
        )
    except ValidationError as error:
        raise UserError(f"such a match is not possible: {one_line(error)}", exit_code=2) from error


def run_match(
    spec: MatchSpec,
    submissions: Sequence[Submission],
    record: Path | None,
    replay: Path | None,
    logs: Path | None,
    *,
    sandbox: str,
    model: ModelSettings | None = None,
    as_json: bool = False,
) -> None:
    """Play a match, show how it went, and write the requested files.

    What the agents print goes to ``logs``, a new numbered folder if None.
    UserError if it could not be played or, after everything else was shown and written, if an agent failed or
    a file could not be written. OSError if a log could not be.
    """
    check_output_paths(record, replay)
    if record is not None or replay is not None:
        _check_recordable(spec)
    above = (PLAYED / "0001" if logs is None else logs).absolute().parents
    made = [parent for parent in above if not parent.exists()]
    logs = logs or make_next_folder(PLAYED, [submission.name for submission in submissions])
    paths = tuple(logs / f"{seat}-{submission.name}.log" for seat, submission in enumerate(submissions))
    exchanges = None if model is None else logs / EXCHANGES_FILE
    seating = MatchAssignment(spec, tuple(submissions), paths, model=model, exchanges=exchanges)
    with _logging([logs, *made], paths):
        played = _play(seating, SANDBOXES[sandbox])
    console.print(_table(seating, played))
    _show_notes(seating, played)
    errors = list(_write(played, seating, record, replay))
    if as_json:
        print_json(_document(seating, played, logs))
    if any(path.exists() for path in paths):
        console.print(f"the agents' output is in {logs}")
    if exchanges is not None:
        console.print(f"what they asked the model is in {exchanges}")
    for path in filter(is_cut, paths):
        kept = f"{int(seating.limits.output):,}"
        console.print(f"  {path} was cut: {kept} bytes of an agent's output are kept")
    raise_errors([*errors, *_failures(played, seating)])


def _check_recordable(spec: MatchSpec) -> None:
    try:
        check_recordable(spec)
    except RecordError as error:
        raise UserError(str(error), exit_code=2) from None


@contextmanager
def _logging(folders: Sequence[Path], logs: Sequence[Path]) -> Iterator[None]:
    """Create the logs; at the end remove those that are empty, and the folders that are, inner ones first."""
    prepare_logs(logs)
    try:
        yield
    finally:
        remove_empty_logs(logs)
        for empty in folders:
            with contextlib.suppress(OSError):
                empty.rmdir()


def _play(seating: MatchAssignment, sandbox: Sandbox) -> PlayedMatch:
    try:
        with preparing(console):
            precompile_for([submission.sensors for submission in seating.submissions])
        return asyncio.run(_play_with_progress(seating, sandbox))
    except KeyboardInterrupt:
        raise UserError("interrupted: the match was not played to its end", INTERRUPTED) from None
    except MatchSetupError as error:
        raise UserError(str(error)) from error


async def _play_with_progress(seating: MatchAssignment, sandbox: Sandbox) -> PlayedMatch:
    spec = seating.spec
    with progress_bar(TimeElapsedColumn()) as progress:
        task = progress.add_task(f"{spec.track}, {spec.time_limit:g} s", total=spec.frame_limit)
        watching: list[asyncio.Task[None]] = []

        async def watch(hosted: HostedMatch) -> None:
            while True:
                progress.update(task, completed=hosted.match.frame)
                await asyncio.sleep(0.2)

        try:
            return await play_match(
                seating,
                sandbox=sandbox,
                on_start=lambda hosted: watching.append(asyncio.create_task(watch(hosted))),
            )
        finally:
            for watcher in watching:
                watcher.cancel()


def _table(seating: MatchAssignment, played: PlayedMatch) -> Table:
    result = played.match.result()
    metrics = metric_infos(seating.spec.track, seating.spec.metrics)
    seconds = result.frames / FRAMES_PER_SECOND
    title = f"{seating.spec.track} · map {seating.spec.map.seed} · seed {seating.spec.seed} · {seconds:g} s"
    table = plain_table(title)
    add_columns(table, "seat")
    table.add_column("name", vertical="bottom")
    add_columns(table, *map(heading, metrics))
    table.add_column("agent", vertical="bottom")

    def key(seat: "SeatResult") -> float:
        value = seat.metrics[metrics[0].name]
        return value if metrics[0].lower_is_better else -value

    for seat in sorted(result.seats, key=key):
        values = [number(seat.metrics[metric.name], metric) for metric in metrics]
        report = played.seats.get(seat.seat)
        table.add_row(str(seat.seat), seating.names[seat.seat], *values, report.status if report else "robot")
    return table


def _document(seating: MatchAssignment, played: PlayedMatch, logs: Path) -> dict[str, object]:
    """Return what ``wildscav play --json`` prints."""
    result = played.match.result()
    return {
        "track": seating.spec.track,
        "map": seating.spec.map.seed,
        "seed": seating.spec.seed,
        "seconds": result.frames / FRAMES_PER_SECOND,
        "metrics": [metric.as_json() for metric in metric_infos(seating.spec.track, seating.spec.metrics)],
        "logs": str(logs) if logs.exists() else None,
        "seats": [_seat_document(seating, played, seat) for seat in result.seats],
    }


def _seat_document(seating: MatchAssignment, played: PlayedMatch, seat: "SeatResult") -> dict[str, object]:
    report = played.seats.get(seat.seat)
    return {
        "seat": seat.seat,
        "name": seating.names[seat.seat],
        "metrics": dict(seat.metrics),
        "status": report.status.value if report else "robot",
        "detail": report.detail if report else "",
    }


def _show_notes(seating: MatchAssignment, played: PlayedMatch) -> None:
    """Print which agents sent invalid actions, and which waited for a processor."""
    for seat, report in played.seats.items():
        name, invalid = seating.names[seat], report.invalid_actions
        print_note(invalid_actions_note(name, actions=report.steps_played, invalid=invalid))
        print_note(waits_note(name, [report.credited or 0.0]))


def _write(
    played: PlayedMatch, seating: MatchAssignment, record: Path | None, replay: Path | None
) -> Iterator[str]:
    """Write the requested files, and yield the errors. If one file fails, the other is still written."""
    if record is not None:
        try:
            write_record(record, played.match, seating.names)
            console.print(f"record: {record}")
        except OSError as error:
            yield f"the record could not be saved: {describe(error)}"
    if replay is not None:
        try:
            with console.status("rendering the replay"):
                _render(played, seating, replay)
            console.print(f"replay: {replay}\n  {command('rerun')} {replay}")
        except OSError as error:
            yield f"the replay could not be saved: {describe(error)}"


def _render(played: PlayedMatch, seating: MatchAssignment, replay: Path) -> None:
    from wildscav_engine.view import write_replay

    with leftovers.temporary_folder("record-") as folder:
        path = folder / f"match{SUFFIX}"
        write_record(path, played.match, seating.names)
        write_replay(read_record(path), replay, follow=seating.seats[0])


def _failures(played: PlayedMatch, seating: MatchAssignment) -> Iterator[str]:
    """Yield a line for every agent that did not play to the end."""
    for seat, log in zip(seating.seats, seating.logs, strict=True):
        report = played.seats[seat]
        if report.status != FINISHED:
            see = f" (its log: {log})" if log.exists() else ""
            yield f"{seating.names[seat]} {report.status.value}: {report.detail}{see}"


def check_output_paths(record: Path | None, replay: Path | None) -> None:
    """Check that a record and a replay, if requested, can be written to two files; create their folders."""
    if record is not None and replay is not None and record.resolve() == replay.resolve():
        raise UserError(f"--record and --replay name the same file {record}: name two files", exit_code=2)
    for option, path in (("--record", record), ("--replay", replay)):
        if path is not None:
            _check_file(option, path)
    if replay is not None:
        check_name("--replay", replay)
    for option, path in (("--record", record), ("--replay", replay)):
        if path is not None:
            _check_writable(option, path)


def _check_file(option: str, path: Path) -> None:
    if path.is_dir():
        raise UserError(f"{option} {path} is a folder: name a file in it", exit_code=2)
    if path.exists() and not path.is_file():
        raise UserError(f"{option} {path} is not a plain file: name another", exit_code=2)


def _check_writable(option: str, path: Path) -> None:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        # Files are written to a temporary file in the same folder and moved, so the folder must be writable.
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise UserError(f"{option} {path} cannot be written: {error.strerror}", exit_code=2) from error
