"""Answers the requests of an agent that plays by words."""

from collections.abc import Sequence
from typing import Any

from wildscav.agent import Observation
from wildscav.bridge import facts_of
from wildscav.sdk.connection import Connection
from wildscav_evaluator.bridge.agent_end import RequestError
from wildscav_language.calls import Reason
from wildscav_language.pictures import picture
from wildscav_language.player import Player
from wildscav_language.rules_text import rules

OVER = "The match is over."


class WordsDesk:
    """Plays a seat by the calls of its agent.

    Args:
        connection: To the match, which has been joined.
        names: The display names of all seats.

    Attributes:
        steps: How many steps were played.
    """

    def __init__(self, connection: Connection, names: Sequence[str]) -> None:
        self._connection = connection
        self._player = Player(connection.match, names)
        self._is_over = False
        self.steps = 0

    def told(self) -> dict[str, Any]:
        """Return what the agent is told first."""
        tools = [
            {"name": tool.name, "description": tool.description, "schema": tool.schema}
            for tool in self._player.tools
        ]
        match = self._connection.match
        return {"match": facts_of(match), "rules": rules(match), "tools": tools}

    async def answer(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Answer a request.

        Raises:
            RequestError: It cannot be answered.
        """
        if not self._player.has_seen and not self._is_over:
            self._see(await self._connection.first())
        match request:
            case {"request": "observe"}:
                return self._about(text=OVER if self._is_over else self._player.text()), b""
            case {"request": "call", "tool": str(name), "arguments": dict(arguments)}:
                return await self._call(name, arguments), b""
            case {"request": "picture"}:
                return self._about(), self._picture(marks=request.get("marks") is True)
        raise RequestError('requests are "observe", "call" with a "tool" and its "arguments", and "picture"')

    async def _call(self, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """Play a tool until it ends."""
        player = self._player
        if not self._is_over:
            try:
                player.give(name, arguments)
            except RecursionError:
                raise RequestError("the arguments are nested too deeply") from None
        while not self._is_over and (action := player.action()) is not None:
            self.steps += 1
            self._see(await self._connection.answer(player.body.now.step, action))
        if self._is_over:
            return self._about(text=OVER, ended=Reason.MATCH_OVER, steps=player.steps)
        reply = player.reply
        return self._about(text=reply.text, ended=reply.ended, steps=reply.steps)

    def _see(self, observation: Observation | None) -> None:
        if observation is None:
            self._is_over = True
        else:
            self._player.see(observation)

    def _about(self, **answer: Any) -> dict[str, Any]:
        """Return an answer, with what all answers tell."""
        step = self._player.body.now.step if self._player.has_seen else 0
        return {**answer, "step": step, "over": self._is_over}

    def _picture(self, *, marks: bool) -> bytes:
        if not self._player.has_seen:
            raise RequestError(OVER)
        now = self._player.body.now
        if "camera" not in now.tensors:
            raise RequestError("this seat has no camera: its submission.toml needs pictures = true")
        return picture(now.tensors["camera"], now, marks=marks)
