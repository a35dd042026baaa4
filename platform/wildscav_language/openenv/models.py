"""What an environment of OpenEnv and its clients send each other."""

from typing import Any

from openenv.core.env_server.mcp_types import Tool
from openenv.core.env_server.types import Action, Observation, State
from pydantic import Field


class WildscavAction(Action):
    """A call of a tool."""

    tool: str = Field(description="the name of a tool; the observation after a reset has all of them")
    arguments: dict[str, Any] = Field(default_factory=dict, description="as the tool's schema says")


class WildscavObservation(Observation):
    """What the seat is told after a reset or a call; ``reward`` and ``done`` are beside it.

    The reward is by how much the track's score got better: what a seat gets in all is the score's change
    over the match. The metadata say what the call cost (``steps`` and ``seconds`` of game time), and what the
    match has come to: ``calls``, ``refused`` (those that could not be understood or played) and ``score``.
    """

    text: str = Field(description="what the seat senses, 8,000 bytes at most; after a reset, first the rules")
    ended: str = Field(default="", description="why the tool ended, in one word; empty after a reset")
    picture: str | None = Field(default=None, description="PNG in base64, if the reset asked for pictures")
    tools: list[Tool] = Field(default_factory=list, description="those of the match, after a reset")


class WildscavState(State):
    """What is known of an episode besides its observations; enough to play it again."""

    options: dict[str, Any] = Field(default_factory=dict, description="of the reset, with the seed it had")
    ending: str = Field(default="", description="why the match is over, in words; empty before")
    record: str | None = Field(default=None, description="the name of its file, if the server keeps records")
