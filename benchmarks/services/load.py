"""A client that asks a web server for one page again and again, with little work of its own."""

import asyncio
import time
from dataclasses import dataclass, field

import numpy as np


@dataclass
class Load:
    """What a server did under a load."""

    latencies: list[float] = field(default_factory=list)  # s
    seconds: float = 0.0
    failures: int = 0  # answers that were not 200
    size: int = 0  # bytes of a body

    @property
    def rate(self) -> float:
        """Requests a second."""
        return len(self.latencies) / self.seconds

    def percentile(self, share: float) -> float:
        """Return a percentile of the latencies, ms."""
        return 1000.0 * float(np.percentile(self.latencies, share))


def ask(port: int, path: str, *, seconds: float, connections: int, rate: float | None) -> Load:
    """Ask a server on this machine for a page for some time; each connection waits for its answer.

    Latencies count from when each request was due by the rate a second; None for as many as possible.
    """
    return asyncio.run(_ask(port, path, seconds, connections, rate))


async def _ask(port: int, path: str, seconds: float, connections: int, rate: float | None) -> Load:
    load = Load()
    request = f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
    begun = time.perf_counter()
    due = iter(range(10**9))

    async def go_on() -> None:
        reader, writer = await asyncio.open_connection("127.0.0.1", port, limit=1 << 22)
        try:
            while True:
                start = begun + next(due) / rate if rate else time.perf_counter()
                if max(start, time.perf_counter()) >= begun + seconds:
                    return
                await asyncio.sleep(max(0.0, start - time.perf_counter()))
                writer.write(request)
                status, body = await read_answer(reader)
                load.size = len(body)
                load.latencies.append(time.perf_counter() - start)
                load.failures += status != 200
        finally:
            writer.close()

    await asyncio.gather(*(go_on() for _ in range(connections)))
    load.seconds = time.perf_counter() - begun
    return load


async def read_answer(reader: asyncio.StreamReader) -> tuple[int, bytes]:
    """Read an answer; return its status and its body."""
    head = await reader.readuntil(b"\r\n\r\n")
    size = int(head.lower().partition(b"content-length: ")[2].split(b"\r\n")[0])
    return int(head.split(b" ", 2)[1]), await reader.readexactly(size)
