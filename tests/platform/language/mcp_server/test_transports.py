"""The command serves the official client: over standard input and output, and over HTTP."""

import asyncio
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

pytest.importorskip("mcp")

import httpx2
from mcp import ClientSession, StdioServerParameters
from mcp.client.stdio import stdio_client
from mcp.client.streamable_http import streamable_http_client
from tests.commands import run_command
from tests.platform.language.mcp_server.clients import Player, text_of

pytestmark = pytest.mark.slow

WILDSCAV = str(Path(sys.executable).parent / "wildscav")
WORD = "of-the-organizer-alone"


@asynccontextmanager
async def by_stdio(folder: Path) -> AsyncIterator[Player]:
    parameters = StdioServerParameters(command=WILDSCAV, args=["mcp", "--out", str(folder)])
    async with stdio_client(parameters) as (reading, writing), ClientSession(reading, writing) as session:
        await session.initialize()
        yield Player(session)


@asynccontextmanager
async def running(folder: Path, *options: str) -> AsyncIterator[tuple[str, asyncio.subprocess.Process]]:
    """A server over HTTP: its URL and its process."""
    arguments = ("mcp", "--http", "127.0.0.1:0", "--out", str(folder), *options)
    process = await asyncio.create_subprocess_exec(WILDSCAV, *arguments, stderr=asyncio.subprocess.PIPE)
    assert process.stderr is not None
    try:
        line = (await process.stderr.readline()).decode()
        assert line.startswith("serving MCP at http://127.0.0.1:"), line
        yield line.split()[-1], process
    finally:
        if process.returncode is None:
            process.terminate()
        await process.wait()


@asynccontextmanager
async def by_http(url: str, token: str = "") -> AsyncIterator[Player]:
    headers = {"Authorization": f"Bearer {token}"} if token else {}
    async with (
        httpx2.AsyncClient(headers=headers, timeout=60.0) as http,
        streamable_http_client(url, http_client=http) as (reading, writing),
        ClientSession(reading, writing) as session,
    ):
        await session.initialize()
        yield Player(session)


def test_a_navigation_over_standard_input_and_output_and_a_client_that_is_gone_leaves_a_record(
    tmp_path: Path,
) -> None:
    async def play() -> str:
        async with by_stdio(tmp_path) as player:
            await player.start("navigation", time_limit=60.0)
            end = ""
            while "The match is over." not in end:
                end = await player.read("go", place="target", seconds=30.0)
            assert "success 1" in end
            record = (await player.read("record")).splitlines()[0]
            player.seat = ""
            await player.start("battle", others=["fighter-easy"], time_limit=1.5)
            await player.read("wait_until", seconds=1.0)
            return record

    done = run_command("verify", asyncio.run(play()))

    assert done.returncode == 0, done.stdout + done.stderr
    assert len([*tmp_path.glob("battle-*/match.wsr")]) == 1


def test_two_clients_over_http_play_one_battle(tmp_path: Path) -> None:
    async def play() -> list[str]:
        async with running(tmp_path) as (url, _), by_http(url) as first, by_http(url) as second:
            await second.join(await first.start("battle", clients=2, others=[], time_limit=2.0))
            await asyncio.gather(*(one.read("wait_until", seconds=9.0) for one in (first, second)))
            page = await first.read("replay")
            async with httpx2.AsyncClient(timeout=60.0) as browser:
                answer = await browser.get(page)
                assert answer.headers["content-type"].startswith("text/html")
                assert (await browser.get(f"{page}0")).status_code == 404
            return [await one.read("score") for one in (first, second)]

    for number, score in enumerate(asyncio.run(play())):
        assert "battle-1: over, because of time up, after 2.0 s" in score
        assert f'seat {number} "client {number + 1}" (you)' in score


def test_an_interrupted_server_answers_open_calls_and_keeps_the_records(tmp_path: Path) -> None:
    async def play() -> str:
        async with running(tmp_path) as (url, process), by_http(url) as player:
            await player.start("battle", clients=2, others=[], time_limit=1.0)
            waiting = asyncio.create_task(player.read("wait_until", seconds=1.0))  # for the other client
            await asyncio.sleep(0.5)
            process.terminate()
            ended = await waiting
            assert await asyncio.wait_for(process.wait(), 30.0) == 0
            return ended

    assert "Your seat is closed: its client left the match." in asyncio.run(play())
    assert len([*tmp_path.glob("battle-*/match.wsr")]) == 1


@pytest.mark.parametrize(
    ("options", "says"),
    [
        (["--http", "unix:/tmp/arena"], "must be HOST:PORT"),
        (["--http", "127.0.0.1:0", "--site", "arena.example"], "must be a URL"),
        (["--http", "127.0.0.1:0", "--site", "http://[::1"], "must be a URL"),
        (["--http", "127.0.0.1:0", "--site", "ftp://arena.example"], "must be a URL"),
        (["--http", "127.0.0.1:0", "--site", "http://arena.example/{x}"], "must be a URL"),
        (["--site", "https://arena.example"], "standard input has one client"),
    ],
)
def test_options_that_do_not_fit_are_refused(tmp_path: Path, options: list[str], says: str) -> None:
    done = run_command("mcp", "--out", str(tmp_path), *options)

    assert done.returncode == 2
    assert says in done.stderr


def test_a_token_opens_the_server_and_nothing_else_does(tmp_path: Path) -> None:
    (tmp_path / "token").write_text(WORD)

    async def play() -> tuple[str, int, int]:
        async with running(tmp_path / "out", "--token-file", str(tmp_path / "token")) as (url, _):
            async with by_http(url, WORD) as player:
                listed = text_of(await player.ask("list_matches"))
                await player.start("navigation", time_limit=1.0)
                await player.read("leave")
                assert str(tmp_path) not in await player.read("record")
                page = await player.read("replay")
            async with httpx2.AsyncClient(timeout=60.0) as stranger:
                refused = (await stranger.post(url, json={})).status_code
                return listed, refused, (await stranger.get(page)).status_code  # whoever has its link

    assert asyncio.run(play()) == ("There is no match: start one with start_match.", 401, 200)
