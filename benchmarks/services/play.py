"""How soon a person is told what came of what was done, and how much is sent.

    python -m benchmarks.services.play [--people 1] [--opponents 9] [--seconds 20] [--json FILE]

A client on this machine plays as the page does, without a browser: it walks and turns all the time, and the
delay is the time from sending an input to having read the first message that tells of it. The page shows its
own person's view and steps before that. A spectator looks on, and what a browser loads once is counted as it
is sent, compressed. Measure on an idle machine.
"""

import asyncio
import json
import re
import time
from contextlib import AsyncExitStack
from pathlib import Path
from statistics import mean, median, quantiles
from tempfile import TemporaryDirectory
from typing import Annotated
from urllib.parse import urljoin
from urllib.request import ProxyHandler, build_opener

import typer
from benchmarks.report import Figure, JsonFile, publish
from websockets.asyncio.client import ClientConnection, connect

from wildscav_stage.playing.plan import make_plan
from wildscav_stage.playing.site.serve import prepare, served

INPUTS = 60.0  # a second, as from a display
WARM_UP = 2.0  # s


class Player:
    """Plays as the page does, or watches, and measures."""

    def __init__(self, socket: ClientConnection) -> None:
        self._socket = socket
        self._sent: dict[int, float] = {}  # when inputs were sent, by their numbers
        self.delays: list[float] = []  # s
        self.shown: list[float] = []  # when messages about the match had been read, s
        self.bytes = 0

    async def turn(self) -> None:
        """Send inputs as fast as a display draws."""
        number = 0
        while True:
            number += 1
            self._sent[number] = time.perf_counter()
            await self._send({"kind": "input", "number": number, "turn": 1.5, "forward": 1.0})
            await asyncio.sleep(1.0 / INPUTS)

    async def watch(self, seconds: float) -> None:
        """Read messages for some time."""
        end = float("inf")
        while time.perf_counter() < end:
            text = await self._socket.recv()
            if self.shown:
                self.bytes += len(text)
            message = json.loads(text)
            if message["kind"] in ("now", "all"):
                self._note(message.get("input", 0))
                end = min(end, self.shown[0] + WARM_UP + seconds)
                await self._send({"kind": "seen", "number": message["number"]})

    def _note(self, taken: int) -> None:
        now = time.perf_counter()
        self.shown.append(now)
        for number in [number for number in self._sent if number <= taken]:
            sent = self._sent.pop(number)
            if number == taken and now > self.shown[0] + WARM_UP:
                self.delays.append(now - sent)

    @property
    def rate(self) -> float:
        """Messages about the match a second, after warming up."""
        counted = [when for when in self.shown if when > self.shown[0] + WARM_UP]
        return (len(counted) - 1) / (counted[-1] - counted[0])

    @property
    def down(self) -> float:
        """Bytes a second that were sent here."""
        return self.bytes / (self.shown[-1] - self.shown[0])

    async def start(self) -> None:
        """Start the match."""
        await self._send({"kind": "start"})

    async def _send(self, message: dict[str, object]) -> None:
        await self._socket.send(json.dumps(message))


async def play(track: str, people: int, opponents: int, seconds: float, folder: Path) -> list[Figure]:
    """Play, and return what was measured; with several people, the mean of what each of them gets."""
    plan = make_plan(track, None, 0, ["fighter"] * opponents, 600.0, people)
    prepare(plan)
    async with AsyncExitStack() as stack:
        links, _ = await stack.enter_async_context(served(plan, folder, "127.0.0.1", 0, print, countdown=0))
        everybody = []
        for link in (links.watch, links.host, *links.guests):
            address = f"{link.replace('http:', 'ws:')}/socket"
            everybody.append(
                Player(await stack.enter_async_context(connect(address, proxy=None, max_queue=None)))
            )
        spectator, *players = everybody
        await players[0].start()
        turning = [asyncio.create_task(player.turn()) for player in players]
        await asyncio.gather(*(each.watch(seconds) for each in everybody))
        for task in turning:
            task.cancel()
        once = await asyncio.to_thread(_loaded_once, links.host)
    return [*_figures(players), Figure("down to a spectator", spectator.down / 1000, "kB/s"), *once]


def _loaded_once(link: str) -> list[Figure]:
    """Return the sizes of what a player's browser loads."""
    opener = build_opener(ProxyHandler({}))
    opener.addheaders = [("Accept-Encoding", "gzip")]

    def loaded(address: str) -> bytes:
        with opener.open(urljoin(link, address)) as answer:
            content: bytes = answer.read()
        return content

    page = loaded(link)
    files = re.findall(r'(?:src|href)="([^"]+)"', page.decode())
    size = len(page) + sum(len(loaded(file)) for file in files)
    return [Figure("page", size / 1000, "kB"), Figure("map", len(loaded(f"{link}/map")) / 1000, "kB")]


def _figures(players: list[Player]) -> list[Figure]:
    delays = [delay for player in players for delay in player.delays]
    size = mean(player.down for player in players)
    return [
        Figure("messages about the match", mean(player.rate for player in players), "/s"),
        Figure("input to message, median", 1000 * median(delays), "ms"),
        Figure("input to message, 95 % within", 1000 * quantiles(delays, n=20)[-1], "ms"),
        Figure("down", size / 1000, "kB/s"),
    ]


def main(
    track: Annotated[str, typer.Option(help="Track to play.")] = "battle",
    people: Annotated[int, typer.Option(help="How many play.", min=1, max=8)] = 1,
    opponents: Annotated[int, typer.Option(help="How many robots play besides.", min=0)] = 9,
    seconds: Annotated[float, typer.Option(help="How long to measure.")] = 20.0,
    json_file: JsonFile = None,
) -> None:
    """Measure the delay from input to message, and what is sent."""
    with TemporaryDirectory() as folder:
        figures = asyncio.run(play(track, people, opponents, seconds, Path(folder)))
    publish(f"{people} {'person plays' if people == 1 else 'people play'} {track}", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
