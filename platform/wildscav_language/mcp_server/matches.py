"""Matches that clients play by words: hosted by the match server, which waits for them, and recorded."""

import asyncio
import contextlib
import secrets
from collections.abc import AsyncIterator, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from wildscav.errors import UserError, WildscavError
from wildscav.notes import LONGEST_TEXT, note_line
from wildscav.sdk.connection import Connection
from wildscav.terminal.console import error_console
from wildscav.version import __version__
from wildscav_engine.record import SUFFIX, write_record
from wildscav_language.mcp_server.hosting import host
from wildscav_language.mcp_server.requests import StartMatch
from wildscav_language.seat import Seat
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.opponents import playing
from wildscav_server.leftovers import temporary_folder
from wildscav_server.match_server import MatchServer

if TYPE_CHECKING:
    from wildscav_engine.specs.result import MatchResult

KEPT = 20  # matches that are over, whose score and record can be asked for, and whose maps stay in memory
MOST_NOTES = 1_000_000  # bytes of notes of a seat
CLOSING_TIME = 1.5  # s that matches have to end when the server does; clients kill it after two


class Bounds(NamedTuple):
    """What a server allows."""

    matches: int = 8  # played at one time
    idle_limit: float = 600.0  # s for a client's next action, after which its seat is closed


class ClientSeat:
    """A seat of a match that a client plays."""

    def __init__(self, number: int, names: Sequence[str]) -> None:
        self.number = number
        self.handle = f"seat-{secrets.token_hex(8)}"  # whoever has it plays the seat
        self.is_taken = False
        self.words = Seat(names)
        self.calling = asyncio.Lock()  # held while a call is answered
        self.waiting: asyncio.Future[Any] | None = None  # the last thread in which a call of it has waited
        self.noted = 0  # bytes of its notes
        self.is_busy = False  # whether a tool goes on whose end its call did not wait for

    async def play(self, address: str, token: str) -> None:
        """Play to the end of the match, or until the server closes the seat."""
        loop, agent = asyncio.get_running_loop(), self.words.agent
        acting = ThreadPoolExecutor(1, self.handle)  # since ``act`` waits for the client's calls
        try:
            async with Connection(address, token, __version__) as connection:
                agent.reset(connection.match)
                observation = await connection.first()
                while observation is not None:
                    action = await loop.run_in_executor(acting, agent.act, observation)
                    observation = await connection.answer(observation.step, action)
        finally:
            self.words.finish()
            acting.shutdown(wait=False)


class ClientsMatch:
    """A match with seats for clients; its folder gets the record, and what baselines print."""

    def __init__(self, number: int, hosted: HostedMatch, seats: Sequence[ClientSeat], folder: Path) -> None:
        self.id = f"{hosted.match.spec.track}-{number}"
        self.code = f"join-{secrets.token_hex(4)}"
        self.key = secrets.token_urlsafe(16)  # whoever has it may read the record and the replay
        self.replaying: asyncio.Task[None] | None = None  # which makes the replay
        self.hosted, self.seats, self.folder = hosted, tuple(seats), folder
        self.result: MatchResult | None = None  # once it is over
        self.failure = ""  # why it has no result
        self.task: asyncio.Task[None]  # which plays it

    @property
    def record(self) -> Path:
        """Where its record is once it is over."""
        return self.folder / f"match{SUFFIX}"

    @property
    def is_open(self) -> bool:
        """Whether it has neither a result nor failed."""
        return self.result is None and not self.failure

    def is_over_for(self, seat: ClientSeat) -> bool:
        """Return whether the match is over, or a seat has been left or closed."""
        if self.hosted.seats[seat.number].gone:
            seat.words.leave()  # since a seat that the server has closed waits for a call
        return seat.words.is_over

    async def play(self, folders: Mapping[int, Path], address: str) -> None:
        """Play it to its end with the baselines in some folders, by their seats, and write its record."""
        playing_seats: list[asyncio.Task[None]] = []
        try:
            async with playing(folders, self.hosted, dict.fromkeys(folders, address), self.folder):
                for seat in self.seats:
                    token = self.hosted.tokens[seat.number]
                    playing_seats.append(asyncio.create_task(seat.play(address, token)))
                match = (await self.hosted.finished()).match
                await asyncio.to_thread(write_record, self.record, match, self.hosted.names)
                self.result = await asyncio.to_thread(match.result)
        except Exception as error:  # noqa: BLE001 - a match that fails is no reason to end the others
            self.failure = str(error) or type(error).__name__
        finally:
            self.hosted.cancel()  # does nothing after its end
            for seat in self.seats:
                seat.words.leave()
        await self._note_failures(playing_seats)

    async def _note_failures(self, playing_seats: Sequence[asyncio.Task[None]]) -> None:
        """Print why seats of clients failed; a seat that the server has closed has not."""
        for ended in await asyncio.gather(*playing_seats, return_exceptions=True):
            if isinstance(ended, Exception) and not isinstance(ended, WildscavError):
                error_console.print(f"{self.id}: a seat failed: {ended!r}", markup=False)

    @property
    def free_seats(self) -> list[ClientSeat]:
        """The seats that a client can still take."""
        return [seat for seat in self.seats if not seat.is_taken and not self.hosted.seats[seat.number].gone]

    def next_seat(self) -> ClientSeat:
        """Take the next free seat.

        Raises:
            UserError: There is none.
        """
        if not (free := self.free_seats):
            raise UserError(f"{self.id} has no free seat for a client")
        free[0].is_taken = True
        return free[0]

    def note(self, seat: ClientSeat, text: str) -> None:
        """Add what a seat's client thinks, calls or is answered to what replays of the match show of it."""
        line = note_line(seat.words.step, say=text[:LONGEST_TEXT])
        seat.noted += len(line.encode())
        log = self.folder / f"match.seat-{seat.number}.log"
        if seat.noted <= MOST_NOTES:
            # Calls are answered even if the folder has been removed.
            with contextlib.suppress(OSError), log.open("a", encoding="utf-8") as file:
                file.write(line)

    def leave(self, seat: ClientSeat) -> None:
        """Let a seat stand still from now on."""
        seat.words.leave()
        self.hosted.give_up(seat.number, "its client left the match")

    def leave_all(self) -> None:
        """Let all seats of clients stand still from now on."""
        for seat in self.seats:
            self.leave(seat)


class Matches:
    """All matches of a server of MCP. Make one with ``serving``."""

    def __init__(self, server: MatchServer, address: str, folder: Path, bounds: Bounds) -> None:
        self._server, self._address, self._folder, self._bounds = server, address, folder, bounds
        self._numbers = 0  # of matches begun so far
        self._starting = 0  # that are being set up
        self._run = secrets.token_hex(2)  # so that another run writes elsewhere
        self._matches: dict[str, ClientsMatch] = {}  # by id, oldest first

    def __iter__(self) -> Iterator[ClientsMatch]:
        """Return an iterator over the matches, oldest first."""
        return iter(self._matches.values())

    async def start(self, request: StartMatch) -> ClientsMatch:
        """Start a match.

        Raises:
            UserError: It cannot be played, or too many are.
        """
        if self._starting + sum(match.is_open for match in self) >= self._bounds.matches:
            raise UserError(f"{self._bounds.matches} matches are being played: finish or leave one first")
        self._starting += 1
        starting = asyncio.ensure_future(self._started(request))
        starting.add_done_callback(self._keep)
        try:
            return await asyncio.shield(starting)
        except asyncio.CancelledError:  # nobody will play it
            starting.add_done_callback(_leave_all)
            raise

    def _keep(self, starting: asyncio.Future[ClientsMatch]) -> None:
        """Add a match that has been set up, unless it could not be."""
        self._starting -= 1
        if starting.cancelled() or starting.exception():
            return
        match = starting.result()
        self._matches[match.id] = match
        for old in [one.id for one in self if not one.is_open][:-KEPT]:
            del self._matches[old]

    async def _started(self, request: StartMatch) -> ClientsMatch:
        hosted, folders = await host(self._server, request, self._bounds.idle_limit)
        self._numbers += 1
        number = self._numbers
        folder = self._folder / f"{request.track}-{self._run}-{number}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            hosted.cancel()
            raise UserError(f"the match has no folder for its record: {error.strerror}") from None
        seats = [ClientSeat(seat, hosted.names) for seat in range(request.clients)]
        match = ClientsMatch(number, hosted, seats, folder)
        match.task = asyncio.create_task(match.play(folders, self._address))
        return match

    def seat(self, handle: str) -> tuple[ClientsMatch, ClientSeat]:
        """Return a client's seat and its match by the seat's handle.

        Raises:
            UserError: There is no such seat.
        """
        for match in self:
            for seat in match.seats:
                if secrets.compare_digest(seat.handle.encode(), handle.encode()):
                    return match, seat
        raise UserError(
            "no seat has this handle: start a match with start_match, or join one with join_match"
        )

    def join(self, code: str) -> tuple[ClientsMatch, ClientSeat]:
        """Take a free seat of a match by its join code.

        Raises:
            UserError: There is no such match, or it has no free seat.
        """
        for match in self:
            if secrets.compare_digest(match.code.encode(), code.encode()):
                return match, match.next_seat()
        raise UserError("no match has this join code: ask whoever started it, or start one with start_match")

    async def close(self) -> None:
        """End all matches; those that can end at once are recorded."""
        for match in self:
            if match.is_open:
                match.leave_all()
        tasks = [match.task for match in self]
        if tasks:
            await asyncio.wait(tasks, timeout=CLOSING_TIME)
        for match in self:
            match.hosted.cancel()


def _leave_all(starting: asyncio.Future[ClientsMatch]) -> None:
    """Leave a match that has been set up for nobody."""
    if not starting.cancelled() and not starting.exception():
        starting.result().leave_all()


@asynccontextmanager
async def serving(folder: Path, bounds: Bounds) -> AsyncIterator[Matches]:
    """Host matches within the block; their folder gets the records, and what baselines print."""
    with temporary_folder("mcp-") as place:
        server = MatchServer()
        (address,) = await server.start([f"unix:{place}/match"])
        matches = Matches(server, address, folder, bounds)
        try:
            yield matches
        finally:
            await matches.close()
            await server.stop()
