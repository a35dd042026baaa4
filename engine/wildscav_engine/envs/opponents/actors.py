"""Players at work: from the state of the matches to rows of actions."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.opponents.observed import Seated, Settings
from wildscav_engine.envs.settings.players import Indices, PolicyOpponent, SeatController
from wildscav_engine.envs.spaces.actions import ActionError
from wildscav_engine.envs.spaces.observation import Observation
from wildscav_engine.simulation.setup.match_setup import seed_of_seat
from wildscav_engine.specs.actions import FIELDS

if TYPE_CHECKING:
    from wildscav_engine.simulation.batch import Batch


class PolicyActor:
    """A policy that fills seats."""

    def __init__(self, opponent: PolicyOpponent, settings: Settings, first: int, places: int) -> None:
        """Wrap a policy; ``first`` is the first of the ``places`` seats behind the learners'."""
        self.name, self.settings, self.has_memory = opponent.name, settings, opponent.is_stateful
        self._policy: Any = opponent.policy
        self._first, self._places = first, places

    def begin(self, batch: "Batch", seated: Seated) -> None:
        """Begin new episodes in some seats."""
        if not self.has_memory:
            return
        pairs = zip(seated.matches.tolist(), seated.seats.tolist(), strict=True)
        seeds = [seed_of_seat(batch.specs[match], seat) for match, seat in pairs]
        self._policy.reset(self._rows(seated), np.array(seeds, np.uint64))

    def act(self, batch: "Batch", seated: Seated, observation: Observation) -> NDArray[np.float32]:
        """Return (N, FIELDS) the rows of actions of some seats."""
        if self.has_memory:
            chosen = self._policy.act(observation, self._rows(seated))
        else:
            chosen = self._policy(observation)
        rows = np.zeros((len(seated.matches), FIELDS), np.float32)
        yaws = batch.state.agents.yaw[seated.matches, seated.seats]
        try:
            self.settings.mode.decode(chosen, yaws, rows, (len(rows),))
        except (TypeError, ValueError) as error:
            raise ActionError(f"the opponent {self.name!r}: {error}") from error
        return rows

    def _rows(self, seated: Seated) -> Indices:
        """Return the numbers of seats among all seats that policies may fill."""
        return seated.matches * self._places + (seated.seats - self._first)


class ControllerActor:
    """A controller that fills seats."""

    has_memory = True

    def __init__(self, controller: SeatController) -> None:
        """Wrap a controller."""
        self.name, self._controller = controller.name, controller

    def begin(self, batch: "Batch", seated: Seated) -> None:
        """Begin new episodes in some seats."""
        self._controller.begin(batch, seated.matches, seated.seats)

    def act(self, batch: "Batch", seated: Seated) -> NDArray[np.float32]:
        """Return (N, FIELDS) the rows of actions of some seats."""
        rows = np.asarray(self._controller.act(batch, seated.matches, seated.seats))
        wanted = (len(seated.matches), FIELDS)
        if rows.shape != wanted or rows.dtype.kind not in "fiu":
            raise ActionError(
                f"the opponent {self.name!r}: actions are {rows.dtype} of shape {rows.shape}, "
                f"must be numbers of shape {wanted}"
            )
        return rows


Actor = PolicyActor | ControllerActor
