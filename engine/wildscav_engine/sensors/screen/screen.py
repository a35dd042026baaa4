"""The screen of a person who plays: the picture of a camera with the display over it."""

from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from wildscav_engine.sensors.base import sensor
from wildscav_engine.sensors.optics.camera import ColorCamera
from wildscav_engine.sensors.screen.display import draw_displays
from wildscav_engine.simulation.track import TRACKS
from wildscav_engine.specs.actions import Field as ActionField

if TYPE_CHECKING:
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen


@sensor
class Screen(ColorCamera):
    """Images in red, green and blue, with health, ammunition, supplies, time, compass and hits over them.

    Views from other places than the eyes of an agent have no display.
    """

    height: Annotated[int, Field(ge=1, le=1080)] = 120  # rows of pixels

    name: ClassVar[str] = "screen"
    title: ClassVar[str] = "what a person who plays sees: the camera's image with a display over it, 0-255"
    has_display: ClassVar[bool] = True

    def draw_over(
        self, state: "State", seen: "Seen", track: str, seats: NDArray[np.int64], images: NDArray[np.uint8]
    ) -> None:
        """Draw the display of each seat over its picture."""
        agents, supplies, matches = (table.addresses for table in state.tables)
        seen_now = seen.supplies, seen.agents, seen.can_pick_up
        shoots, picks_up = (flag in TRACKS[track].fields for flag in (ActionField.SHOOT, ActionField.PICK_UP))
        draw_displays(agents, supplies, matches, *seen_now, seats, shoots, picks_up, images)
