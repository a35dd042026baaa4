"""Who sits where at a table: people with their names and pages, and robots for those who are not here."""

import asyncio
import math
import time
import unicodedata
from collections.abc import Callable, Sequence
from http import HTTPStatus
from typing import TYPE_CHECKING, Any

from wildscav.errors import UserError, WildscavError
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_server.hosting.opponents import numbered
from wildscav_stage.playing.inputs import Controls
from wildscav_stage.playing.links import Links
from wildscav_stage.playing.page import RENEWED, OpenPage
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.room import EntryError, Room
from wildscav_stage.playing.sight import Known, Sight

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

MAX_BEHIND = 0.1  # s that the match may be behind real time before it stops catching up
LONGEST_NAME = 20  # characters
MAX_ROBOTS = 8  # that the host can choose, unless there are more already
ON_THE_WAY = 30.0  # s in which somebody who was let in opens the page of their seat
HOST_RETURNS = 5.0  # s in which a host who loads the page again is back
HOST = 0  # the seat of whoever started the table


class Person:
    """Plays one match after another with what ``controls`` receives."""

    def __init__(self) -> None:
        self.controls = Controls()
        self.clock_runs = asyncio.Event()  # cleared while the match is paused
        self.clock_runs.set()
        self._sight: Sight | None = None  # in the present match
        self._changed = asyncio.Event()  # set, and replaced, after each frame

    async def play(self, match: "Match", address: str, token: str, noted: Callable[[], None]) -> None:
        """Play a match that the server at an address hosts to its end; ``noted`` is called after each frame.

        Raises:
            ServerUnreachableError: The match was ended before it was over.
        """
        self.controls.release()
        try:
            async with Connection(address, token, __version__) as connection:
                await self._play(connection, match, noted)
        finally:
            self._sight = None

    async def _play(self, connection: Connection, match: "Match", noted: Callable[[], None]) -> None:
        loop, info = asyncio.get_running_loop(), connection.match
        observation = await connection.first()
        self._sight, due = Sight(match, info.seat), loop.time()
        while observation is not None:
            self.controls.confirm()
            self._sight.note()
            noted()
            self._tell()
            due = max(due + info.step_time, loop.time() - MAX_BEHIND)
            await asyncio.sleep(max(0.0, due - loop.time()))
            await self.clock_runs.wait()
            action = self.controls.take(observation.yaw, info.frames_per_action, info.turn_speed)
            observation = await connection.answer(observation.step, action)

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()

    async def look(self, known: Known) -> dict[str, Any]:
        """Wait until there is something to tell a page; return it, and note in ``known`` that it is told."""
        while (sight := self._sight_for(known)) is None or not sight.has_news_for(known):
            await self._changed.wait()
        told = {"input": self.controls.taken, **sight.message(known)}
        return told | {"ahead": self.controls.ahead} if any(self.controls.ahead) else told

    def _sight_for(self, known: Known) -> Sight | None:
        """Return what may be told of the present match; a page that did not know it is told no past."""
        if self._sight is not None and known.sight is not self._sight:
            known.begin(self._sight)
            self._sight.forget()
        return self._sight


class LobbyError(WildscavError):
    """Somebody asked for what is not possible; the message says why."""


class PlayerSeat:
    """One person's seat; the name is what they are called until they say otherwise."""

    def __init__(self, seat: int, name: str) -> None:
        self.seat = seat
        self.person = Person()
        self.page: OpenPage | None = None  # the one that the person has open
        self.left = -math.inf  # s, when they had one last
        self.free(name)

    def free(self, name: str) -> None:
        """Forget who had the seat."""
        self.name = name
        self.came = False  # whether somebody was ever here
        self.is_ready = False  # whether they want the next match to start
        self._kept_until = 0.0  # s, for somebody who is on the way

    def keep(self) -> None:
        """Keep the seat for somebody who is on the way."""
        self._kept_until = time.monotonic() + ON_THE_WAY

    @property
    def is_free(self) -> bool:
        """Whether nobody has the seat, or is on the way to it."""
        return self.page is None and not self.came and time.monotonic() >= self._kept_until

    def describe(self) -> dict[str, Any]:
        """Return what everybody may know of the person, as JSON has it."""
        where = "here" if self.page is not None else "away" if self.came else "expected"
        told = {"seat": self.seat, "name": self.name, "where": where, "host": self.seat == HOST}
        return told | {"ready": self.is_ready}


class Lobby:
    """The people of a table."""

    def __init__(self, plan: Plan, links: Links) -> None:
        self.plan, self._links, self.room = plan, links, Room()
        if plan.people > 1:
            self.room.open()
        self.wants_new_map = False  # for the next match
        self.seats = tuple(PlayerSeat(seat, plan.names[seat]) for seat in range(plan.people))

    def rename(self, seat: int, text: str) -> None:
        """Call a person by another name, from the next match on.

        Raises:
            LobbyError: It is no name, or somebody else's.
        """
        name = _checked_name(text)
        taken = [player.name for player in self.seats if player.seat != seat]
        taken += self.plan.names[self.plan.people :]
        if name.casefold() in map(str.casefold, taken):
            raise LobbyError(f"somebody else is called {name}; take another name")
        self.seats[seat].name = name

    def free(self, asked_by: int, seat: int) -> None:
        """Free a seat: give it a new link, and close the page that was opened by the old one.

        Raises:
            LobbyError: Somebody else than the host asks for it, or it is no guest's seat.
        """
        only_host(asked_by, "frees seats")
        if not 0 < seat < len(self.seats):
            raise LobbyError(f"seat {seat} is no guest's")
        self._links.renew(seat)
        player = self.seats[seat]
        if player.page is not None:
            player.page.dismiss(RENEWED, "the host has freed this seat")
        player.free(self.plan.names[seat])

    def open_room(self, asked_by: int, *, is_open: bool) -> None:
        """Make another code by which guests come, or end the present one.

        Raises:
            LobbyError: Somebody else than the host asks for it, or there are no seats for guests.
        """
        only_host(asked_by, "opens and closes the room")
        if len(self.seats) == 1:
            raise LobbyError("there are no seats for guests")
        if is_open:
            self.room.open()
        else:
            self.room.close()

    def let_in(self, code: str) -> str:
        """Give a free seat to whoever has the code, and return its secret, which nobody had before.

        Links are sent for the first seats first, so this is the last one.

        Raises:
            EntryError: The code is wrong, too many were tried, or all seats are taken.
        """
        self.room.check(code)
        guests = self.seats[HOST + 1 :]
        player = next((player for player in reversed(guests) if player.is_free), None)
        if player is None:
            raise EntryError("All seats are taken. Ask the host to free one.", HTTPStatus.CONFLICT)
        player.keep()
        self._links.renew(player.seat)
        return self._links.of_seat(player.seat)

    def arrange(self, asked_by: int, robots: Sequence[str], *, new_map: bool) -> None:
        """Choose the robots of the next matches, and whether the next one is on another map.

        Raises:
            LobbyError: Somebody else than the host asks for it, or such a match is not possible.
        """
        only_host(asked_by, "chooses what is played")
        most = max(MAX_ROBOTS, len(self.plan.robots))
        if len(robots) > most:
            raise LobbyError(f"at most {most} robots can play")
        try:
            self.plan = self.plan.arranged(robots, new_map=False)
        except UserError as error:
            raise LobbyError(str(error)) from None
        self.wants_new_map = new_map

    def begin(self) -> Plan:
        """Return the plan of the match that begins; nobody wants it anymore."""
        if self.wants_new_map:
            self.plan, self.wants_new_map = self.plan.arranged(self.plan.robots, new_map=True), False
        for player in self.seats:
            player.is_ready = False
        return self.plan

    @property
    def all_ready(self) -> bool:
        """Whether the host has been away for some time, and everybody who is here wants to play."""
        if time.monotonic() - self.seats[HOST].left < HOST_RETURNS:
            return False
        here = [player for player in self.seats if player.page is not None]
        return bool(here) and all(player.is_ready and player.seat != HOST for player in here)

    def absent(self) -> tuple[int, ...]:
        """Return the seats of the people who are not here, and for whom robots play."""
        if self.plan.given is not None:
            return ()  # the match waits
        return tuple(player.seat for player in self.seats if player.page is None)

    def names(self, absent: Sequence[int]) -> tuple[str, ...]:
        """Return the display name of every seat, with robots in the seats of those who are absent."""
        if self.plan.given is not None:
            return self.plan.names
        people = [self.plan.stand_in if player.seat in absent else player.name for player in self.seats]
        return numbered([*people, *(opponent.name for opponent in self.plan.opponents)])


def only_host(seat: int, does: str) -> None:
    """Check that the host asks for something.

    Raises:
        LobbyError: It is somebody else.
    """
    if seat != HOST:
        raise LobbyError(f"only the host {does}")


def _checked_name(text: str) -> str:
    """Return a name in its usual form.

    Raises:
        LobbyError: It is empty, too long, or has characters that cannot be seen.
    """
    name = unicodedata.normalize("NFC", " ".join(text.split()))
    if not 1 <= len(name) <= LONGEST_NAME or not name.isprintable():
        raise LobbyError(f"a name has 1 to {LONGEST_NAME} visible characters")
    return name
