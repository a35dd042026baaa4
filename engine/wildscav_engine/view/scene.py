"""The Rerun recording of one match, put together."""

from hashlib import blake2b
from typing import Any

import rerun as rr

from wildscav_engine.actions import Field
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record import Record
from wildscav_engine.tracks import TRACKS
from wildscav_engine.view import actors, follow, scenery, things, zone
from wildscav_engine.view.blueprint import Layout, blueprint
from wildscav_engine.view.columns import send
from wildscav_engine.view.events import event_columns, events_of
from wildscav_engine.view.history import History

APPLICATION = "wildscav"


def render(record: Record, game_map: GameMap, history: History, seat: int) -> bytes:
    """Return the file's content.

    Args:
        record: What the history came from.
        game_map: The match's map.
        history: All that happened.
        seat: Whom the cameras follow.
    """
    names = actors.distinct(record.names)
    layout = Layout(names, seat, _plots(record), history.depth is not None, record.spec.map.config.size)
    recording = rr.RecordingStream(APPLICATION, recording_id=_identity(record, layout), send_properties=False)
    memory = recording.memory_recording()
    recording.send_blueprint(blueprint(history, layout))
    _describe(recording, record)
    statics = (
        *scenery.static_scene(game_map),
        *things.static_things(history, record.spec.rules.target_distance),
        *zone.static_zone(history),
        *actors.static_agents(history, names),
        *follow.static_cameras(history),
    )
    for path, looks in statics:
        recording.log(path, looks, static=True)
    for columns in (
        *actors.moving_agents(history, names),
        *things.changing_things(history, game_map),
        *zone.moving_zone(history, game_map),
        *follow.moving_cameras(game_map, history, seat),
        event_columns(events_of(history, names)),
    ):
        send(recording, history, columns)
    return memory.drain_as_bytes()


def _identity(record: Record, layout: Layout) -> str:
    """The same record shown the same way is the same recording."""
    digest = blake2b(record.spec.model_dump_json().encode(), digest_size=8)
    digest.update(record.actions.tobytes() + repr(layout).encode())
    return f"{record.spec.track}-{digest.hexdigest()}"


def _plots(record: Record) -> tuple[str, ...]:
    """Return the measures that can change in a track, the most telling first."""
    track = TRACKS[record.spec.track]
    if Field.SHOOT in track.fields:
        return "health", "supplies", "ammo"
    return ("supplies",) if Field.PICK_UP in track.fields else ("distance",)


def _describe(recording: rr.RecordingStream, record: Record) -> None:
    """Write the name and the properties of the recording."""
    spec, result = record.spec, record.result
    recording.send_recording_name(f"{TRACKS[spec.track].title}: {', '.join(record.names)}")
    about: dict[str, Any] = {
        "track": spec.track,
        "map_size": spec.map.config.size,
        "map_seed": str(spec.map.seed),
        "seed": str(spec.seed),
        "steps": result.steps,
        "engine": record.engine_version,
    }
    recording.send_property("match", rr.AnyValues(**about))
    for seat, name in zip(result.seats, record.names, strict=True):
        values: dict[str, Any] = {"name": name, "filled_by": seat.filled_by, **seat.metrics}
        recording.send_property(f"result/seat_{seat.seat}", rr.AnyValues(**values))
