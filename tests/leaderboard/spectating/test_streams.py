"""The streams of running matches: what spectators are sent, in which order, and until when."""

import asyncio
import socket
import time
import zlib
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import ExitStack
from itertools import pairwise
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from fastapi import FastAPI, Request, Response
from fastapi.responses import JSONResponse
from tests.leaderboard.spectating.served import served

from wildscav_leaderboard.spectating import streams
from wildscav_leaderboard.spectating.live import NOT_PLAYED, LiveMatches
from wildscav_leaderboard.spectating.streams import (
    GZIP,
    OF_ONE,
    TOGETHER,
    Channel,
    Playing,
    Streams,
    TooManyStreamsError,
)

MATCH = 7
PATIENCE = 30.0  # s


@pytest.fixture(autouse=True)
def hasty(monkeypatch: pytest.MonkeyPatch) -> None:
    """Looks are so frequent that no test waits for them."""
    monkeypatch.setattr(streams, "LOOK", 0.005)
    monkeypatch.setattr(streams, "CHECK", 0.01)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    return LiveMatches(tmp_path).path(f"match-{MATCH}")


def write(file: Path, *lines: str) -> None:
    with file.open("a") as opened:
        opened.write("".join(f"{line}\n" for line in lines))


def end(file: Path) -> None:
    file.unlink()


def unpacked(parts: list[bytes]) -> str:
    return zlib.decompressobj(zlib.MAX_WBITS | 16).decompress(GZIP + b"".join(parts)).decode()


def data_of(text: str) -> list[str]:
    """The data of events, with the kind of those that have none."""
    events = [dict(line.split(": ", 1) for line in event.split("\n")) for event in text.split("\n\n")[:-1]]
    return [event["data"] or event["event"] for event in events]


async def shown() -> str:
    return ""


def parts(channel: Channel, *, everything: bool = False) -> AsyncIterator[bytes]:
    return channel.parts("", everything=everything)


async def read(stream: AsyncIterator[bytes], *until: str) -> list[str]:
    """Read a stream until it has told some data, or ends."""
    read: list[bytes] = []
    async with asyncio.timeout(PATIENCE):
        async for part in stream:
            read.append(part)
            if until and data_of(unpacked(read))[-len(until) :] == list(until):
                break
    return data_of(unpacked(read))


def watch(
    file: Path, story: Callable[[Channel], Awaitable[None]], why: Callable[[], Awaitable[str]] = shown
) -> None:
    """Have a story told of a match that somebody watches."""

    async def run() -> None:
        channel = Channel(file, why)
        channel.spectators = 1
        await story(channel)
        channel.task.cancel()

    asyncio.run(run())


def test_who_joins_in_the_middle_is_told_the_same_as_who_was_there_from_the_start(file: Path) -> None:
    async def story(channel: Channel) -> None:
        early = asyncio.create_task(read(parts(channel)))
        write(file, "begin", "1")
        await read(parts(channel), "begin", "1")
        lines = [str(number) for number in range(2, 5 * TOGETHER)]
        write(file, *lines)
        late = asyncio.create_task(read(parts(channel)))
        await read(parts(channel), lines[-1])
        write(file, "last")  # is told although the file is gone
        end(file)
        assert await early == await late == ["begin", "1", *lines, "last", "over"]

    watch(file, story)


@pytest.mark.parametrize("seen", [0, 1, TOGETHER - 1, TOGETHER, 3 * TOGETHER - 1])
def test_who_comes_back_is_told_exactly_what_they_missed(seen: int) -> None:
    playing = Playing()
    for number in range(3 * TOGETHER):
        playing.add(str(number))
    place = playing.after(f"{playing.name}-{seen}")

    missed = [part for part, _ in playing.since(place)]
    assert data_of(unpacked(missed)) == [str(number) for number in range(seen + 1, 3 * TOGETHER)]
    assert all(after > before for before, after in pairwise(place for _, place in playing.since(place)))


@pytest.mark.parametrize(
    "last", ["", "nonsense", "{}", "{}-", "{}-x", "{}-5", "{}-99999999999", "{}-²", "0-1"]
)
def test_the_name_of_no_piece_of_this_playing_gives_the_whole(last: str) -> None:
    playing = Playing()
    for number in range(3):
        playing.add(str(number))

    assert playing.after(last.format(playing.name)) == 0


def test_a_match_that_is_played_again_begins_anew(file: Path) -> None:
    async def story(channel: Channel) -> None:
        stream = parts(channel)
        write(file, "begin", "1")
        assert await read(parts(channel), "1") == ["begin", "1"]
        told = asyncio.create_task(read(stream, "begin", "2"))
        other = file.with_suffix(".part")
        write(other, "begin", "2")
        other.rename(file)
        assert (await told)[-2:] == ["begin", "2"]

    watch(file, story)


def test_half_a_line_waits_for_its_other_half(file: Path) -> None:
    async def story(channel: Channel) -> None:
        stream = asyncio.create_task(read(parts(channel), "long"))
        write(file, "begin")
        with file.open("a") as opened:
            opened.write("lo")
            opened.flush()
            await asyncio.sleep(0.05)
            opened.write("ng\n")
        assert await stream == ["begin", "long"]

    watch(file, story)


@pytest.mark.parametrize("lines", [[], ["begin", "1"]])
def test_the_stream_of_a_match_that_is_not_played_ends(file: Path, lines: list[str]) -> None:
    async def answer() -> str:
        return NOT_PLAYED

    async def story(channel: Channel) -> None:
        assert await read(parts(channel, everything=True)) == [*lines, "over"]

    if lines:
        write(file, *lines)
    watch(file, story, answer)


def test_news_do_not_wait_for_the_answer_whether_all_may_watch(file: Path) -> None:
    async def story(channel: Channel) -> None:
        write(file, "begin")
        await asyncio.wait_for(asked.wait(), PATIENCE)
        write(file, "1")
        await read(parts(channel), "begin", "1")

    async def never() -> str:
        asked.set()
        await asyncio.sleep(2 * PATIENCE)
        return ""

    asked = asyncio.Event()
    watch(file, story, never)


def test_a_stream_ends_when_not_everybody_may_watch_anymore_but_not_that_of_an_organizer(file: Path) -> None:
    why = ""

    async def answer() -> str:
        return why

    async def story(channel: Channel) -> None:
        nonlocal why
        write(file, "begin")
        stranger = asyncio.create_task(read(parts(channel)))
        organizer = asyncio.create_task(read(parts(channel, everything=True)))
        await read(parts(channel), "begin")
        why = "the boards are frozen"
        assert (await stranger)[-1] == '"the boards are frozen"'
        write(file, "secret")
        await read(parts(channel, everything=True), "secret")
        assert await read(parts(channel)) == ['"the boards are frozen"']
        end(file)
        assert await organizer == ["begin", "secret", "over"]

    watch(file, story, answer)


def test_pieces_are_compressed_once_for_everybody(file: Path) -> None:
    async def story(channel: Channel) -> None:
        write(file, "begin")
        firsts = []
        for _ in range(2):
            async for part in parts(channel):
                firsts.append(part)
                break
        assert firsts[0] is firsts[1]

    watch(file, story)


# Streams of a real server.


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    app = FastAPI()

    async def why_hidden(_match: int) -> str:
        return ""

    following = Streams(LiveMatches(tmp_path), why_hidden)

    @app.get("/live")
    async def live(request: Request) -> Response:
        try:
            return following.follow(request, MATCH, "somebody", everything=False)
        except TooManyStreamsError as error:
            return JSONResponse({"error": str(error)}, error.status)

    with served(app) as address:
        yield address


def test_a_slow_reader_delays_nobody(address: str, file: Path) -> None:
    line = "x" * 10_000
    write(file, "begin")
    with ExitStack() as stack:
        host, port = urlsplit(address).hostname, urlsplit(address).port
        slow = stack.enter_context(socket.socket())
        slow.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        slow.connect((host, port))
        slow.sendall(b"GET /live HTTP/1.1\r\nHost: a\r\n\r\n")  # not compressed, so it is much
        client = stack.enter_context(httpx.Client(base_url=address, timeout=PATIENCE))
        quick = stack.enter_context(client.stream("GET", "/live"))
        lines = quick.iter_lines()
        for _ in range(40):
            write(file, *[line] * 50)  # 20 MB in all, which no buffer holds
            assert sum(text == f"data: {line}" for text in _until(lines, 50)) == 50
        assert slow.recv(12) == b"HTTP/1.1 200"
        file.unlink()


def _until(lines: Iterator[str], count: int) -> Iterator[str]:
    """The lines of a stream until so many news have come."""
    while count:
        line = next(lines)
        count -= line.startswith("data: x")
        yield line


def test_an_address_may_hold_so_many_streams(address: str, file: Path) -> None:
    write(file, "begin")
    with ExitStack() as stack:
        client = stack.enter_context(
            httpx.Client(base_url=address, timeout=PATIENCE, limits=httpx.Limits(max_connections=None))
        )
        for _ in range(OF_ONE):
            last = stack.enter_context(client.stream("GET", "/live"))
        refused = client.get("/live")
        assert (refused.status_code, "close one" in refused.text) == (429, True)
        last.close()
        deadline = time.monotonic() + PATIENCE
        status = 429
        while status != 200:  # once the server has noticed
            assert time.monotonic() < deadline
            with client.stream("GET", "/live") as again:
                status = again.status_code
        file.unlink()


def test_a_stream_is_read_by_programs_that_know_no_compression(address: str, file: Path) -> None:
    write(file, "begin")
    texts = []
    for coding in ("identity", "gzip"):
        with httpx.stream("GET", f"{address}/live", headers={"Accept-Encoding": coding}) as answer:
            lines = answer.iter_lines()
            texts.append([next(lines) for _ in range(5 if coding == "identity" else 3)][-3:])
            assert answer.headers.get("content-encoding", "identity") == coding
            assert answer.headers["content-type"].startswith("text/event-stream")
    assert texts[0] == texts[1]
    assert texts[0][1:] == ["event: begin", "data: begin"]
    file.unlink()
