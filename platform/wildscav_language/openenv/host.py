"""Where the matches of environments are played: a match server in a thread of its own."""

import asyncio
import atexit
import secrets
import threading
from collections.abc import Coroutine, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, TypeVar

from wildscav.errors import WildscavError
from wildscav_engine.record import SUFFIX, write_record
from wildscav_engine.sensors import parse_sensors
from wildscav_language.mcp_server import hosting
from wildscav_language.mcp_server.requests import StartMatch
from wildscav_language.seat import Seat
from wildscav_language.senses import sensors
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.opponents import playing
from wildscav_server.hosting.precompile import precompile
from wildscav_server.leftovers import own_folder, temporary_folder
from wildscav_server.match_server import MatchServer

IDLE_LIMIT = 600.0  # s that a match waits for a call, after which its seat is closed
END_TIME = 60.0  # s for the result and the record of a match that is over

Value = TypeVar("Value")


class HostedEpisode:
    """A match of which one seat, the first, is played by words."""

    def __init__(self, hosted: HostedMatch, record: Path | None) -> None:
        self.hosted, self.record = hosted, record
        self.seat = Seat(hosted.names)
        self.failure = ""  # why it has no result or no record
        self.task: asyncio.Task[None]  # which plays it

    @property
    def score(self) -> float:
        """The track's score of the seat so far, turned so that more is better."""
        match = self.hosted.match
        first = match.track.metrics[0]
        value = float(match.track.measure(match, 0)[first.name])
        return -value if first.lower_is_better else value

    def picture(self) -> bytes:
        """Return what the seat sees now, as a PNG file."""
        return self.seat.picture(hosting.image_of(self.hosted.match, 0))

    async def play(self, folders: Mapping[int, Path], address: str) -> None:
        """Play it to its end with the baselines in some folders, by their seats, and write its record."""
        try:
            await self._played(folders, address)
        except Exception as error:  # noqa: BLE001 - the client is told
            # Without paths of the server.
            self.failure = getattr(error, "strerror", None) or str(error) or type(error).__name__
        finally:
            self.hosted.cancel()  # does nothing after its end
            self.seat.leave()

    async def _played(self, folders: Mapping[int, Path], address: str) -> None:
        with temporary_folder("openenv-") as logs:
            async with playing(folders, self.hosted, dict.fromkeys(folders, address), logs):
                # A daemon, so that a process can end while a match waits for it.
                token = self.hosted.tokens[0]
                threading.Thread(target=self._play_seat, args=(address, token), daemon=True).start()
                match = (await self.hosted.finished()).match
                if self.record is not None:
                    await asyncio.to_thread(write_record, self.record, match, self.hosted.names)

    def _play_seat(self, address: str, token: str) -> None:
        with suppress(WildscavError):  # the match was cancelled, or the server has closed the seat
            self.seat.play(address, token)


class Host:
    """Hosts the matches of the environments of a process. It compiles the engine, which takes a minute once.

    Args:
        records: The folder for records of matches that are over; None keeps none.
        idle_limit: s that a match waits for a call, after which its seat is closed.
    """

    def __init__(self, records: Path | None = None, idle_limit: float = IDLE_LIMIT) -> None:
        precompile(parse_sensors(sensors(pictures=True)).values())
        if records is not None:
            records.mkdir(parents=True, exist_ok=True)
        self._records = records
        self._idle_limit = idle_limit
        self._playing: set[asyncio.Task[None]] = set()
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name="openenv-host", daemon=True)
        self._thread.start()
        self._server, (self._address,) = self._do(self._serve())
        atexit.register(self.close)

    def start(self, request: StartMatch, name: str) -> HostedEpisode:
        """Start a match, the name of whose record begins with ``name``.

        Raises:
            UserError: It cannot be played.
        """
        return self._do(self._start(request, name))

    def ending(self, episode: HostedEpisode) -> str:
        """Return how a seat's part in its match has ended; waits for the record of a match that is over."""
        match, closed = episode.hosted.match, episode.hosted.seats[0].conduct.detail
        if not match.over:
            return f"Your seat is closed: {closed or episode.failure or 'the match has failed'}."
        self._do(_ended(episode))
        over = f"The match is over, because of {match.result().ending.replace('_', ' ')}."
        over += f" Your seat was closed: {closed}." if closed else ""
        return f"{over} It has no record: {episode.failure}." if episode.failure else over

    def abandon(self, episode: HostedEpisode) -> None:
        """End a match without a result, unless it is over."""
        with suppress(RuntimeError):  # the host is closed, and its matches have ended
            self._loop.call_soon_threadsafe(episode.hosted.cancel)

    def close(self) -> None:
        """End all matches and the server; does nothing the second time."""
        atexit.unregister(self.close)
        if self._loop.is_running():
            self._do(self._stop())
            self._loop.call_soon_threadsafe(self._loop.stop)
            self._thread.join()
            self._loop.close()

    def _do(self, work: Coroutine[Any, Any, Value]) -> Value:
        return asyncio.run_coroutine_threadsafe(work, self._loop).result()

    async def _serve(self) -> tuple[MatchServer, list[str]]:
        server = MatchServer()
        return server, await server.start([f"unix:{own_folder()}/{secrets.token_hex(4)}"])

    async def _start(self, request: StartMatch, name: str) -> HostedEpisode:
        hosted, folders = await hosting.host(self._server, request, self._idle_limit)
        # Clients choose names, and several may choose the same.
        file = f"{name}-{secrets.token_hex(4)}{SUFFIX}"
        episode = HostedEpisode(hosted, self._records and self._records / file)
        episode.task = asyncio.create_task(episode.play(folders, self._address))
        self._playing.add(episode.task)
        episode.task.add_done_callback(self._playing.discard)
        return episode

    async def _stop(self) -> None:
        await self._server.stop()
        await asyncio.gather(*self._playing)
        await self._loop.shutdown_default_executor()


async def _ended(episode: HostedEpisode) -> None:
    await asyncio.wait({episode.task}, timeout=END_TIME)
