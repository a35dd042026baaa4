"""Who sits where at a table: people with their names and pages, and robots for those who are not here."""

import asyncio
import unicodedata
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

from wildscav.errors import WildscavError
from wildscav.sdk.connection import Connection
from wildscav.version import __version__
from wildscav_stage.display import Events, display_of
from wildscav_stage.eyes import Eyes, Moment, moment_of
from wildscav_stage.inputs import Controls
from wildscav_stage.plan import Plan, numbered

if TYPE_CHECKING:
    from wildscav.agent import MatchInfo, Observation
    from wildscav_engine.simulation.match import Match

MAX_BEHIND = 0.1  # s that the match may be behind real time before it stops catching up
LONGEST_NAME = 20  # characters
HOST = 0  # the seat of whoever started the table


class View(NamedTuple):
    """What there is to show of one moment."""

    moment: Moment
    display: dict[str, Any]
    taken: int  # number of the last input that took effect before it


class Person:
    """Plays one match after another with what ``controls`` receives."""

    def __init__(self) -> None:
        self.controls = Controls()
        self.clock_runs = asyncio.Event()  # cleared while the match is paused
        self.clock_runs.set()
        self._events = Events()
        self._shown = asyncio.Event()  # set when there is an observation that was not looked at
        self._match: Match
        self._info: MatchInfo
        self._observation: Observation

    async def play(self, match: "Match", address: str, token: str) -> None:
        """Play a match to its end.

        Args:
            match: The match that the server hosts, from which the seat's pictures are made.
            address: Where the server listens.
            token: The seat's token.

        Raises:
            ServerUnreachableError: The match was ended before it was over.
        """
        loop = asyncio.get_running_loop()
        self._match = match
        self.controls.release()
        async with Connection(address, token, __version__) as connection:
            self._info = connection.match
            observation = await connection.first()
            due = loop.time()
            while observation is not None:
                self._note(observation)
                due = max(due + self._info.step_time, loop.time() - MAX_BEHIND)
                await asyncio.sleep(max(0.0, due - loop.time()))
                await self.clock_runs.wait()
                action = self.controls.take(observation.yaw, self._info.frames_per_action)
                self._shown.clear()  # the match goes on, so what was not looked at by now is over
                observation = await connection.answer(observation.step, action)

    def _note(self, observation: "Observation") -> None:
        self._observation = observation
        self._events.note(observation)
        self._shown.set()

    async def look(self) -> View:
        """Wait for a moment that was not looked at, and return it.

        The match waits for this seat's answer, so it is still in the state of the last observation.
        """
        await self._shown.wait()
        self._shown.clear()
        shown = display_of(self._observation, self._info) | self._events.take()
        return View(moment_of(self._match), shown, self.controls.taken)


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
        self.person, self.eyes = Person(), Eyes(seat)
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
