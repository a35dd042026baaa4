"""An agent that walks straight to the target, whatever is in the way, to measure others by."""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs import SeatController
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED, Field
from wildscav_training.opponents.oracle import check_has_target
from wildscav_training.opponents.seat_messages import Indices

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch


class Straight(SeatController):
    """Walks straight to the target; it knows the target of a capture, too."""

    name = "straight"

    def check(self, track: str) -> None:
        """Check that a track has a target. See ``SeatController.check``."""
        check_has_target(self.name, track)

    def begin(self, batch: "Batch", matches: Indices, seats: Indices) -> None:
        """Do nothing: it has no memory."""

    def act(self, batch: "Batch", matches: Indices, seats: Indices) -> NDArray[np.float32]:
        """Return (N, FIELDS) rows of actions. See ``SeatController.act``."""
        rows = np.zeros((len(seats), FIELDS), np.float32)
        offsets = batch.state.matches.target[matches] - batch.state.agents.position[matches, seats]
        rows[:, Field.WALK_DIRECTION] = np.degrees(np.arctan2(offsets[:, 0], offsets[:, 2])) % 360.0
        rows[:, Field.WALK_SPEED] = MAX_WALK_SPEED
        return rows
