"""Answers the requests of an agent that plays by pixels and keys."""

from collections.abc import Sequence
from dataclasses import fields
from typing import Any

from wildscav.agent import Observation
from wildscav.bridge import facts_of
from wildscav.policy.keys import MOUSE, Keys
from wildscav.sdk.connection import Connection
from wildscav_evaluator.bridge.agent_end import RequestError

NAMES = tuple(field.name for field in fields(Keys))
FARTHEST = 1e6  # counts of the mouse; a body turns by much fewer in a step


class KeysDesk:
    """Plays a seat by the keys that its agent holds.

    Args:
        connection: To the match, which has been joined.
        names: The display names of all seats, which no screen shows.

    Attributes:
        steps: How many steps were played.
    """

    def __init__(self, connection: Connection, names: Sequence[str]) -> None:  # noqa: ARG002
        self._connection = connection
        self._now: Observation | None = None  # None before the first one, and after the end
        self._step = 0
        self._is_over = False
        self.steps = 0

    def told(self) -> dict[str, Any]:
        """Return what the agent is told first."""
        return {"match": facts_of(self._connection.match)}

    async def answer(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Answer a request.

        Raises:
            RequestError: It cannot be answered.
        """
        if self._now is None and not self._is_over:
            self._see(await self._connection.first())
        name = request.pop("request")
        if name not in ("look", "press"):
            raise RequestError('requests are "look", and "press" with the keys that are held')
        if name == "press" and self._now is not None:
            action = keys_in(request).action(self._now, self._connection.match)
            self.steps += 1
            self._see(await self._connection.answer(self._now.step, action))
        return self._frame()

    def _see(self, observation: Observation | None) -> None:
        self._now, self._is_over = observation, observation is None
        self._step = self._step if observation is None else observation.step

    def _frame(self) -> tuple[dict[str, Any], bytes]:
        """Return what the screen shows."""
        about = {"step": self._step, "over": self._is_over}
        if self._now is None:
            return about, b""
        screen = self._now.sensor("screen")
        height, width, _ = screen.shape
        return about | {"width": width, "height": height}, screen.tobytes()


def keys_in(request: dict[str, Any]) -> Keys:
    """Return the keys that a request holds.

    Raises:
        RequestError: They are no keys.
    """
    for name, value in request.items():
        if name not in NAMES:
            raise RequestError(f"there is no key {name[:40]!r}; the keys are {', '.join(NAMES)}")
        is_number = type(value) in (int, float) and -FARTHEST <= value <= FARTHEST
        if not (is_number if name in MOUSE else type(value) is bool):
            allowed = f"a number within ±{FARTHEST:,.0f}" if name in MOUSE else "true or false"
            raise RequestError(f"{name} must be {allowed}")
    return Keys(**request)
