"""Who sits where at a table: people with their names and pages, and robots for those who are not here."""

import asyncio
import unicodedata
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any, Protocol

from wildscav.errors import WildscavError
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_server.hosting.opponents import numbered
from wildscav_stage.playing.inputs import Controls
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.sight import Known, Sight

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

MAX_BEHIND = 0.1  # s that the match may be behind real time before it stops catching up
LONGEST_NAME = 20  # characters
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
        """Play a match to its end.

        Args:
            match: The match that the server hosts, of which the seat's page is told what it may know.
            address: Where the server listens.
            token: The seat's token.
            noted: Called after each frame.

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
            action = self.controls.take(observation.yaw, info.frames_per_action)
            observation = await connection.answer(observation.step, action)

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()

    async def look(self, known: Known) -> dict[str, Any]:
        """Wait until there is something to tell a page, and return it.

        Args:
            known: What the page was told; it is brought up to date.
        """
        while (sight := self._sight_for(known)) is None or not sight.has_news_for(known):
            await self._changed.wait()
        return {"input": self.controls.taken, **sight.message(known)}

    def _sight_for(self, known: Known) -> Sight | None:
        """Return what may be told of the present match; a page that did not know it is told no past."""
        if self._sight is not None and known.sight is not self._sight:
            known.begin(self._sight)
            self._sight.forget()
        return self._sight


class LobbyError(WildscavError):
    """Somebody asked for what is not possible; the message says why."""


class Page(Protocol):
    """A page that somebody has open."""

    def tell(self, message: dict[str, Any]) -> None:
        """Send it a message."""

    def dismiss(self, code: int, reason: str) -> None:
        """Close it."""


class PlayerSeat:
    """One person's seat.

    Args:
        seat: Its number.
        name: What the person is called until they say otherwise.
    """

    def __init__(self, seat: int, name: str) -> None:
        self.seat, self.name = seat, name
        self.person = Person()
        self.page: Page | None = None  # the one that the person has open
        self.came = False  # whether somebody was ever here

    def describe(self) -> dict[str, Any]:
        """Return what everybody may know of the person, as JSON has it."""
        where = "here" if self.page is not None else "away" if self.came else "expected"
        return {"seat": self.seat, "name": self.name, "where": where, "host": self.seat == HOST}


class Lobby:
    """The people of a table.

    Args:
        plan: What is played at it.
    """

    def __init__(self, plan: Plan) -> None:
        self._plan = plan
        self.seats = tuple(PlayerSeat(seat, plan.names[seat]) for seat in range(plan.people))

    def rename(self, seat: int, text: str) -> None:
        """Call a person by another name, from the next match on.

        Raises:
            LobbyError: It is no name, or somebody else's.
        """
        name = _checked_name(text)
        taken = [player.name for player in self.seats if player.seat != seat]
        taken += self._plan.names[self._plan.people :]
        if name.casefold() in map(str.casefold, taken):
            raise LobbyError(f"somebody else is called {name}; take another name")
        self.seats[seat].name = name

    def absent(self) -> tuple[int, ...]:
        """Return the seats of the people who are not here."""
        return tuple(player.seat for player in self.seats if player.page is None)

    def names(self, absent: Sequence[int]) -> tuple[str, ...]:
        """Return the display name of every seat, with robots in the seats of those who are absent."""
        people = [self._plan.stand_in if player.seat in absent else player.name for player in self.seats]
        return numbered([*people, *(opponent.name for opponent in self._plan.opponents)])


def _checked_name(text: str) -> str:
    """Return a name in its usual form.

    Raises:
        LobbyError: It is empty, too long, or has characters that cannot be seen.
    """
    name = unicodedata.normalize("NFC", " ".join(text.split()))
    if not 1 <= len(name) <= LONGEST_NAME or not name.isprintable():
        raise LobbyError(f"a name has 1 to {LONGEST_NAME} visible characters")
    return name
