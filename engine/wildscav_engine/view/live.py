"""Live view: a match in a Rerun viewer while it is being played."""

from typing import Any

import numpy as np
import rerun as rr

from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.simulation.systems.supplies import is_present
from wildscav_engine.specs.body import BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.view.display import check_display
from wildscav_engine.view.entities import scenery
from wildscav_engine.view.recording import colors, coordinates

APPLICATION = "wildscav-live"
BODY = 1.0  # m, height of the point that marks a body
ARROW = 1.6  # m, length of the arrow in view direction
BOX = 0.3  # m, half the side of a supply box


def open_recording() -> rr.RecordingStream:
    """Return a recording that is shown by a viewer, which is opened if none is running.

    Raises:
        NoDisplayError: There is no display for a viewer.
    """
    check_display("rerun")
    recording = rr.RecordingStream(APPLICATION)
    recording.spawn()
    return recording


class LiveView:
    """Shows matches step by step. The viewer opens with the first match."""

    def __init__(self) -> None:
        """Create a live view without opening a viewer."""
        self._recording: Any = None
        self._map: GameMap | None = None
        self._step = 0

    def begin(self, match: Any) -> None:
        """Show a new match, which may be any object with the properties of a ``Match``."""
        if self._recording is None:
            self._recording = open_recording()
        if match.game_map is not self._map:
            self._map = match.game_map
            self._recording.log("world", rr.Clear(recursive=True))
            for path, components in scenery.static_scene(match.game_map):
                self._recording.log(path, components)

    def show(self, match: Any) -> None:
        """Show the present positions of agents and supply boxes."""
        self._recording.set_time("step", sequence=self._step)
        self._step += 1
        self._show_agents(match)
        self._show_boxes(match)
        matches = match.state.matches
        if matches.has_target[0]:
            target = rr.Points3D([coordinates.points(matches.target[0])], radii=0.5, colors=[colors.TARGET])
            self._recording.log("target", target)

    def _show_agents(self, match: Any) -> None:
        agents = match.state.agents
        seats = np.flatnonzero(agents.health[0] > 0)
        positions = agents.position[0, seats] + np.array([0.0, BODY, 0.0])
        tints = [of_seat(int(team)) for team in agents.team[0, seats]]
        gaze = coordinates.directions(agents.yaw[0, seats], agents.pitch[0, seats]) * ARROW
        eyes = agents.position[0, seats] + np.array([0.0, EYE_HEIGHT, 0.0])
        labels = [f"{match.spec.seats[seat]} {seat}" for seat in seats]
        bodies = rr.Points3D(coordinates.points(positions), radii=BODY_RADIUS, colors=tints, labels=labels)
        self._recording.log("agents/bodies", bodies)
        arrows = rr.Arrows3D(vectors=coordinates.points(gaze), origins=coordinates.points(eyes), colors=tints)
        self._recording.log("agents/views", arrows)

    def _show_boxes(self, match: Any) -> None:
        supplies = match.state.supplies
        boxes = type(supplies)(*(array[0] for array in supplies))
        slots = [slot for slot in range(len(boxes.quantity)) if is_present(boxes, slot, match.frame)]
        centers = boxes.position[slots] + np.array([0.0, BOX, 0.0])
        crates = rr.Boxes3D(
            centers=coordinates.points(centers),
            half_sizes=[[BOX] * 3] * len(slots),
            colors=[colors.OUTDOOR_BOX],
        )
        self._recording.log("supplies", crates)

    def close(self) -> None:
        """End the recording; the viewer stays open."""
        if self._recording is not None:
            self._recording.flush()
            self._recording.disconnect()
            self._recording = None
            self._map = None
