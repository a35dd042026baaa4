"""Scores from records alone: playing every match again, and recomputing every table.

Nothing that agents or files claim is trusted here. A record's metrics are those of its match as the engine
plays it now, and a record counts only if that equals the recorded match, step by step.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

from wildscav.errors import describe
from wildscav.terminal.console import printable
from wildscav_engine.record import FILE_LIMIT, RecordError, verify_record
from wildscav_engine.record.format import decode
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.files import read_limited
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.executors import Executor
from wildscav_evaluator.output.layout import RECORDS
from wildscav_evaluator.output.record_names import misnamed, parse_name
from wildscav_evaluator.output.results import (
    Evaluation,
    MatchRow,
    Results,
    SeatRow,
    Versions,
    mean_metrics,
    metric_infos,
)
from wildscav_evaluator.scores.expected_matches import Judge, kind_of
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.seats import entrants_in_names, submission_seats

RECORDED = "recorded"  # status of a match of which only the record is known


@dataclass(frozen=True)
class Replayed:
    """One record, and the result of playing its match again."""

    record: str  # path in the output folder
    track: str
    index: int  # in the suite or in the tournament
    submission: str | None  # None in a tournament, where several submissions meet
    spec: MatchSpec | None = None
    names: tuple[str, ...] = ()  # the display name of each seat
    seeds: tuple[int, ...] = ()  # the private seed that each seat was told
    # The entrants' seats, with the metrics of each; None if the record is invalid.
    seats: Mapping[int, dict[str, float]] | None = None
    fault: str = ""  # why the record is not valid
    versions: Versions | None = None  # with which it was played, according to the record

    @property
    def entrants(self) -> dict[int, str]:
        """The entrants of a valid record of a tournament, by their seats."""
        return {} if self.spec is None else entrants_in_names(self.spec.seats, self.names)

    @property
    def metrics(self) -> dict[str, float] | None:
        """The metrics of the match; None if the record is not valid."""
        return None if self.seats is None else mean_metrics(list(self.seats.values()))


class RecordFile(NamedTuple):
    """The file of a record, as it travels to the process or machine that plays it again."""

    name: str
    content: bytes = b""
    error: str = ""  # why it could not be read


def replay_all(paths: Sequence[Path], executor: Executor) -> Iterator[Replayed]:
    """Play records again, and yield the result of each, in their order."""
    yield from executor.map(replay_file, map(read_file, paths))


def read_file(path: Path) -> RecordFile:
    """Read the file of a record."""
    try:
        return RecordFile(path.name, read_limited(path, FILE_LIMIT))
    except OSError as error:
        return RecordFile(path.name, error=f"cannot be read: {error.strerror}")


def replay_file(file: RecordFile) -> Replayed:
    """Play a record again; return its faults instead of raising, so that the others are still played."""
    name, place = parse_name(Path(file.name)), f"{RECORDS}/{file.name}"
    if name is None:
        return Replayed(place, "", 0, "", fault="it is not named as evaluations name records")
    reported = Replayed(place, *name)
    if file.error:
        return replace(reported, fault=printable(file.error))
    try:
        record = decode(file.content)
        verification = verify_record(record)
        fault = misnamed(record, name) if verification.holds else verification.message
    except RecordError as error:
        fault = str(error)
    except OSError as error:
        fault = describe(error)
    if fault:
        return replace(reported, fault=printable(fault))
    # The record is valid: its result is that of the match played again.
    filled = (
        entrants_in_names(record.spec.seats, record.names)
        if name.submission is None
        else submission_seats(record.spec.seats)
    )
    seats = {seat: dict(record.result.seats[seat].metrics) for seat in filled}
    versions = Versions(
        engine=record.engine_version,
        simulation=record.simulation_version,
        generator=record.generator_version,
        record=record.version,
    )
    return replace(
        reported,
        spec=record.spec,
        names=record.names,
        seeds=record.seeds,
        seats=seats,
        versions=versions,
    )


def recompute(replayed: Sequence[Replayed], reported: Results | None) -> list[Evaluation]:
    """Return the evaluations that follow from some records, with every number recomputed.

    ``reported`` is the source of what records do not contain: the order of the evaluations, the versions of
    the submissions, and the behaviour of agents.
    """
    held: dict[tuple[str, str], dict[int, Replayed]] = {}
    for submission, one in _by_submission(replayed):
        held.setdefault((one.track, submission), {})[one.index] = one
    before = {(one.track, one.submission): one for one in (reported.evaluations if reported else ())}
    tracks = list(TRACKS)
    unreported = sorted(held.keys() - before.keys(), key=lambda key: (tracks.index(key[0]), key[1]))
    return [_evaluation(*key, held.get(key, {}), before.get(key)) for key in (*before, *unreported)]


def _by_submission(replayed: Iterable[Replayed]) -> Iterator[tuple[str, Replayed]]:
    """Yield the valid records with their submission, those of a tournament once for each entrant."""
    for one in replayed:
        if one.seats is None:
            continue
        if one.submission is not None:
            yield one.submission, one
            continue
        for entrant in dict.fromkeys(one.entrants.values()):
            own = {seat: one.seats[seat] for seat, name in one.entrants.items() if name == entrant}
            yield entrant, replace(one, seats=own)


def _evaluation(
    track: str, submission: str, recorded: Mapping[int, Replayed], reported: Evaluation | None
) -> Evaluation:
    rows = {row.index: row for row in (reported.matches if reported else ())}
    matches = tuple(_row(index, rows.get(index), recorded.get(index)) for index in sorted({*rows, *recorded}))
    metrics = metric_infos(track, next((one.spec.metrics for one in recorded.values() if one.spec), ()))
    return Evaluation(
        submission=submission,
        version=reported.version if reported else "",
        digest=reported.digest if reported else "",
        interface=reported.interface if reported else None,
        track=track,
        metrics=metrics,
        matches=matches,
        summary=summary(metrics, matches),
    )


def _row(index: int, reported: MatchRow | None, recorded: Replayed | None) -> MatchRow:
    if recorded is None or recorded.seats is None:
        reported = reported or MatchRow(index=index, status=RECORDED)
        return reported.model_copy(update={"metrics": None, "record": None, "seats": ()})
    known = {seat.seat: seat for seat in (reported.seats if reported else ())}
    seats = tuple(
        known.get(seat, SeatRow(seat=seat, status=RECORDED)).model_copy(
            update={"metrics": metrics, **_place(recorded, seat)}
        )
        for seat, metrics in recorded.seats.items()
    )
    row = reported or MatchRow(index=index, status=RECORDED)
    return row.model_copy(update={"metrics": recorded.metrics, "record": recorded.record, "seats": seats})


def _place(recorded: Replayed, seat: int) -> dict[str, object]:
    """Return whose a seat of a tournament is, and its team."""
    if recorded.submission is not None or recorded.spec is None:
        return {}
    return {"submission": recorded.entrants[seat], "team": recorded.spec.team_of_seats[seat]}


def disagreements(
    replayed: Sequence[Replayed],
    reported: Results,
    recomputed: Sequence[Evaluation],
    judge: Judge | None,
) -> Iterator[str]:
    """Yield one line for each of an evaluation's results that its records do not support.

    ``recomputed`` follows from the records; there is no judge if it is not known which match has which
    number.
    """
    for one in replayed:
        if one.spec is not None and (one.submission is None) != (reported.tournament is not None):
            kind = "an evaluation" if reported.tournament is None else "a tournament"
            yield f"{one.record}: is not named as the records of {kind} are"
        if one.spec is not None and judge and not judge(one.track, one.index, one.spec, one.names):
            yield f"{one.record}: is not match {one.index} of the {kind_of(reported)}"
    remaining = {(one.track, one.submission): one for one in recomputed}
    for evaluation in reported.evaluations:
        yield from _differences(evaluation, remaining.pop((evaluation.track, evaluation.submission)))
    for track, submission in remaining:
        yield f"{submission} on {track}: there are records, but no results"


def _differences(reported: Evaluation, recomputed: Evaluation) -> Iterator[str]:
    who = f"{reported.submission} on {reported.track}"
    rows = {row.index: row for row in reported.matches}
    for row in recomputed.matches:
        before = rows.get(row.index)
        if before is None:
            yield f"{who}, match {row.index}: there is a record, but no result"
        elif before.record is not None and row.record is None:
            yield f"{who}, match {row.index}: its record is missing or does not hold"
        elif _scored(before) != _scored(row):
            shown = _metrics if before.metrics != row.metrics else _seats
            yield f"{who}, match {row.index}: the results say {shown(before)}, its record {shown(row)}"
    if reported.metrics != recomputed.metrics:
        yield f"{who}: its metrics are described differently"
    for name in {**reported.summary, **recomputed.summary}:
        if reported.summary.get(name) != recomputed.summary.get(name):
            was, now = _statistics(reported, name), _statistics(recomputed, name)
            yield f"{who}: {name} is {was}, its records give {now}"


def _scored(row: MatchRow) -> tuple[object, ...]:
    """Return the part of a match's result that a record can prove."""
    return (
        row.metrics,
        row.record,
        [(seat.seat, seat.submission, seat.team, seat.metrics) for seat in row.seats],
    )


def _metrics(row: MatchRow) -> str:
    if row.metrics is None:
        return "nothing"
    return ", ".join(f"{name} {value}" for name, value in row.metrics.items())


def _seats(row: MatchRow) -> str:
    """Return what the mean metrics of a match do not show: its record, and its seats with their teams."""
    seats = [
        f"seat {seat.seat}"
        + ("" if seat.submission is None else f" of {seat.submission} in team {seat.team}")
        + f" ({', '.join(f'{name} {value}' for name, value in seat.metrics.items())})"
        for seat in row.seats
    ]
    return ", ".join([row.record or "no record", *seats])


def _statistics(evaluation: Evaluation, name: str) -> str:
    statistics = evaluation.summary.get(name)
    return "missing" if statistics is None else f"{statistics.mean} ({statistics.low} to {statistics.high})"
