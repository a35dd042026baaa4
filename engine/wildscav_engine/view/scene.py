"""The Rerun recording of one match: all entities, properties and the blueprint."""

from collections.abc import Iterator, Sequence
from hashlib import blake2b
from typing import Any

import rerun as rr

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record import Record
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view import standings
from wildscav_engine.view.blueprint import TRANSPARENT_PATHS, Layout, blueprint
from wildscav_engine.view.entities import agents, follow_cameras, ground_overlay, objects, scenery
from wildscav_engine.view.events import EVENTS, KILLS, event_columns, events_of, kills_of
from wildscav_engine.view.notes import drawn, said
from wildscav_engine.view.outcome import describe_outcome, format_time
from wildscav_engine.view.overview import overview
from wildscav_engine.view.recording.agent_notes import Note
from wildscav_engine.view.recording.columns import Columns, send
from wildscav_engine.view.recording.history import History


def render(
    record: Record, game_map: GameMap, history: History, seat: int, notes: Sequence[Note] = ()
) -> bytes:
    """Return the content of the file; the cameras follow a seat."""
    names = agents.distinct(record.names)
    overlay = ground_overlay.GroundOverlay(game_map.world)
    scene = dict(scenery.static_scene(game_map))
    layout = Layout(
        names,
        seat,
        plots=_plots(record, history),
        images=history.depth is not None,
        kills=Field.SHOOT in TRACKS[record.spec.track].fields,
        transparent=tuple(path for path in TRANSPARENT_PATHS if path in scene),
        own_plots=any(note.value is not None for note in notes),
    )
    identity = _identity(record, layout)
    # A viewer keeps one layout per application id. With a common id, a second replay that is opened in the
    # same viewer would get the layout of the first.
    recording = rr.RecordingStream(f"wildscav-{identity}", recording_id=identity, send_properties=False)
    memory = recording.memory_recording()
    recording.send_blueprint(blueprint(layout, overview(history, game_map.world)))
    _describe(recording, record)
    statics = (
        *scene.items(),
        *objects.static_objects(history, record.spec.rules.target_distance),
        *ground_overlay.static_heat(history),
        *ground_overlay.static_zone(history),
        *agents.static_agents(history, names),
        *follow_cameras.static_cameras(history),
        *standings.static_standings(),
    )
    for path, components in statics:
        recording.log(path, components, static=True)
    for columns in (
        *agents.moving_agents(history, names, health=layout.kills),
        *objects.changing_objects(history, game_map),
        *ground_overlay.moving_heat(history, overlay),
        *ground_overlay.moving_zone(history, game_map),
        *follow_cameras.moving_cameras(game_map, history, seat),
        standings.moving_standings(record, history, names, seat),
        *_logs(record, history, names, notes),
        *drawn(notes, history),
    ):
        send(recording, history, columns)
    return memory.drain_as_bytes()


def _logs(
    record: Record, history: History, names: tuple[str, ...], notes: Sequence[Note]
) -> Iterator[Columns]:
    """Yield the log of all events and the log of kills."""
    title = TRACKS[record.spec.track].title
    limit = format_time(round(record.spec.time_limit * FRAMES_PER_SECOND))
    count = "1 agent" if len(names) == 1 else f"{len(names)} agents"
    opening, ending = f"{title}: {count}, {limit} at most", describe_outcome(record.result, names)
    events = [*events_of(history, names, opening, ending), *said(notes, history, names)]
    yield event_columns(EVENTS, sorted(events, key=lambda event: event.row))
    yield event_columns(KILLS, kills_of(history, names))


def _identity(record: Record, layout: Layout) -> str:
    """Return the recording's id, which is the same for the same record in the same layout."""
    digest = blake2b(record.spec.model_dump_json().encode(), digest_size=8)
    digest.update(record.actions.tobytes() + repr(layout).encode())
    return f"{record.spec.track}-{digest.hexdigest()}"


def _plots(record: Record, history: History) -> tuple[str, ...]:
    """Return the quantities to plot, which are those that can change in the track, the score first."""
    track = TRACKS[record.spec.track]
    if history.target is not None:
        return ("distance",)
    supplies = ("team_supplies", "supplies") if history.has_teammates else ("supplies",)
    return (*supplies, "health", "ammo") if Field.SHOOT in track.fields else supplies


def _describe(recording: rr.RecordingStream, record: Record) -> None:
    """Write the name and the properties of the recording."""
    spec, result = record.spec, record.result
    recording.send_recording_name(f"{TRACKS[spec.track].title}: {', '.join(record.names)}")
    properties: dict[str, Any] = {
        "track": spec.track,
        "map_size": spec.map.config.size,
        "map_seed": str(spec.map.seed),
        "seed": str(spec.seed),
        "steps": result.steps,
        "engine": record.engine_version,
    }
    recording.send_property("match", rr.AnyValues(**properties))
    for seat, name in zip(result.seats, record.names, strict=True):
        values: dict[str, Any] = {"name": name, "filled_by": seat.filled_by, **seat.metrics}
        recording.send_property(f"result/seat_{seat.seat}", rr.AnyValues(**values))
