"""The official client of MCP at a server in this process, and what it reads in answers."""

import asyncio
import re
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from mcp import Client
from mcp_types import CallToolResult, TextContent
from tests.coroutines import Test, within

from wildscav_engine.sensors import parse_sensors
from wildscav_language.mcp_server.desk import Desk
from wildscav_language.mcp_server.matches import Bounds, serving
from wildscav_language.mcp_server.protocol import make_server
from wildscav_language.senses import sensors
from wildscav_server.hosting.precompile import precompile

SMALL = {"map": 103, "time_limit": 20.0}  # 100 m
PLAYERS = ("player", "first", "second")


class Player:
    """A client that keeps the handle of its seat."""

    def __init__(self, client: Any) -> None:
        self.client, self.seat = client, ""

    async def ask(self, tool: str, /, **arguments: Any) -> CallToolResult:
        """Call a tool, with the seat's handle if there is one."""
        own = {"seat": self.seat} if self.seat and "code" not in arguments else {}
        result: CallToolResult = await self.client.call_tool(tool, own | arguments)
        return result

    async def read(self, tool: str, /, **arguments: Any) -> str:
        """Call a tool, and return the text of its answer, which is no error."""
        result = await self.ask(tool, **arguments)
        assert not result.is_error, result.content
        return text_of(result)

    async def start(self, track: str, **arguments: Any) -> str:
        """Start a match, keep the handle, and return the answer."""
        return self._seated(await self.read("start_match", track=track, **(SMALL | arguments)))

    async def join(self, started: str) -> str:
        """Join the match that another client has started, by its answer."""
        code = re.findall(r"^join code .*: (\S+)$", started, re.MULTILINE)[0]
        return self._seated(await self.read("join_match", code=code))

    def _seated(self, answer: str) -> str:
        self.seat = re.findall(r"^seat: (\S+)$", answer, re.MULTILINE)[0]
        return answer


def text_of(result: CallToolResult) -> str:
    """The text of an answer."""
    return "".join(part.text for part in result.content if isinstance(part, TextContent))


@asynccontextmanager
async def clients(folder: Path, bounds: Bounds | None = None) -> AsyncIterator[list[Player]]:
    """Connect three clients to a server of their own."""
    precompile(parse_sensors(sensors(pictures=True)).values())  # compiling is not what is tested
    ready = asyncio.get_running_loop().create_future()
    ready.set_result(None)
    async with serving(folder, bounds or Bounds()) as matches, asyncio.timeout(120.0):
        server = make_server(Desk(matches, ready, None))
        async with Client(server) as first, Client(server) as second, Client(server) as third:
            yield [Player(one) for one in (first, second, third)]


def at_server(bounds: Bounds | None = None) -> Callable[[Test], Callable[..., None]]:
    """Make a test of a coroutine: it gets the clients that it names of ``PLAYERS``."""

    @asynccontextmanager
    async def opened(folder: Path, names: list[str]) -> AsyncIterator[dict[str, Any]]:
        async with clients(folder, bounds) as players:
            yield dict(zip((name for name in names if name in PLAYERS), players, strict=False))

    return within(opened, PLAYERS)
