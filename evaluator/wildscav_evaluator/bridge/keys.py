"""Answers the requests of an agent that plays by pixels and keys."""

from dataclasses import fields
from typing import Any

from wildscav.policy.keys import MOUSE, Keys
from wildscav_evaluator.bridge.desk import Desk, RequestError

NAMES = tuple(field.name for field in fields(Keys))
FARTHEST = 1e6  # counts of the mouse; a body turns by much fewer in a step


class KeysDesk(Desk):
    """Plays a seat by the keys that its agent holds. See ``Desk``."""

    async def answer(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Answer a request. See ``Desk.answer``."""
        name = request.pop("request")
        if name not in ("look", "press"):
            raise RequestError('requests are "look", and "press" with the keys that are held')
        keys = keys_in(request) if name == "press" else None
        if keys is None or self.now is None:
            await self.look()
        if keys is not None and self.now is not None:
            await self.play(keys.action(self.now, self.match))
        if self.now is None or self.is_over:
            return self.about(), b""
        screen = self.now.sensor("screen")
        height, width, _ = screen.shape
        return self.about(width=width, height=height), screen.tobytes()


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
