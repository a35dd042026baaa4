"""Scores from records alone: playing every match again, and recomputing every table.

Nothing that agents or files claim is trusted here. A record's metrics are those of its match as the engine
plays it now, and a record counts only if that equals the recorded match, step by step.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from multiprocessing import active_children, get_context
from pathlib import Path

from wildscav.errors import describe
from wildscav.system.worker_processes import become_worker, starting_workers
from wildscav.terminal.console import printable
from wildscav_engine.record import RECORD_VERSION, RecordError, read_record, verify_record
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.output.layout import RECORDS
from wildscav_evaluator.output.record_names import misnamed, parse_name
from wildscav_evaluator.output.results import (
    Evaluation,
    MatchRow,
    Results,
    SeatRow,
    mean_metrics,
    metric_infos,
)
from wildscav_evaluator.output.versions import Versions
from wildscav_evaluator.scores.score import summary
from wildscav_evaluator.seats import submission_seats

RECORDED = "recorded"  # status of a match of which only the record is known


@dataclass(frozen=True)
class Replayed:
    """One record, and the result of playing its match again."""

    record: str  # path in the output folder
    track: str
    index: int  # in the suite
    submission: str
    spec: MatchSpec | None = None
    seats: Mapping[int, dict[str, float]] | None = None  # metrics by seat; None if the record is invalid
    fault: str = ""  # why the record is not valid
    versions: Versions | None = None  # with which it was played, according to the record

    @property
    def key(self) -> tuple[str, str, int]:
        """The track, submission and index of the match."""
        return self.track, self.submission, self.index

    @property
    def metrics(self) -> dict[str, float] | None:
        """The metrics of the match; None if the record is not valid."""
        return None if self.seats is None else mean_metrics(list(self.seats.values()))


def replay_all(paths: Sequence[Path], jobs: int) -> Iterator[Replayed]:
    """Play records again, and yield the result of each, in their order.

    Args:
        paths: The records.
        jobs: How many to play at once, each in its own process; if 1, they are played in this process.
    """
    if jobs == 1:
        yield from map(replay_one, paths)
        return
    count, spawn = min(jobs, len(paths)), get_context("spawn")
    before = active_children()
    with ProcessPoolExecutor(count, spawn, become_worker, (os.getpid(),)) as pool:
        try:
            # The first alone, so that the others find the compiled code in the cache.
            with starting_workers():
                first = pool.submit(replay_one, paths[0])
            yield first.result()
            with starting_workers():
                others = pool.map(replay_one, paths[1:])
            yield from others
        except BaseException:
            # Stop the workers: what they are playing may take long and is no longer needed.
            for worker in set(active_children()).difference(before):
                worker.terminate()
            raise


def replay_one(path: Path) -> Replayed:
    """Play a record again; return its faults instead of raising, so that the others are still played."""
    name, place = parse_name(path), f"{RECORDS}/{path.name}"
    if name is None:
        return Replayed(place, "", 0, "", fault="it is not named as evaluations name records")
    reported = Replayed(place, *name)
    try:
        record = read_record(path)
        found = verify_record(record)
        fault = misnamed(record, name) if found.holds else found.message
    except RecordError as error:
        fault = str(error).removeprefix(f"{path}: ")
    except OSError as error:
        fault = describe(error)
    if fault:
        return replace(reported, fault=printable(fault))
    # The record is valid: its result is that of the match played again.
    seats = {seat: dict(record.result.seats[seat].metrics) for seat in submission_seats(record.spec.seats)}
    versions = Versions(
        engine=record.engine_version,
        simulation=record.simulation_version,
        generator=record.generator_version,
        record=RECORD_VERSION,
    )
    return replace(reported, spec=record.spec, seats=seats, versions=versions)


def recompute(replayed: Sequence[Replayed], reported: Results | None) -> list[Evaluation]:
    """Return the evaluations that follow from some records, with every number recomputed.

    Args:
        replayed: The records, played again.
        reported: The evaluation's own results, the source of what records do not contain: the order of the
            evaluations, the versions of the submissions, and the behaviour of agents.
    """
    held = {one.key: one for one in replayed if one.seats is not None}
    before = {(one.track, one.submission): one for one in (reported.evaluations if reported else ())}
    tracks = list(TRACKS)
    found = sorted({key[:2] for key in held} - before.keys(), key=lambda key: (tracks.index(key[0]), key[1]))
    return [_evaluation(*key, held, before.get(key)) for key in (*before, *found)]


def _evaluation(
    track: str, submission: str, held: Mapping[tuple[str, str, int], Replayed], reported: Evaluation | None
) -> Evaluation:
    rows = {row.index: row for row in (reported.matches if reported else ())}
    recorded = {one.index: one for one in held.values() if (one.track, one.submission) == (track, submission)}
    matches = tuple(_row(index, rows.get(index), recorded.get(index)) for index in sorted({*rows, *recorded}))
    metrics = metric_infos(track, next((one.spec.metrics for one in recorded.values() if one.spec), ()))
    return Evaluation(
        submission=submission,
        version=reported.version if reported else "",
        digest=reported.digest if reported else "",
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
        known.get(seat, SeatRow(seat=seat, status=RECORDED)).model_copy(update={"metrics": metrics})
        for seat, metrics in recorded.seats.items()
    )
    row = reported or MatchRow(index=index, status=RECORDED)
    return row.model_copy(update={"metrics": recorded.metrics, "record": recorded.record, "seats": seats})


def disagreements(
    replayed: Sequence[Replayed], reported: Results, expected: Mapping[str, Sequence[MatchSpec]] | None
) -> Iterator[str]:
    """Yield one line for each of an evaluation's results that its records do not support.

    Args:
        replayed: The records, played again.
        reported: The evaluation's own results.
        expected: The matches of the suite by track; None if they are not known.
    """
    for one in replayed:
        if one.spec is not None and expected is not None:
            specs = expected.get(one.track, ())
            if one.index >= len(specs) or specs[one.index] != one.spec:
                yield f"{one.record}: is not match {one.index} of the suite"
    found = {(one.track, one.submission): one for one in recompute(replayed, reported)}
    for evaluation in reported.evaluations:
        yield from _differences(evaluation, found.pop((evaluation.track, evaluation.submission)))
    for track, submission in found:
        yield f"{submission} on {track}: there are records, but no results"


def _differences(reported: Evaluation, found: Evaluation) -> Iterator[str]:
    who = f"{reported.submission} on {reported.track}"
    rows = {row.index: row for row in reported.matches}
    for row in found.matches:
        before = rows.get(row.index)
        if before is None:
            yield f"{who}, match {row.index}: there is a record, but no result"
        elif before.record is not None and row.record is None:
            yield f"{who}, match {row.index}: its record is missing or does not hold"
        elif _scored(before) != _scored(row):
            yield f"{who}, match {row.index}: the results say {_metrics(before)}, its record {_metrics(row)}"
    if reported.metrics != found.metrics:
        yield f"{who}: its metrics are described differently"
    for name in {**reported.summary, **found.summary}:
        if reported.summary.get(name) != found.summary.get(name):
            was, now = _statistics(reported, name), _statistics(found, name)
            yield f"{who}: {name} is {was}, its records give {now}"


def _scored(row: MatchRow) -> tuple[object, ...]:
    """Return the part of a match's result that a record can prove."""
    return row.metrics, row.record, [(seat.seat, seat.metrics) for seat in row.seats]


def _metrics(row: MatchRow) -> str:
    if row.metrics is None:
        return "nothing"
    return ", ".join(f"{name} {value}" for name, value in row.metrics.items())


def _statistics(evaluation: Evaluation, name: str) -> str:
    statistics = evaluation.summary.get(name)
    return "missing" if statistics is None else f"{statistics.mean} ({statistics.low} to {statistics.high})"
