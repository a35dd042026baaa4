"""Matches that are being played, for pages that show them while they run.

The conductor writes what the heartbeats of a match bring into a file, a line for each moment; the web server,
which may be another process, reads the lines that a page has not seen yet. The file is removed when the match
has ended: from then on, its record tells everything, and more exactly.
"""

import json
import re
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from wildscav_engine.simulation.systems.zone import plan_zone
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.storage.files import write_whole
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.matches.snapshots import Snapshot
from wildscav_stage.scene.document import (
    Event,
    Samples,
    SeatSamples,
    Shots,
    Target,
    Trails,
    ZonePhase,
    differences,
)
from wildscav_stage.scene.trails import (
    SAMPLE_INTERVAL,
    seats_shown,
    zone_events,
    zone_phases,
)

SUFFIX = ".live"
CURSOR = re.compile(r"([0-9a-f]{1,16})-([0-9]{1,12})")  # which playing of the match, and bytes of its file
COLUMNS = ("x", "z", "height", "yaw", "pitch", "health", "supplies")  # of a seat in a line


def key_of(match: int) -> str:
    """Return the name of a season's match here."""
    return f"match-{match}"


class Followed(NamedTuple):
    """A match that is being written, and its last moment."""

    header: Trails
    last: Snapshot  # whose yaws do not jump where a turn is whole


class LiveMatches:
    """The files of running matches, in one folder. One process writes them; any number read.

    Args:
        folder: The folder, which is made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._followed: dict[str, Followed] = {}

    def clear(self) -> None:
        """Remove all files, such as those of a conductor that was killed."""
        self._followed.clear()
        for path in self.folder.glob(f"*{SUFFIX}"):
            path.unlink(missing_ok=True)

    def add(self, key: str, spec: MatchSpec, names: Sequence[str], snapshots: Sequence[Snapshot]) -> None:
        """Write what a heartbeat brought; a match that is played again begins anew.

        Args:
            key: The name of the match.
            spec: The match.
            names: The display names of its seats.
            snapshots: Of its last moments, in their order.

        Raises:
            OSError: The file cannot be written.
        """
        lines = [line for each in snapshots if (line := self._line(key, spec, names, each)) is not None]
        if lines:
            with self._path(key).open("ab", buffering=0) as file:
                file.write(b"".join(lines))  # whole lines at once

    def end(self, key: str) -> None:
        """Remove the file of a match that is no longer being played."""
        self._followed.pop(key, None)
        self._path(key).unlink(missing_ok=True)

    def trails(self, key: str, after: str = "") -> Trails | None:
        """Return what a page has not seen yet of a running match; None if there is no such match.

        Args:
            key: The name of the match.
            after: The cursor of the last document that the page has; empty for the beginning.
        """
        try:
            with self._path(key).open("rb") as file:
                header = Trails.model_validate_json(file.readline())
                begun = file.tell()
                file.seek(seen := _seen(after, header.cursor, begun))
                content = file.read()
        except (FileNotFoundError, ValueError):
            return None
        whole = content[: content.rfind(b"\n") + 1]  # another line may be on its way
        return _document(header, seen == begun, f"{header.cursor}-{seen + len(whole)}", whole)

    def _path(self, key: str) -> Path:
        return self.folder / f"{key}{SUFFIX}"

    def _line(self, key: str, spec: MatchSpec, names: Sequence[str], now: Snapshot) -> bytes | None:
        """Return the line of a moment; None if it follows too closely on the last one."""
        followed = self._followed.get(key)
        if followed is None or now.frame < followed.last.frame:
            header = _header(spec, names, now)
            self.folder.mkdir(parents=True, exist_ok=True)
            write_whole(self._path(key), header.model_dump_json().encode() + b"\n")
            followed, events = Followed(header, now), []
        elif now.frame - followed.last.frame < SAMPLE_INTERVAL:
            return None
        else:
            now = _unwrapped(followed.last, now)
            of_zone = zone_events(followed.header.zone, now.frame)
            events = [event for event in of_zone if event.frame > followed.last.frame]
            events = [*_events(followed.last, now), *events]
        self._followed[key] = Followed(followed.header, now)
        line = {
            "frame": now.frame,
            "seats": [[getattr(seat, name) for name in COLUMNS] for seat in now.seats],
            "events": [event.model_dump() for event in events],
        }
        return json.dumps(line, separators=(",", ":")).encode() + b"\n"


def _header(spec: MatchSpec, names: Sequence[str], now: Snapshot) -> Trails:
    """Return the document of a match without its course; its cursor names this playing of the match."""
    track = TRACKS[spec.track]
    zone: list[ZonePhase] = []
    if track.has_zone:
        zone = zone_phases(plan_zone(track.zone(spec), spec.map.config.size, spec.seed))
    target = None
    if now.target is not None:
        x, height, z = now.target
        target = Target(x=x, z=z, height=height)
    return Trails(
        over=False,
        cursor=f"{time.time_ns():x}",
        track=track.name,
        title=track.title,
        frames_per_second=FRAMES_PER_SECOND,
        frames=0,
        frame_limit=spec.frame_limit,
        ending="none",
        outcome="",
        target=target,
        seats=seats_shown(spec, tuple(names), None),
        samples=Samples(frames=[], seats=[]),
        shots=Shots(frames=[], seats=[], x=[], z=[], height=[]),
        events=[],
        zone=zone,
        boxes=[],
    )


def _unwrapped(before: Snapshot, now: Snapshot) -> Snapshot:
    """Return a moment with yaws that are at most half a turn from those of the moment before."""
    turns = [(here.yaw - was.yaw + 180) // 360 for was, here in zip(before.seats, now.seats, strict=True)]
    seats = (seat._replace(yaw=seat.yaw - 360 * turn) for seat, turn in zip(now.seats, turns, strict=True))
    return now._replace(seats=tuple(seats))


def _events(before: Snapshot, now: Snapshot) -> Iterator[Event]:
    """Yield what must have happened between two moments."""
    killers = [
        seat
        for seat, pair in enumerate(zip(before.seats, now.seats, strict=True))
        if pair[1].kills > pair[0].kills
    ]
    for seat, (was, here) in enumerate(zip(before.seats, now.seats, strict=True)):
        if here.deaths > was.deaths:
            # Of several at one moment, nobody knows who shot whom; the record will tell.
            by = killers[0] if len(killers) == 1 and killers[0] != seat else None
            yield Event(frame=now.frame, kind="death", seat=seat, other=by)
        if here.health > 0 and (was.health <= 0 or here.deaths > was.deaths):
            yield Event(frame=now.frame, kind="respawn", seat=seat)
        if here.supplies > was.supplies:
            yield Event(frame=now.frame, kind="pick_up", seat=seat, amount=here.supplies - was.supplies)
    if now.reached_by is not None and before.reached_by is None:
        yield Event(frame=now.frame, kind="target", seat=now.reached_by)


def _seen(after: str, playing: str, begun: int) -> int:
    """Return how many bytes of a file a page has seen: those of the header, if it saw another playing."""
    cursor = CURSOR.fullmatch(after)
    if cursor is None or cursor[1] != playing:
        return begun
    return max(begun, int(cursor[2]))


def _document(header: Trails, is_first: bool, cursor: str, content: bytes) -> Trails:
    """Return a header with the moments of some lines."""
    lines: list[dict[str, Any]] = [json.loads(line) for line in content.splitlines()]
    seats = [
        SeatSamples(
            **{
                name: differences([line["seats"][seat][column] for line in lines])
                for column, name in enumerate(COLUMNS)
            }
        )
        for seat in range(len(header.seats))
    ]
    frames = [int(line["frame"]) for line in lines]
    return header.model_copy(
        update={
            "first": is_first,
            "cursor": cursor,
            "frames": frames[-1] if frames else header.frames,
            "samples": Samples(frames=differences(frames), seats=seats),
            "events": [Event(**event) for line in lines for event in line["events"]],
        }
    )
