"""What the desks of all interfaces share: they play a seat over the match's socket as its agent asks."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from wildscav.agent import Action, MatchInfo, Observation
from wildscav.sdk.connection import Connection


class Order(NamedTuple):
    """What the process of a bridge is told of a seat to serve."""

    interface: str  # "words" or "keys"
    socket: int  # descriptor of the socket that listens for its agent
    token: str  # by which its agent takes the seat; the match knows another one
    address: str  # of the match's socket
    match_token: str  # of the seat there
    names: Sequence[str]  # the display names of all seats


class RequestError(Exception):
    """A request cannot be answered; the message is a sentence that says what is allowed."""


class Desk:
    """Answers the requests of one agent by a connection that has joined the match.

    Attributes:
        now: What the seat senses; None before the first observation.
        is_over: Whether the match is.
        steps: How many steps were played.
    """

    def __init__(self, connection: Connection, names: Sequence[str]) -> None:
        self._connection, self._names = connection, names
        self._last = Action()
        self.now: Observation | None = None
        self.is_over = False
        self.steps = 0

    @property
    def match(self) -> MatchInfo:
        """What is known of the match."""
        return self._connection.match

    def introduction(self) -> dict[str, Any]:
        """Return what the agent is told of the match besides its facts."""
        return {}

    async def answer(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Return the answer to a request, and the bytes that follow it.

        Raises:
            RequestError: It cannot be answered.
        """
        raise NotImplementedError

    async def look(self) -> None:
        """Sense for the first time, or anew if the world went on while the agent thought."""
        if self.now is None and not self.is_over:
            self._see(await self._connection.first())
        elif self.match.clock == "running":
            last = self._last  # an answer brings the newest observation, and this one is what holds anyway
            await self.play(Action(walk_direction=last.walk_direction, walk_speed=last.walk_speed))
            self.steps -= 1

    async def play(self, action: Action) -> None:
        """Play a step, unless the match is over."""
        if self.now is None or self.is_over:
            return
        self._last = action
        self.steps += 1
        self._see(await self._connection.answer(self.now.step, action))

    def _see(self, observation: Observation | None) -> None:
        self.is_over = observation is None
        self.now = observation or self.now

    def about(self, **answer: Any) -> dict[str, Any]:
        """Return an answer, with what all answers tell."""
        return {**answer, "step": 0 if self.now is None else self.now.step, "over": self.is_over}
