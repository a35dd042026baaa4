"""The desk answers the calls of clients: it takes requests, and passes the tools of a seat on to the seat."""

import asyncio
import sys
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager
from inspect import signature
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from pydantic import ValidationError, create_model

from wildscav.errors import UserError
from wildscav.words import Reply
from wildscav_engine.specs.validation import one_line
from wildscav_language.calls import Reason
from wildscav_language.mcp_server import reports
from wildscav_language.mcp_server.hosting import image_of
from wildscav_language.mcp_server.matches import ClientSeat, ClientsMatch, Matches
from wildscav_language.mcp_server.requests import Code, Handle, Marks, Request, StartMatch
from wildscav_language.rules_text import rules
from wildscav_language.tools import TOOLS

WAIT = 45.0  # s that a call waits for the end of its tool, because assistants give up after a minute
TURN = 5.0  # s that a call waits for the end of another of its seat
RECORD_ADDRESS = "wildscav://records/{key}"  # of the resource
REPLAY = "replay.html"
MAKES_REPLAY = "from wildscav.cli.main import main; main()"
SAID = 300  # characters of an error of the command that makes replays, and of arguments in a replay
MOST_NAME = 40  # characters of a tool's name
STILL = "Your call is still being played: observe to read its end."
BUSY = "another call of your seat is being answered: ask again"
MAKING = "the replay is being made: ask again in a minute"
COMPILING = "the engine is being compiled, once: ask again in a minute"
OVER = "The match is over."
WAITING = "the match has not begun, since other seats are not ready: ask again"

Value = TypeVar("Value")


class Answer(NamedTuple):
    """What a client is answered."""

    text: str
    picture: bytes | None = None  # PNG
    is_refusal: bool = False


Act = Callable[..., Awaitable[Answer | str]]
ACTS: dict[str, tuple[type[Request], Act]] = {}  # by name: the model of a request, and who answers it


def act(method: Act) -> Act:
    """Let clients call a method of the desk. Its docstring and its arguments are what they are told of it."""
    asked = {name: argument for name, argument in signature(method).parameters.items() if name != "self"}
    if "request" in asked:  # which has all arguments in it
        ACTS[method.__name__] = asked["request"].annotation, method
        return method
    fields: dict[str, Any] = {
        name: (argument.annotation, ... if argument.default is argument.empty else argument.default)
        for name, argument in asked.items()
    }
    model = create_model(method.__name__, __base__=Request, __doc__=method.__doc__, **fields)
    ACTS[method.__name__] = model, lambda desk, request: method(desk, **dict(request))
    return method


class Desk:
    """Answers the calls of all clients of a server.

    Args:
        matches: The matches of the server.
        ready: Done when the engine is compiled.
        link: Returns the link of a match's replay; None if there is no web server.
    """

    def __init__(
        self, matches: Matches, ready: asyncio.Future[None], link: Callable[[ClientsMatch], str] | None
    ) -> None:
        self.matches = matches
        self.is_local = link is None  # whether its client may know the server's files
        self._ready, self._link = ready, link
        self._waiting = ThreadPoolExecutor(256, "calls")  # in which calls wait; none is started in vain

    async def answer(self, name: str, arguments: Mapping[str, Any]) -> Answer:
        """Answer a call.

        Raises:
            UserError: It cannot be answered; the message says what is allowed.
        """
        if name not in ACTS:
            return await self._play(name, arguments)
        kind, play = ACTS[name]
        try:
            request = kind.model_validate(arguments)
        except ValidationError as error:
            fields = (
                ", ".join(field.alias or name for name, field in kind.model_fields.items()) or "no arguments"
            )
            raise UserError(f"{name} takes {fields}; {one_line(error)}") from None
        answer = await play(self, request)
        return Answer(answer) if isinstance(answer, str) else answer

    async def _play(self, name: str, arguments: Mapping[str, Any]) -> Answer:
        """Play a tool of a seat until it ends, or as long as a call may wait."""
        given = dict(arguments)
        handle = given.pop("seat", None)
        if not isinstance(handle, str):
            tools = ", ".join((*ACTS, *(tool.name for tool in TOOLS)))
            raise UserError(f"{name[:MOST_NAME]!r} needs the handle of your seat; the tools are {tools}")
        match, seat = self.matches.seat(handle)
        thought = str(given.pop("thought", ""))
        async with _turn_of(seat):
            if match.is_over_for(seat):
                return await self._end(match, seat)
            if seat.is_busy:
                raise UserError(STILL)
            match.note(seat, f"{thought} → {name[:MOST_NAME]} {_shown(given)}".strip())
            return await self._end_of(match, seat, lambda: seat.words.call(name, given, WAIT))

    async def _end_of(self, match: ClientsMatch, seat: ClientSeat, wait: Callable[[], Reply]) -> Answer:
        """Wait for the end of a seat's tool, and tell it."""
        if match.is_over_for(seat):
            return await self._end(match, seat)
        seat.is_busy = True  # also if the client gives up meanwhile
        try:
            reply = await self._in_thread(match, seat, wait)
        except UserError:
            seat.is_busy = False
            raise
        seat.is_busy = reply.ended == Reason.PLAYING
        if seat.is_busy:
            return Answer(STILL)
        match.note(seat, reply.text.partition("\n")[0])
        if reply.over:
            return await self._end(match, seat)
        return Answer(reply.text, is_refusal=reply.ended == Reason.REFUSED)

    async def _end(self, match: ClientsMatch, seat: ClientSeat) -> Answer:
        """Tell how a seat's part in its match has ended, and the score."""
        if match.hosted.match.over:  # then its record is about to be written
            await asyncio.wait({match.task}, timeout=WAIT)
        detail = match.hosted.seats[seat.number].conduct.detail
        how = f"Your seat is closed: {detail}." if detail else match.failure or OVER
        return Answer(f"{how}\n\n{reports.score(match, seat)}")

    async def _in_thread(self, match: ClientsMatch, seat: ClientSeat, wait: Callable[[], Value]) -> Value:
        waiting = seat.waiting = asyncio.get_running_loop().run_in_executor(self._waiting, wait)
        try:
            return await asyncio.shield(waiting)  # it goes on if the client gives up
        except TimeoutError:
            over = match.failure or (OVER if match.is_over_for(seat) else "")
            raise UserError(over or WAITING) from None

    # What clients may ask for.

    @act
    async def start_match(self, request: StartMatch) -> str:
        """Start a match, and take its first seat. See ``StartMatch``."""
        try:
            await asyncio.wait_for(asyncio.shield(self._ready), WAIT)
        except TimeoutError:
            raise UserError(COMPILING) from None
        match = await self.matches.start(request)
        told, others = reports.seated(match, match.next_seat()), len(match.seats) - 1
        return f"{told}\njoin code for {others} more clients: {match.code}" if others else told

    @act
    async def join_match(self, code: Code) -> str:
        """Take the next free seat of a match that another client has started."""
        return reports.seated(*self.matches.join(code))

    @act
    async def list_matches(self) -> str:
        """List the matches of this server."""
        return "\n".join(map(reports.state, self.matches)) or "There is no match: start one with start_match."

    @act
    async def rules(self, handle: Handle) -> str:
        """Read the rules of your match."""
        match, seat = self.matches.seat(handle)
        async with _turn_of(seat):
            return rules(await self._in_thread(match, seat, lambda: seat.words.begun(WAIT)))

    @act
    async def observe(self, handle: Handle) -> Answer:
        """Read what your seat senses now, or the end of a call that was still being played. It costs no time."""  # noqa: E501
        match, seat = self.matches.seat(handle)
        async with _turn_of(seat):
            if seat.is_busy or match.is_over_for(seat):
                return await self._end_of(match, seat, lambda: seat.words.wait(WAIT))
            return Answer(await self._in_thread(match, seat, lambda: seat.words.observe(WAIT)))

    @act
    async def picture(self, handle: Handle, marks: Marks = False) -> Answer:
        """Get a picture of what your seat sees now. It costs no time."""
        match, seat = self.matches.seat(handle)
        async with _turn_of(seat):
            if seat.is_busy:
                raise UserError(STILL)
            await self._in_thread(match, seat, lambda: seat.words.begun(WAIT))
            picture = seat.words.picture(image_of(match.hosted.match, seat.number), marks=marks)
        return Answer(f"What seat {seat.number} sees now.", picture)

    @act
    async def score(self, handle: Handle) -> str:
        """Read the score of all seats when your match is over; before, what you and your team carry."""
        return reports.score(*self.matches.seat(handle))

    @act
    async def record(self, handle: Handle) -> str:
        """Get the record of your match when it is over: a small file that anybody can verify."""
        match, _ = self.matches.seat(handle)
        path = _recorded(match)
        resource = f"resource: {RECORD_ADDRESS.format(key=match.key)}"
        if not self.is_local:
            return f"{resource}\nAnybody can verify it: wildscav verify FILE"
        return f"{path}\n{resource}\nAnybody can verify it: wildscav verify {path}"

    @act
    async def replay(self, handle: Handle) -> str:
        """Get a page that plays your match in 3D in any browser, when it is over."""
        match, _ = self.matches.seat(handle)
        record, page = _recorded(match), match.folder / REPLAY
        if match.replaying is None:
            match.replaying = asyncio.create_task(_make_replay(record, page))
        done, _ = await asyncio.wait({match.replaying}, timeout=WAIT)
        if not done:
            raise UserError(MAKING)
        match.replaying.result()
        return str(page) if self._link is None else self._link(match)

    @act
    async def leave(self, handle: Handle) -> str:
        """Leave the match. Your seat stands still from now on, and the others play on."""
        match, seat = self.matches.seat(handle)
        match.leave(seat)
        if all(match.hosted.seats[one.number].gone for one in match.seats):  # then the rest is played at once
            await asyncio.wait({match.task}, timeout=WAIT)
        return f"You have left {match.id}."


@asynccontextmanager
async def _turn_of(seat: ClientSeat) -> AsyncIterator[None]:
    """Hold a seat while a call of it is answered, and as long as the call's thread waits.

    Raises:
        UserError: Another call of the seat is being answered.
    """
    try:
        await asyncio.wait_for(seat.calling.acquire(), TURN)
    except TimeoutError:
        raise UserError(BUSY) from None
    try:
        yield
    finally:
        if seat.waiting is None or seat.waiting.done():
            seat.calling.release()
        else:
            seat.waiting.add_done_callback(lambda _: seat.calling.release())


def _shown(arguments: Mapping[str, Any]) -> str:
    """Return the arguments of a call as people read them."""
    return ", ".join(f"{name} {value}" for name, value in arguments.items())[:SAID]


def _recorded(match: ClientsMatch) -> Path:
    """Return the record of a match that is over.

    Raises:
        UserError: It is not, or has failed.
    """
    if match.result is None:
        raise UserError(match.failure or f"{match.id} is not over: play on, or leave it")
    return match.record


async def _make_replay(record: Path, page: Path) -> None:
    """Make the page that plays a record, by the command that does.

    Raises:
        UserError: It cannot be made here.
    """
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-c", MAKES_REPLAY, "replay", str(record), "--html", "--out", str(page)),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.PIPE,
    )
    _, said = await process.communicate()
    if process.returncode:
        raise UserError(f"no replay can be made: {' '.join(said.decode(errors='replace').split())[:SAID]}")
