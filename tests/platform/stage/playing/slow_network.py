"""A network that takes its time: a proxy, in a thread, that passes everything on later."""

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any
from urllib.parse import urlsplit, urlunsplit


@contextmanager
def far_away(link: str, delay: float) -> Iterator[str]:
    """Yield a link to the same page through a proxy that passes bytes on after s, both ways."""
    target = urlsplit(link)
    found: list[Any] = []
    ready = threading.Event()

    async def pass_on(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        inside, outside = await asyncio.open_connection(target.hostname, target.port)
        try:
            await asyncio.gather(_carry(reader, outside, delay), _carry(inside, writer, delay))
        finally:
            for each in (outside, writer):
                each.transport.abort()

    async def serve() -> None:
        end = asyncio.Event()
        server = await asyncio.start_server(pass_on, "127.0.0.1", 0)
        found.extend((server.sockets[0].getsockname()[1], asyncio.get_running_loop(), end))
        ready.set()
        await end.wait()
        server.close()
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.wait(others)

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    ready.wait()
    port, loop, end = found
    try:
        yield urlunsplit(target._replace(netloc=f"127.0.0.1:{port}"))
    finally:
        loop.call_soon_threadsafe(end.set)
        thread.join()


async def _carry(reader: asyncio.StreamReader, writer: asyncio.StreamWriter, delay: float) -> None:
    loop = asyncio.get_running_loop()
    pieces: asyncio.Queue[tuple[float, bytes]] = asyncio.Queue()

    async def collect() -> None:
        while piece := await reader.read(65536):
            pieces.put_nowait((loop.time() + delay, piece))
        pieces.put_nowait((loop.time() + delay, b""))

    collecting = asyncio.create_task(collect())
    try:
        while True:
            due, piece = await pieces.get()
            await asyncio.sleep(due - loop.time())
            if not piece:
                return writer.close()
            writer.write(piece)
    finally:
        collecting.cancel()
