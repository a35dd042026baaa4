"""A flat world without an engine, in which a player of words walks, turns and picks up boxes."""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from tests.platform.wildscav.skills.observations import match_info, seen

from wildscav import Action, SupplyBox, Vector, VisibleAgent
from wildscav.geometry import distance, moved
from wildscav.words import Reply
from wildscav_language.player import Player

OPEN = np.full((30, 96), 60.0, np.float32)  # what the LIDAR reads where nothing is
STEP = 0.1  # s


class FlatWorld:
    """A player's world.

    Args:
        names: Of the seats.
        match: Changes of the match's info.
    """

    def __init__(self, names: tuple[str, ...] = (), **match: Any) -> None:
        self.player = Player(match_info(**match), names)
        self.step = 0
        self.position: Vector = (0.0, 0.0, 0.0)
        self.yaw = 0.0
        self.boxes: dict[int, SupplyBox] = {}
        self.agents: tuple[VisibleAgent, ...] = ()
        self.walled = False  # whether no step leads anywhere
        self.gained = 0
        self.changes: Mapping[str, Any] = {}  # of observations
        self.actions: list[Action] = []
        self.at: dict[int, Callable[[], None]] = {}  # what happens before a step

    def put_box(self, number: int, position: Vector, quantity: int = 5) -> None:
        """Put a box there."""
        self.boxes[number] = SupplyBox(number, position, quantity)

    def look(self) -> None:
        """Show the player what there is now."""
        told = {
            "step": self.step,
            "frame": 5 * self.step,
            "time": STEP * self.step,
            "position": self.position,
            "yaw": self.yaw,
            "gained": self.gained,
            "supply_boxes": tuple(self.boxes.values()),
            "agents": self.agents,
            "tensors": {"lidar": OPEN},
        }
        self.player.see(seen(**told | dict(self.changes)))

    def call(self, name: str, arguments: Mapping[str, Any] | None = None, most: int = 700) -> Reply:
        """Play a tool to its end."""
        self.look()
        self.player.give(name, arguments or {})
        for _ in range(most):
            action = self.player.action()
            if action is None:
                return self.player.reply
            self.actions.append(action)
            self._play(action)
        raise TimeoutError(f"{name} did not end")

    def _play(self, action: Action) -> None:
        self.step += 1
        if not self.walled:
            self.position = moved(self.position, action.walk_direction, action.walk_speed * STEP)
        self.yaw = (self.yaw + 5 * action.turn + 180.0) % 360.0 - 180.0
        self.gained = 0
        for number, box in list(self.boxes.items()):
            if action.walk_speed and distance(self.position, box.position) < 1.5:
                self.gained += self.boxes.pop(number).quantity
        self.at.get(self.step, lambda: None)()
        self.look()
