"""The news of running matches, sent to everybody who watches them, as server-sent events.

Each line of a match's file (``live.py``) is read, framed and compressed once, and all spectators are sent the
same bytes. A spectator is a place in the list of these pieces. So whoever reads slowly delays nobody, and the
server ends a connection on which nothing is read for long. Whoever comes late is sent all pieces so far, and
whoever comes back those after the last one that they have. Old pieces are compressed together, which saves
bytes.

The events are ``begin``, with the document of the match (``Trails``), ``news`` (``News``), ``over``, and
``hidden`` with why the match may no longer be watched.
"""

import asyncio
import json
import os
import secrets
import time
import zlib
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from functools import partial
from http import HTTPStatus
from pathlib import Path
from typing import BinaryIO

from starlette.requests import Request
from starlette.responses import Response, StreamingResponse
from starlette.types import Receive, Scope, Send

from wildscav.errors import UserError
from wildscav_leaderboard.spectating.live import LOOK, NOT_PLAYED, LiveMatches, key_of

OF_ONE, IN_ALL = 50, 600  # streams of an address, and of all
TOGETHER = 20  # pieces that are compressed together
CHECK = 2.0  # s between two questions whether a match may still be watched
BEAT = 10.0  # s after which a silent stream says that it lives
LINGER = 30.0  # s for which the pieces of a match are kept that nobody watches
GZIP = b"\x1f\x8b\x08\x00\x00\x00\x00\x00\x00\xff"  # how a compressed stream begins
ENDLESS = "wildscav.endless"  # in the scope of a request whose answer ends only with its connection


def piece(event: str, data: str, number: str = "") -> bytes:
    """Return an event as it is sent."""
    head = f"id: {number}\n" if number else ""
    return f"{head}event: {event}\ndata: {data}\n\n".encode()


def compressed(content: bytes) -> bytes:
    """Return a part of a compressed stream, which depends on none before it."""
    packer = zlib.compressobj(wbits=-zlib.MAX_WBITS)
    return packer.compress(content) + packer.flush(zlib.Z_FULL_FLUSH)


ALIVE, OVER = compressed(b":\n\n"), compressed(piece("over", ""))


class TooManyStreamsError(UserError):
    """An address, or all together, have as many streams as there may be."""

    status = HTTPStatus.TOO_MANY_REQUESTS


class Playing:
    """The pieces of one playing of a match."""

    def __init__(self) -> None:
        self.name = secrets.token_hex(4)
        self._pieces: list[bytes] = []
        self._joined: list[bytes] = []  # as many together as ``TOGETHER`` says
        self._loose: list[bytes] = []  # the last ones, not compressed

    def __len__(self) -> int:
        return len(self._pieces)

    def add(self, line: str) -> None:
        """Add a line of the file; the first one is the beginning."""
        made = piece("news" if self._pieces else "begin", line, f"{self.name}-{len(self._pieces)}")
        self._pieces.append(compressed(made))
        self._loose.append(made)
        if len(self._loose) == TOGETHER:
            self._joined.append(compressed(b"".join(self._loose)))
            self._loose.clear()

    def after(self, last: str) -> int:
        """Return the place after the piece of a name; 0 if it is of another playing."""
        name, _, number = last.partition("-")
        known = name == self.name and number.isascii() and number.isdecimal() and len(number) < 9
        return int(number) + 1 if known and int(number) < len(self._pieces) else 0

    def since(self, place: int) -> Iterator[tuple[bytes, int]]:
        """Yield the pieces from a place on, each with the place after it."""
        while place < len(self._pieces):
            together, rest = divmod(place, TOGETHER)
            is_joined = not rest and together < len(self._joined)
            part = self._joined[together] if is_joined else self._pieces[place]
            place += TOGETHER if is_joined else 1
            yield part, place


class Channel:
    """One match, for everybody who watches it.

    Args:
        why_hidden: Returns why not everybody may watch it: ``NOT_PLAYED`` if nobody can; empty if everybody
            may; None if that is unknown.
    """

    def __init__(self, path: Path, why_hidden: Callable[[], Awaitable[str | None]]) -> None:
        self._path, self._why_hidden = path, why_hidden
        self._file: BinaryIO | None = None
        self._rest = b""  # of a line that is being written
        self._playing = Playing()
        self._changed = asyncio.Event()  # set, and replaced, when there is anything new
        self._is_over, self._hidden = False, ""
        self.spectators, self._left = 0, time.monotonic()
        self.task = asyncio.create_task(self._run())

    async def _run(self) -> None:
        """Read the file until the match has ended, or nobody watches it."""
        checking, is_played = asyncio.create_task(self._check()), True
        try:
            while is_played and (self.spectators or time.monotonic() - self._left < LINGER):
                is_played = not checking.done()  # if it is not, what was written before is read
                if await asyncio.to_thread(self._read):
                    self._tell()
                is_played &= not self._is_over
                await asyncio.sleep(LOOK)
        finally:
            checking.cancel()
            self._is_over = True
            self._tell()
            if self._file is not None:
                self._file.close()

    async def _check(self) -> None:
        """Ask again and again whether the match may be watched, until it is not being played."""
        why: str | None = ""
        while why != NOT_PLAYED:
            if why is not None and why != self._hidden:
                self._hidden = why
                self._tell()
            await asyncio.sleep(CHECK)
            why = await self._why_hidden()

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()

    def _read(self) -> bool:
        """Read new lines; return whether there is anything new."""
        is_over = False
        try:
            file = self._opened()
        except FileNotFoundError:
            if self._file is None:  # it has not begun
                return False
            file, is_over = self._file, True  # the last news may be unread
        *lines, self._rest = (self._rest + file.read()).split(b"\n")
        for line in lines:
            self._playing.add(line.decode())
        self._is_over = is_over
        return is_over or bool(lines)

    def _opened(self) -> BinaryIO:
        """Return the file, which is another one when the match is played again."""
        there = self._path.stat()
        if self._file is None or not os.path.samestat(there, os.fstat(self._file.fileno())):
            opened = self._path.open("rb")
            if self._file is not None:
                self._file.close()
            self._file, self._rest, self._playing = opened, b"", Playing()
        return self._file

    def leave(self) -> None:
        """Note that a spectator has gone."""
        self.spectators -= 1
        self._left = time.monotonic()

    async def parts(self, last: str, *, everything: bool) -> AsyncIterator[bytes]:
        """Yield what a spectator is sent.

        Args:
            last: The name of the last piece that they have; empty for none.
            everything: Whether they may watch what others may not.
        """
        playing, place = self._playing, self._playing.after(last)
        while True:
            changed, is_over = self._changed, self._is_over
            if self._hidden and not everything:
                yield compressed(piece("hidden", json.dumps(self._hidden)))
                return
            if playing is not self._playing:
                playing, place = self._playing, 0
            for part, following in playing.since(place):
                yield part
                place = following
            if is_over:
                yield OVER
                return
            try:
                await asyncio.wait_for(changed.wait(), BEAT)
            except TimeoutError:
                yield ALIVE


class Streams:
    """The streams of a web server.

    Args:
        why_hidden: Returns the same of a match.
    """

    def __init__(self, live: LiveMatches, why_hidden: Callable[[int], Awaitable[str | None]]) -> None:
        self._live, self._why_hidden = live, why_hidden
        self._channels: dict[int, Channel] = {}
        self._open = Counter[str]()  # streams, by address

    def follow(self, request: Request, match: int, address: str, *, everything: bool) -> Response:
        """Return a stream of a match that is being played.

        Args:
            match: Number of the match, which the caller may watch.
            everything: Whether they may go on when others may not.

        Raises:
            TooManyStreamsError: There are too many.
        """
        if self._open[address] >= OF_ONE:
            raise TooManyStreamsError(
                f"your address watches {OF_ONE} live matches already: close one of them"
            )
        if self._open.total() >= IN_ALL:
            raise TooManyStreamsError("too many people watch live matches: try again in a moment")
        channel = self._channel(match)
        parts = channel.parts(request.headers.get("last-event-id", ""), everything=everything)
        self._open[address] += 1
        channel.spectators += 1

        def end() -> None:
            self._open[address] -= 1
            self._open += Counter()  # forgets those that have none
            channel.leave()

        return Stream(request, parts, end)

    def _channel(self, match: int) -> Channel:
        for number, channel in list(self._channels.items()):
            if channel.task.done():
                del self._channels[number]
        if match not in self._channels:
            path = self._live.path(key_of(match))
            self._channels[match] = Channel(path, partial(self._why_hidden, match))
        return self._channels[match]


class Stream(StreamingResponse):
    """The answer to one spectator.

    Args:
        parts: Parts of a compressed stream, each by itself.
        end: Called when the spectator has gone.
    """

    def __init__(self, request: Request, parts: AsyncIterator[bytes], end: Callable[[], None]) -> None:
        is_compressed = "gzip" in request.headers.get("accept-encoding", "")
        headers = {"Cache-Control": "no-store", "X-Accel-Buffering": "no"}  # no proxy keeps it back
        if is_compressed:
            headers["Content-Encoding"] = "gzip"
        content = _sent(request, parts, is_compressed=is_compressed)
        super().__init__(content, headers=headers, media_type="text/event-stream")
        self._end = end

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send the stream."""
        scope[ENDLESS] = True
        try:
            await super().__call__(scope, receive, send)
        finally:
            self._end()


async def _sent(
    request: Request, parts: AsyncIterator[bytes], *, is_compressed: bool
) -> AsyncIterator[bytes]:
    if request.scope["method"] == "HEAD":
        return
    unpacked = zlib.decompressobj(-zlib.MAX_WBITS)
    yield GZIP if is_compressed else b":\n\n"
    async for part in parts:
        yield part if is_compressed else unpacked.decompress(part)
