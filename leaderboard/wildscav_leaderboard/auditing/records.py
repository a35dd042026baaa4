"""Records of matches: whether they are those that were published, and what happened in them.

A record says itself how its match ended, and that is believed only if the match, played again, ends so.
"""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from wildscav.errors import describe
from wildscav_engine.maps import GENERATOR_VERSION
from wildscav_engine.record import FILE_LIMIT, Record, RecordError, verify_record
from wildscav_engine.record.format import WITHOUT_SEEDS, decode
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.storage.files import read_limited, write_whole
from wildscav_engine.version import SIMULATION_VERSION, advice
from wildscav_evaluator.output.results import Versions
from wildscav_evaluator.seats import display_names, submission_seats
from wildscav_leaderboard.auditing.sources import FolderSource, Source, SourceError
from wildscav_leaderboard.matches.models import LADDER
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.publishing.documents import PublishedMatch
from wildscav_leaderboard.publishing.export import record_address


class Fetched(NamedTuple):
    """A record as it was downloaded."""

    match: PublishedMatch
    content: bytes = b""
    fault: str = ""  # why it cannot be read, or is not the one that was published


class Task(NamedTuple):
    """A record to check, as it travels to the process that does."""

    fetched: Fetched
    track: str
    versions: Versions  # under which the board's matches were played
    replay: bool  # whether to play it again


@dataclass(frozen=True)
class Recorded:
    """What a record says of its match."""

    match: int
    faults: tuple[str, ...] = ()  # what is wrong with it
    spec: MatchSpec | None = None
    seeds: tuple[int, ...] = ()  # that its seats were told; none if it is of a version that kept none
    metrics: dict[int, dict[str, float]] | None = None  # of each seat; None if the record cannot be read
    replayed: bool = False  # whether the match was played again, and ended as the record says
    unplayed: str = ""  # why it could not be played again here


def fetcher(source: Source, template: str, cache: Path) -> Callable[[PublishedMatch], Fetched]:
    """Return a function that fetches the record of a match. It may be called from several threads.

    What was downloaded once is kept by its digest, so an audit that was interrupted, or is repeated, goes on
    where the last one ended.

    Args:
        cache: The folder of those that were downloaded before.
    """

    def fetch(match: PublishedMatch) -> Fetched:
        digest = str(match.record)
        kept = cache / digest[:2] / digest
        is_kept = not isinstance(source, FolderSource)
        try:
            if (
                is_kept
                and kept.is_file()
                and record_digest(content := read_limited(kept, FILE_LIMIT)) == digest
            ):
                return Fetched(match, content)
            content = source.read(record_address(template, match.id), FILE_LIMIT)
            if (found := record_digest(content)) != digest:
                return Fetched(
                    match, content, f"its record has the digest {found}, and {digest} is published"
                )
            if is_kept:
                kept.parent.mkdir(parents=True, exist_ok=True)
                write_whole(kept, content)
            return Fetched(match, content)
        except SourceError as error:
            return Fetched(match, fault=f"its record cannot be read: {error}")
        except OSError as error:
            return Fetched(match, fault=f"its record cannot be kept: {describe(error)}")

    return fetch


def check_record(task: Task) -> Recorded:
    """Check a record; what is wrong is returned, so that the others are still checked."""
    fetched = task.fetched
    if fetched.fault:
        return Recorded(fetched.match.id, (fetched.fault,))
    try:
        record = decode(fetched.content)
    except RecordError as error:
        return Recorded(fetched.match.id, (f"its record cannot be read: {error}",))
    faults = [fault for fault in (_wrong_seats(record, task), _wrong_versions(record, task)) if fault]
    unplayed, replayed = "", False
    if task.replay and not faults:
        unplayed = _other_version(record)
        if not unplayed:
            found = verify_record(record)
            replayed = found.holds
            faults += [] if found.holds else [f"its record, played again: {found.message}"]
    metrics = None
    if not faults:
        metrics = {seat.seat: dict(record.result.seats[seat.seat].metrics) for seat in fetched.match.seats}
    seeds = () if record.version == WITHOUT_SEEDS else record.seeds
    return Recorded(fetched.match.id, tuple(faults), record.spec, seeds, metrics, replayed, unplayed)


def _wrong_seats(record: Record, task: Task) -> str:
    """Return in what the seats of a record are not those that are published; an empty text if they are."""
    match, spec = task.fetched.match, record.spec
    if spec.track != task.track:
        return f"its record is of {spec.track}"
    seats = {seat.seat: seat for seat in match.seats}
    entrants = submission_seats(spec.seats) if match.kind != LADDER else tuple(range(len(spec.seats)))
    if tuple(sorted(seats)) != entrants:
        return f"its entrants are in the seats {sorted(seats)}, in its record in {list(entrants)}"
    for seat, one in seats.items():
        filled = spec.seats[seat]
        right = SUBMISSION if one.submission is not None else one.entrant.partition(":")[2]
        if filled != right:
            return f"seat {seat} is filled by {filled}, and belongs to {one.entrant}"
    names = [one.entrant for _, one in sorted(seats.items()) if one.submission is not None]
    robots = [seat for seat, one in seats.items() if one.submission is None]
    expected = display_names(spec.seats, names, robots)
    return "" if record.names == expected else f"its record is of {record.names}, and not of {expected}"


def _wrong_versions(record: Record, task: Task) -> str:
    found = record.simulation_version, record.generator_version
    expected = task.versions.simulation, task.versions.generator
    if found == expected:
        return ""
    return "its record was played with simulation {} and generator {}, the board says {} and {}".format(
        *found, *expected
    )


def _other_version(record: Record) -> str:
    """Return why this version cannot play a record again; an empty text if it can."""
    if (record.simulation_version, record.generator_version) == (SIMULATION_VERSION, GENERATOR_VERSION):
        return ""
    return f"only the engine that played them can play them again: {advice(record.engine_version)}"
