"""Keys and a mouse: what a person holds in a step, and the action that becomes of it.

People in the browser, the action mode ``keys`` of environments and agents that answer with ``Keys`` play by
these numbers. A mouse moves by whole counts; 50 of them turn the view by a degree. A body turns no farther in
a step than the rules let it, and walks relative to where it looks at the end of the step.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

from wildscav.agent import ACTION_FIELDS, Action, MatchInfo, Observation
from wildscav.errors import AgentError
from wildscav.policy.elementary_functions import arctangent

COUNTS_PER_DEGREE = 50
MOST_COUNTS = 9000  # in a step: half a turn
FASTEST = 10.0  # m/s, with a key held
FRAMES_PER_SECOND = 50
CARRIED = 0.1  # s of turning that a mouse may be ahead of the body
AT_ONCE = 9000.0  # degrees/s, the speed of turning without a limit
WALKS, MOUSE = ("forward", "back", "left", "right"), ("mouse_x", "mouse_y")
FLAGS = tuple(name for name, kind in ACTION_FIELDS.items() if kind is bool)


@dataclass(frozen=True, slots=True)
class Keys:
    """What is held during a step, and how far the mouse moves in it. The default holds nothing."""

    forward: bool = False  # walk where the body looks at the end of the step, at 10 m/s
    back: bool = False  # walk the other way
    left: bool = False  # walk to the left
    right: bool = False  # walk to the right
    jump: bool = False  # as in an Action
    pick_up: bool = False  # the supply boxes within reach
    shoot: bool = False  # along the view
    reload: bool = False  # the weapon
    mouse_x: float = 0.0  # counts to the right, rounded to a whole number; 50 turn the view by a degree
    mouse_y: float = 0.0  # counts down

    def action(self, seen: Observation, match: MatchInfo) -> Action:
        """Return the action that these keys stand for in a step of a match; see ``action_with``."""
        most = most_counts(match.turn_speed, match.frames_per_action)
        return self.action_with(seen.yaw, most, match.frames_per_action)

    def action_with(self, yaw: float, most: int, frames: int) -> Action:
        """Return the action for a body that turns so many counts at most in a step of so many frames.

        Raises:
            AgentError: The mouse moves by a number that is not finite.
        """
        if not math.isfinite(self.mouse_x + self.mouse_y):
            raise AgentError(f"Keys: the mouse moves by {self.mouse_x}, {self.mouse_y}; both must be finite")
        right, down = (max(-most, min(most, round(counts))) for counts in (self.mouse_x, self.mouse_y))
        flags = {name: getattr(self, name) for name in FLAGS}
        walk = int(self.forward) - int(self.back), int(self.right) - int(self.left)
        return held_action(walk, (right, down), flags, yaw, frames)


def most_counts(turn_speed: float, frames: int) -> int:
    """Return how many counts of the mouse a body can turn in a step, at most half a turn."""
    return min(MOST_COUNTS, int(turn_speed * frames * COUNTS_PER_DEGREE / FRAMES_PER_SECOND))


def held_action(
    walk: tuple[float, float], mouse: tuple[int, int], flags: Mapping[str, bool], yaw: float, frames: int
) -> Action:
    """Return the action of a step in which something is held.

    Args:
        walk: Shares of the full speed forward and to the right, -1 to 1; a key that is held counts 1.
        mouse: Counts that the body turns to the right and looks down.
        flags: Which of ``FLAGS`` are set.
        yaw: Of the agent before the step, degrees.
    """
    forward, right = walk
    turned, looked = mouse[0] / COUNTS_PER_DEGREE, mouse[1] / COUNTS_PER_DEGREE
    length = math.sqrt(forward * forward + right * right)
    return Action(
        walk_direction=_wrap(yaw + turned + arctangent(right, forward)) if length else 0.0,
        walk_speed=FASTEST * min(1.0, length),
        turn=turned / frames,
        look=looked / frames,
        **flags,
    )


def _wrap(angle: float) -> float:
    """Return an angle as the same direction in (-180, 180] degrees."""
    turned = math.fmod(angle, 360.0)
    return turned + 360.0 if turned <= -180.0 else turned - 360.0 if turned > 180.0 else turned


class Mouse:
    """A mouse that may move faster than the body turns: the body follows it in the next steps.

    It is at most 0.1 s of turning ahead; what is beyond is lost.

    Attributes:
        left: Degrees that the body has not turned yet.
    """

    def __init__(self) -> None:
        self.left = 0.0

    def move(self, degrees: float) -> None:
        """Note a movement."""
        self.left += degrees

    def take(self, turn_speed: float, frames: int) -> int:
        """Return the whole counts that the body turns in a step, and keep the rest."""
        most = most_counts(turn_speed, frames)
        counts = max(-most, min(most, round(self.left * COUNTS_PER_DEGREE)))
        ahead = turn_speed * CARRIED
        self.left = max(-ahead, min(ahead, self.left - counts / COUNTS_PER_DEGREE))
        return counts
