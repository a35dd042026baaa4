"""The trails of a recorded match: the record is played again by the engine, and sampled."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.record import Record, resimulate
from wildscav_engine.sensors.optics.object_parts import colors_of_bodies
from wildscav_engine.simulation.state import NOBODY, State
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.result import SeatResult
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view.outcome import describe_outcome
from wildscav_engine.view.recording.history import History, collect_history, seats_where
from wildscav_stage.scene.document import (
    Box,
    Circle,
    Event,
    Samples,
    SeatResultShown,
    SeatSamples,
    SeatShown,
    Shots,
    Target,
    Trails,
    ZonePhase,
    differences,
)
from wildscav_stage.scene.map_file import centimetres

SAMPLE_INTERVAL = 5  # frames, at least, between two samples: ten a second
MANY = 250  # seats; with so many times as many, two samples are so many times farther apart


def trails_of(record: Record) -> Trails:
    """Return the trails of a record, which is played again.

    Raises:
        RecordError: It cannot be played again with this engine.
    """
    match, history = collect_history(resimulate(record), record.steps, None)
    zone = zone_phases(match.state.matches.zone[0, : int(match.state.matches.phases[0])])
    track = TRACKS[record.spec.track]
    return Trails(
        over=match.over,
        track=track.name,
        title=track.title,
        frames_per_second=FRAMES_PER_SECOND,
        frames=match.frame,
        frame_limit=record.spec.frame_limit,
        ending=record.result.ending,
        outcome=describe_outcome(record.result, record.names),
        target=target_of(match.state),
        seats=seats_shown(record.spec, record.names, record.result.seats),
        samples=_samples(history),
        shots=_shots(history),
        events=sorted([*_events(history), *zone_events(zone, match.frame)], key=lambda event: event.frame),
        zone=zone,
        boxes=_boxes(history),
    )


def cm(metres: float) -> int:
    """Return a length or coordinate in m as whole centimetres."""
    return int(centimetres(metres))


def seats_shown(
    spec: MatchSpec, names: tuple[str, ...], results: tuple[SeatResult, ...] | None
) -> list[SeatShown]:
    """Return the seats of a match, with their results once it has ended."""
    bodies = colors_of_bodies(max(spec.team_of_seats) + 1)
    return [
        SeatShown(
            seat=seat,
            name=name,
            kind=spec.seats[seat],
            team=spec.team_of_seats[seat],
            colors=np.rint(bodies[spec.team_of_seats[seat]]).astype(int).tolist(),
            full_health=spec.equipment_of(seat).health,
            result=None if results is None else SeatResultShown.about(results[seat]),
        )
        for seat, name in enumerate(names)
    ]


def target_of(state: State) -> Target | None:
    """Return the target of a match; None if it has none."""
    if not state.matches.has_target[0]:
        return None
    x, height, z = state.matches.target[0]
    return Target(x=cm(x), z=cm(z), height=cm(height))


def zone_phases(rows: NDArray[np.float64]) -> list[ZonePhase]:
    """Return the phases of a safe zone, from (Z, 9) rows as in ``Matches.zone``."""
    return [
        ZonePhase(
            start=round(row[0]),
            end=round(row[1]),
            before=_circle(row[2:5]),
            after=_circle(row[5:8]),
        )
        for row in rows.tolist()
    ]


def _circle(numbers: list[float]) -> Circle:
    x, z, radius = map(cm, numbers)
    return Circle(x=x, z=z, radius=radius)


def zone_events(zone: list[ZonePhase], frames: int) -> list[Event]:
    """Return the beginnings and ends of the shrinking of a zone in the first frames of a match."""
    moments = [(frame, amount) for phase in zone for frame, amount in ((phase.start, 1), (phase.end, 0))]
    return [Event(frame=frame, kind="zone", amount=amount) for frame, amount in moments if frame <= frames]


def _samples(history: History) -> Samples:
    agents = history.agents
    # The first row of every interval, and the last row, which shows how the match ended.
    interval = SAMPLE_INTERVAL * max(1, len(history.teams) // MANY)
    first = np.flatnonzero(np.diff(history.frame // interval, prepend=-1))
    rows = np.union1d(first, history.rows[-1:])
    places = centimetres(agents.position[rows])
    columns = {
        **{name: places[..., axis] for axis, name in enumerate(("x", "height", "z"))},
        "yaw": np.rint(np.unwrap(agents.yaw[rows], axis=0, period=360.0)),
        "pitch": np.rint(agents.pitch[rows]),
        "health": agents.health[rows],
        "supplies": agents.supplies[rows],
    }
    return Samples(
        frames=_differences(history.frame[rows]),
        seats=[
            SeatSamples(**{name: _differences(values[:, seat]) for name, values in columns.items()})
            for seat in range(len(history.teams))
        ],
    )


def _differences(values: NDArray[Any]) -> list[int]:
    return differences(values.astype(int).tolist())


def _shots(history: History) -> Shots:
    agents = history.agents
    rows, seats = np.nonzero(agents.fired)
    x, height, z = centimetres(agents.shot_end[rows, seats]).T
    columns = {"frames": history.frame[rows], "seats": seats, "x": x, "z": z, "height": height}
    return Shots(**{name: _differences(values) for name, values in columns.items()})


def _events(history: History) -> Iterator[Event]:
    """Yield what agents did, one kind after the other."""
    agents, frame = history.agents, history.frame.tolist()
    for row, seat, other in history.hits():
        left = int(agents.health[row, other])
        yield Event(frame=frame[row], kind="hit", seat=seat, other=other, amount=left)
    for row, seat, by, is_out in history.deaths():
        other_seat = None if by == NOBODY else by
        yield Event(frame=frame[row], kind="out" if is_out else "death", seat=seat, other=other_seat)
    alive = agents.health > 0
    for row, seat in seats_where(alive[1:] & ~alive[:-1]):
        yield Event(frame=frame[row + 1], kind="respawn", seat=seat)
    for row, seat in seats_where(agents.gained > 0):
        yield Event(frame=frame[row], kind="pick_up", seat=seat, amount=int(agents.gained[row, seat]))
    arrival = history.arrival()
    if arrival is not None:
        row, seat = arrival
        yield Event(frame=frame[row], kind="target", seat=seat)


def _boxes(history: History) -> list[Box]:
    """Return all boxes, in the order in which they appear."""
    boxes: dict[int, Box] = {}
    present: set[int] = set()
    for change in history.boxes:
        frame = int(history.frame[change.row])
        now = change.serial.tolist()
        for serial in present.difference(now):
            boxes[serial] = boxes[serial].model_copy(update={"taken": frame})
        for place, serial in enumerate(now):
            if serial not in present:
                x, height, z = change.position[place]
                boxes[serial] = Box(
                    x=cm(x),
                    z=cm(z),
                    height=cm(height),
                    dropped=serial >= history.first_dropped,
                    quantity=int(change.quantity[place]),
                    appears=frame,
                    taken=None,
                )
        present = set(now)
    return list(boxes.values())
