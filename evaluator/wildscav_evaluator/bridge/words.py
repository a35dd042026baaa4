"""Answers the requests of an agent that plays by words."""

import asyncio
from collections.abc import Sequence
from typing import Any

from wildscav.agent import Observation
from wildscav.sdk.connection import Connection
from wildscav_evaluator.bridge.desk import Desk, RequestError
from wildscav_language.calls import Reason
from wildscav_language.pictures import picture
from wildscav_language.player import Player
from wildscav_language.rules_text import rules

OVER = "The match is over."


class WordsDesk(Desk):
    """Plays a seat by the calls of its agent. See ``Desk``."""

    def __init__(self, connection: Connection, names: Sequence[str]) -> None:
        super().__init__(connection, names)
        self._player = Player(self.match, names)

    def introduction(self) -> dict[str, Any]:
        """Return the rules and the tools."""
        tools = [
            {"name": tool.name, "description": tool.description, "schema": tool.schema}
            for tool in self._player.tools
        ]
        return {"rules": rules(self.match), "tools": tools}

    async def answer(self, request: dict[str, Any]) -> tuple[dict[str, Any], bytes]:
        """Answer a request. See ``Desk.answer``."""
        await self.look()
        match request:
            case {"request": "observe"}:
                return self.about(text=OVER if self.is_over else self._player.text()), b""
            case {"request": "call", "tool": str(name), "arguments": dict(arguments)}:
                return await self._call(name, arguments), b""
            case {"request": "picture"}:
                return self.about(), await self._picture(marks=request.get("marks") is True)
        raise RequestError('requests are "observe", "call" with a "tool" and its "arguments", and "picture"')

    async def _call(self, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
        """Play a tool until it ends."""
        player = self._player
        if not self.is_over:
            try:
                player.give(name, arguments)
            except RecursionError:
                raise RequestError("the arguments are nested too deeply") from None
        while not self.is_over and (action := player.action()) is not None:
            await self.play(action)
        if self.is_over:
            return self.about(text=OVER, ended=Reason.MATCH_OVER, steps=player.steps)
        return self.about(text=player.reply.text, ended=player.reply.ended, steps=player.reply.steps)

    def _see(self, observation: Observation | None) -> None:
        super()._see(observation)
        if observation is not None:
            self._player.see(observation)

    async def _picture(self, *, marks: bool) -> bytes:
        image = None if self.now is None else self.now.tensors.get("camera")
        if self.now is None or image is None:
            raise RequestError("this seat has no camera: its submission.toml needs pictures = true")
        # In a thread, because other seats are served meanwhile.
        return await asyncio.to_thread(picture, image, self.now, marks=marks)
