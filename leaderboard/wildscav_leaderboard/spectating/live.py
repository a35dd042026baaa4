"""Matches that are being played, for pages that show them while they run.

The conductor writes what the heartbeats of a match bring into a file: a line with its beginning, and one with
news for each heartbeat. The web server, which may be another process, sends these lines as they are: see
``streams.py``. The file is removed when the match has ended: from then on, its record tells everything.
"""

from collections.abc import Sequence
from pathlib import Path

from wildscav_engine.simulation.systems.zone import plan_zone
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.storage.files import write_whole
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.matches.snapshots import HEARTBEAT_INTERVAL, BoxSnapshot, Snapshot
from wildscav_stage.scene.document import (
    Box,
    Event,
    News,
    Samples,
    SeatSamples,
    Shots,
    Target,
    Trails,
    ZonePhase,
    differences,
)
from wildscav_stage.scene.trails import seats_shown, zone_events, zone_phases

SUFFIX = ".live"
NOT_PLAYED = "the match is not being played"
LOOK = 0.1  # s between two looks of the web server at a file
DELAY = HEARTBEAT_INTERVAL + LOOK  # s
COLUMNS = ("x", "z", "height", "yaw", "pitch", "health", "supplies")  # of a seat


def key_of(match: int) -> str:
    """Return the name of a season's match here."""
    return f"match-{match}"


class LiveMatches:
    """The files of running matches, in one folder. One process writes them; any number read.

    Args:
        folder: The folder, which is made.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self._followed: dict[str, _Followed] = {}

    def clear(self) -> None:
        """Remove all files, such as those of a conductor that was killed."""
        self._followed.clear()
        for path in self.folder.glob(f"*{SUFFIX}"):
            path.unlink(missing_ok=True)

    def path(self, key: str) -> Path:
        """Return the file of a match."""
        return self.folder / f"{key}{SUFFIX}"

    def add(self, key: str, spec: MatchSpec, names: Sequence[str], snapshots: Sequence[Snapshot]) -> None:
        """Write what a heartbeat brought; a match that is played again begins anew.

        Args:
            key: The name of the match.
            names: The display names of its seats.
            snapshots: Of its last moments, in their order. Those of a match whose first is missing are lost.

        Raises:
            OSError: The file cannot be written.
        """
        if snapshots and snapshots[0].first:
            beginning = _beginning(spec, names, snapshots[0])
            self.folder.mkdir(parents=True, exist_ok=True)
            write_whole(self.path(key), beginning.model_dump_json().encode() + b"\n")
            self._followed[key] = _Followed(beginning.zone)
        if snapshots and key in self._followed:
            news = self._followed[key].news(snapshots)
            with self.path(key).open("ab", buffering=0) as file:
                file.write(news.model_dump_json().encode() + b"\n")  # a whole line at once

    def end(self, key: str) -> None:
        """Remove the file of a match that is no longer being played."""
        self._followed.pop(key, None)
        self.path(key).unlink(missing_ok=True)


class _Followed:
    """A match that is being written: what was told of it."""

    def __init__(self, zone: list[ZonePhase]) -> None:
        self._zone, self._frame = zone, -1
        self._yaws: list[int] = []  # of the last moment
        self._boxes: dict[int, int] = {}  # places among all boxes, by their serials
        self._count = 0  # of all boxes

    def news(self, snapshots: Sequence[Snapshot]) -> News:
        """Return what some moments tell."""
        events = [Event(**each._asdict()) for snapshot in snapshots for each in snapshot.happened]
        before, self._frame = self._frame, snapshots[-1].frame
        events += [event for event in zone_events(self._zone, self._frame) if event.frame > before]
        boxes = [self._box(box) for snapshot in snapshots for box in snapshot.appeared]
        return News(
            samples=self._samples(snapshots),
            shots=_shots(snapshots),
            events=sorted(events, key=lambda event: event.frame),
            boxes=boxes,
            taken=[(self._boxes.pop(serial), frame) for each in snapshots for serial, frame in each.taken],
        )

    def _box(self, box: BoxSnapshot) -> Box:
        self._boxes[box.serial] = self._count
        self._count += 1
        return Box.about(box, appears=box.frame, taken=None)

    def _samples(self, snapshots: Sequence[Snapshot]) -> Samples:
        yaws = [self._unwrapped([seat.yaw for seat in snapshot.seats]) for snapshot in snapshots]
        return Samples(
            frames=differences([snapshot.frame for snapshot in snapshots]),
            seats=[
                SeatSamples(
                    yaw=differences([each[seat] for each in yaws]),
                    **{
                        name: differences([getattr(snapshot.seats[seat], name) for snapshot in snapshots])
                        for name in COLUMNS
                        if name != "yaw"
                    },
                )
                for seat in range(len(snapshots[0].seats))
            ],
        )

    def _unwrapped(self, yaws: list[int]) -> list[int]:
        """Return yaws that are at most half a turn from those of the moment before."""
        before = self._yaws or yaws
        self._yaws = [here - (here - was + 180) // 360 * 360 for was, here in zip(before, yaws, strict=True)]
        return self._yaws


def _shots(snapshots: Sequence[Snapshot]) -> Shots:
    shots = [shot for snapshot in snapshots for shot in snapshot.shots]
    columns = {"frames": "frame", "seats": "seat", "x": "x", "z": "z", "height": "height"}
    return Shots(**{name: differences([getattr(shot, of) for shot in shots]) for name, of in columns.items()})


def _beginning(spec: MatchSpec, names: Sequence[str], now: Snapshot) -> Trails:
    """Return the document of a match without its course."""
    track = TRACKS[spec.track]
    zone: list[ZonePhase] = []
    if track.has_zone:
        zone = zone_phases(plan_zone(track.zone(spec), spec.map.config.size, spec.seed))
    target = None
    if now.target is not None:
        x, height, z = now.target
        target = Target(x=x, z=z, height=height)
    nothing = {name: differences([]) for name in COLUMNS}
    return Trails(
        over=False,
        delay=DELAY,
        track=track.name,
        title=track.title,
        frames_per_second=FRAMES_PER_SECOND,
        frames=0,
        frame_limit=spec.frame_limit,
        ending="none",
        outcome="",
        target=target,
        seats=seats_shown(spec, tuple(names), None),
        samples=Samples(frames=[], seats=[SeatSamples(**nothing) for _ in names]),
        shots=Shots(frames=[], seats=[], x=[], z=[], height=[]),
        events=[],
        zone=zone,
        boxes=[],
    )
