"""A seat that is played by words: texts to read and tools to call. docs/language.md has both.

    from wildscav.words import WordsPlayer, WordsSeat

    class MyAgent(WordsPlayer):
        def play(self, seat: WordsSeat) -> None:
            text = seat.observe()
            while not seat.is_over:
                text = seat.call("explore", {"seconds": 5}).text

Its ``submission.toml`` says ``interface = "words"``.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from wildscav.bridge import BridgedSeat
from wildscav.notes import say

SHOWN = 300  # characters of a call's arguments that its note has


@dataclass(frozen=True, slots=True)
class Tool:
    """Something that a seat may do, for many steps."""

    name: str  # by which it is called
    description: str  # what it does, in a few sentences
    schema: dict[str, Any]  # the JSON schema of its arguments


@dataclass(frozen=True, slots=True)
class Reply:
    """What a call brought."""

    text: str  # how it ended, and what the seat senses then
    ended: str  # why, such as "arrived"
    steps: int  # played by the call
    over: bool  # whether the match is


class WordsSeat(BridgedSeat):
    """A seat of a match that is played by words.

    Calls and how they ended are notes of the agent, as if it had said them.

    Attributes:
        rules: The rules of the match.
        tools: What may be called.
    """

    def __init__(self, address: str, token: str) -> None:
        super().__init__(address, token)
        self.rules: str = self.introduction["rules"]
        self.tools = tuple(Tool(**tool) for tool in self.introduction["tools"])

    def observe(self) -> str:
        """Return the text of now, 8,000 bytes at most."""
        text: str = self.ask("observe")[0]["text"]
        return text

    def call(self, name: str, arguments: Mapping[str, Any] | None = None) -> Reply:
        """Play a tool until it ends. A bad call is answered with what is allowed, and costs game time."""
        given = dict(arguments or {})
        say(f"→ {name} {json.dumps(given)[:SHOWN]}")
        answer, _ = self.ask("call", tool=name, arguments=given)
        reply = Reply(answer["text"], answer["ended"], answer["steps"], self.is_over)
        say(reply.text.partition("\n")[0])
        return reply

    def picture(self, *, marks: bool = False) -> bytes:
        """Return what the seat's camera shows, as a PNG file of less than 1 MiB.

        Args:
            marks: Whether the boxes and agents that the seat is told of have their numbers in it.

        Raises:
            AgentError: The seat has no camera: its ``submission.toml`` needs ``pictures = true``.
        """
        return self.ask("picture", marks=marks)[1]


class WordsPlayer:
    """Base of agents that play by words: override ``play``. One object plays one match."""

    def play(self, seat: WordsSeat) -> None:
        """Play a match to its end.

        Args:
            seat: The seat, which has joined the match. The time to start up ends with its first text.
        """
        raise NotImplementedError(f"{type(self).__name__} must have a method play(self, seat)")
