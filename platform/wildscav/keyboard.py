"""A seat that is played by pixels and keys: it sees its screen and nothing else, and holds keys.

    from wildscav.keyboard import Frame, KeysPlayer
    from wildscav.policy.keys import MOUSE, Keys

    class MyAgent(KeysPlayer):
        def act(self, frame: Frame) -> Keys:
            return Keys(forward=True, mouse_x=10.0)

Its ``submission.toml`` says ``interface = "keys"``.
"""

import math
from dataclasses import asdict
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav.agent import MatchInfo
from wildscav.bridge import BridgedSeat
from wildscav.errors import AgentError
from wildscav.policy.keys import MOUSE, Keys


class Frame(NamedTuple):
    """What the screen of a seat shows before a step."""

    step: int  # number of the step that keys are wanted for
    pixels: NDArray[np.uint8]  # (height, width, 3), row 0 at the top; read-only


class KeysSeat(BridgedSeat):
    """A seat of a match that is played by keys."""

    def look(self) -> Frame | None:
        """Return what the screen shows now; None if the match is over."""
        return _frame(*self.ask("look"))

    def press(self, keys: Keys) -> Frame | None:
        """Hold keys for a step, and return what the screen shows after it; None if the match is over.

        Raises:
            AgentError: These are no keys, or the mouse moves by a number that is not finite.
        """
        if not isinstance(keys, Keys) or not math.isfinite(keys.mouse_x + keys.mouse_y):
            raise AgentError(f"keys are {keys!r}, must be Keys, such as Keys(forward=True, mouse_x=50.0)")
        held = {name: float(value) if name in MOUSE else bool(value) for name, value in asdict(keys).items()}
        return _frame(*self.ask("press", **held))


def _frame(answer: dict[str, Any], content: bytes) -> Frame | None:
    if answer["over"]:
        return None
    shape = answer["height"], answer["width"], 3
    return Frame(answer["step"], np.frombuffer(content, np.uint8).reshape(shape))


class KeysPlayer:
    """Base of agents that play by keys: override ``act``, and ``reset`` if something must be set up before.

    One object plays one match.
    """

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""

    def act(self, frame: Frame) -> Keys:
        """Return what to hold in the next step."""
        raise NotImplementedError(f"{type(self).__name__} must have a method act(self, frame)")

    def play(self, seat: KeysSeat) -> None:
        """Play a match to its end."""
        self.reset(seat.match)
        frame = seat.look()
        while frame is not None:
            frame = seat.press(self.act(frame))
