"""What an agent at a bridge may ask, and that whatever it sends costs its own seat alone."""

import asyncio
import json
import socket
from collections.abc import AsyncIterator, Callable, Coroutine
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest
from tests.coroutines import Test, within

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.bridge.desk import Order
from wildscav_evaluator.bridge.seat import MOST_CONNECTIONS, MOST_IDLE, SeatBridge
from wildscav_language.senses import sensors
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.match_server import MatchServer

pytestmark = pytest.mark.usefixtures("compiled")
OPEN = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=1)
SPEC = MatchSpec(track="navigation", map=OPEN, seed=1, clock="paused", time_limit=10.0)
TOKEN = "of the seat"  # noqa: S105
SCREEN = {"screen": {"width": 64, "height": 36, "quality": "fast"}}


class Asker:
    """An agent that speaks the protocol by hand."""

    def __init__(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self.reader, self.writer = reader, writer

    async def send(self, line: bytes) -> dict[str, Any]:
        """Send a line as it is, and return the answer; nothing if the connection is closed."""
        self.writer.write(line + b"\n")
        answer = await self.reader.readline()
        return json.loads(answer) if answer else {}

    async def ask(self, request: str, **arguments: Any) -> dict[str, Any]:
        return await self.send(json.dumps({"request": request, **arguments}).encode())


class Bridged:
    """A match whose only seat is behind a bridge."""

    def __init__(
        self, hosted: HostedMatch, path: Path, failed: asyncio.Future[Any], bridge: SeatBridge
    ) -> None:
        self.hosted, self.path, self.failed, self.bridge = hosted, path, failed, bridge
        self.askers: list[Asker] = []

    async def connect(self) -> Asker:
        self.askers.append(Asker(*await asyncio.open_unix_connection(self.path)))
        return self.askers[-1]

    async def joined(self) -> Asker:
        asker = await self.connect()
        assert "match" in await asker.ask("hello", token=TOKEN)
        return asker

    async def report(self) -> tuple[str, str]:
        """Wait for the end of the match; return the status of the seat, and why."""
        seat = (await asyncio.wait_for(self.hosted.finished(), 10.0)).seats[0]
        return seat.status.value, seat.detail


async def until(condition: Callable[[], bool]) -> None:
    async with asyncio.timeout(30.0):
        while not condition():  # noqa: ASYNC110
            await asyncio.sleep(0.005)


@asynccontextmanager
async def bridge_to(interface: str, folder: Path) -> AsyncIterator[Bridged]:
    server = MatchServer()
    (address,) = await server.start([f"unix:{folder / 'match.sock'}"])
    asked = SCREEN if interface == "keys" else sensors(pictures=True)
    hosted = await server.host(SPEC, names=["Ann"], sensors={0: asked})
    failed: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(folder / "bridge.sock"))
        listener.listen()
        order = Order(interface, listener.detach(), TOKEN, address, hosted.tokens[0], hosted.names)
    bridge = SeatBridge(order, failed)
    await bridge.listen()
    bridged = Bridged(hosted, folder / "bridge.sock", failed, bridge)
    try:
        yield bridged
        assert not failed.done(), "the bridge itself failed"
    finally:
        for asker in bridged.askers:
            asker.writer.close()
        hosted.cancel()
        await until(lambda: not any("SeatBridge._serve" in repr(task) for task in asyncio.all_tasks()))
        await server.stop()


def behind(interface: str) -> Callable[[Test], Callable[..., None]]:
    """Make a test of what an agent does at a bridge; it gets the match, ``bridged``."""

    @asynccontextmanager
    async def opened(folder: Path, _names: list[str]) -> AsyncIterator[dict[str, Any]]:
        async with bridge_to(interface, folder) as bridged:
            yield {"bridged": bridged}

    return within(opened, ("bridged",))


@behind("words")
async def test_words_lead_to_the_target(bridged: Bridged) -> None:
    asker = await bridged.connect()
    told = await asker.ask("hello", token=TOKEN)
    assert told["match"]["track"] == "navigation"
    assert not {"start", "target", "supply_waves"} & told["match"].keys()
    assert "Reach the target" in told["rules"]
    assert [tool["name"] for tool in told["tools"]][:3] == ["look_around", "turn", "go"]
    assert "\nTarget: " in (await asker.ask("observe"))["text"]
    reply = await asker.ask("call", tool="go", arguments={"place": "target", "seconds": 20})
    assert (reply["ended"], reply["over"]) == ("match_over", True)
    assert (await asker.ask("observe"))["text"] == "The match is over."
    assert await bridged.report() == ("finished", "")


@behind("words")
async def test_a_picture_follows_the_line_that_announces_it(bridged: Bridged) -> None:
    asker = await bridged.joined()
    told = await asker.ask("picture", marks=True)
    assert (await asker.reader.readexactly(told["bytes"])).startswith(b"\x89PNG")


@behind("words")
async def test_bad_calls_cost_game_time_and_are_answered_with_what_is_allowed(bridged: Bridged) -> None:
    asker = await bridged.joined()
    for tool, arguments in [("fly", {}), ("go", {"bearing": 10**4000}), ("go", {"seconds": [[[1]]]})]:
        reply = await asker.ask("call", tool=tool, arguments=arguments)
        assert (reply["ended"], reply["steps"]) == ("refused", 5)


@behind("keys")
async def test_keys_move_the_body_and_the_screen_is_all_that_is_told(bridged: Bridged) -> None:
    asker = await bridged.connect()
    assert (await asker.ask("hello", token=TOKEN)).keys() == {"match"}
    told = await asker.ask("look")
    assert told == {"step": 0, "over": False, "width": 64, "height": 36, "bytes": 64 * 36 * 3}
    first = await asker.reader.readexactly(told["bytes"])
    told = await asker.ask("press", forward=True, mouse_x=500.0)
    assert told["step"] == 1
    assert await asker.reader.readexactly(told["bytes"]) != first
    for keys in ({"fly": True}, {"forward": 1}, {"mouse_x": 1e7}, {"mouse_y": True}):
        assert next(iter(keys)) in (await asker.ask("press", **keys))["error"]
    while not told["over"]:
        told = await asker.ask("press")
        await asker.reader.readexactly(told.get("bytes", 0))
    assert await bridged.report() == ("finished", "")


@pytest.mark.parametrize(
    "line",
    [
        *(b"", b"\xff", b"{", b"[]", b'"observe"', b'{"request": 1}', b"[" * 60_000, b"1" * 5_000),
        *(b'{"request": "call", "tool": "go", "arguments": {"bearing": NaN}}', b'{"request": "shoot"}'),
        *(b'{"request": "call", "tool": "go"}', b'{"request": "call", "tool": 1, "arguments": {}}'),
        b'{"request": "call", "tool": "go", "arguments": ' + b'{"a":' * 900 + b"1" + b"}" * 901,
    ],
)
@behind("words")
async def test_what_is_no_request_is_answered_with_what_is_allowed(bridged: Bridged, line: bytes) -> None:
    asker = await bridged.joined()
    assert (await asker.send(line)).keys() & {"error", "ended"}
    assert "text" in await asker.ask("observe")


async def too_long(asker: Asker) -> dict[str, Any]:
    return await asker.send(b"x" * 70_000)


async def too_many(asker: Asker) -> dict[str, Any]:
    for _ in range(MOST_IDLE):
        if "closed" in (told := await asker.ask("observe")):
            return told
    return {}


async def leaves(asker: Asker) -> dict[str, Any]:
    asker.writer.write(b'{"request"')
    asker.writer.close()
    return {"closed": "the agent has left"}


@pytest.mark.parametrize(
    ("misbehave", "said"),
    [(too_long, "65,536 bytes"), (too_many, "100 requests in a row"), (leaves, "has left")],
)
@behind("words")
async def test_who_floods_or_leaves_loses_the_seat_and_the_match_goes_on(
    bridged: Bridged, misbehave: Callable[[Asker], Coroutine[Any, Any, dict[str, Any]]], said: str
) -> None:
    asker = await bridged.joined()
    await asker.ask("observe")
    assert said in (await misbehave(asker))["closed"]
    assert (await bridged.report())[0] == "crashed"


@behind("words")
async def test_a_seat_is_taken_once_by_whoever_has_its_token(bridged: Bridged) -> None:
    asker, late = await bridged.connect(), await bridged.connect()
    for hello in ({"token": "another"}, {"token": 1}, {}, {"token": "\ud800"}):
        stranger = await bridged.connect()
        assert "token" in (await stranger.ask("hello", **hello))["closed"]
    assert "hello" in (await (await bridged.connect()).ask("observe"))["closed"]
    assert "match" in await asker.ask("hello", token=TOKEN)
    assert "another connection" in (await late.ask("hello", token=TOKEN))["closed"]
    assert "text" in await asker.ask("observe")
    with pytest.raises(ConnectionRefusedError):
        await bridged.connect()


@behind("words")
async def test_connections_are_counted(bridged: Bridged) -> None:
    asker = await bridged.connect()
    for _ in range(MOST_CONNECTIONS - 1):
        (await bridged.connect()).writer.close()
    await until(lambda: bridged.bridge._connections == MOST_CONNECTIONS)
    with pytest.raises(ConnectionRefusedError):
        await bridged.connect()
    assert "match" in await asker.ask("hello", token=TOKEN)


@behind("words")
async def test_an_agent_that_reads_nothing_stops_nobody_else(bridged: Bridged) -> None:
    asker = await bridged.joined()
    line = b'{"request": "picture"}\n'
    asker.writer.write(line * 50)
    await until(lambda: asker.reader._paused)  # type: ignore[attr-defined]
    bridged.hosted.give_up(0, "its process ended")
    assert (await bridged.report())[0] == "crashed"
