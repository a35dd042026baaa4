"""Who sits where at a table: people with their names and pages, and robots for those who are not here."""

import unicodedata
from collections.abc import Sequence
from typing import Any, Protocol

from wildscav.errors import WildscavError
from wildscav.play.eyes import Eyes
from wildscav.play.person import Person
from wildscav.play.plan import Plan, numbered

LONGEST_NAME = 20  # characters
HOST = 0  # the seat of whoever started the table


class LobbyError(WildscavError):
    """Somebody asked for what is not possible; the message says why."""


class Page(Protocol):
    """A page that somebody has open."""

    def tell(self, message: dict[str, Any]) -> None:
        """Send it a message."""

    def dismiss(self, code: int, reason: str) -> None:
        """Close it."""


class Chair:
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
        self.chairs = tuple(Chair(seat, plan.names[seat]) for seat in range(plan.people))

    def rename(self, seat: int, text: str) -> None:
        """Call a person by another name, from the next match on.

        Raises:
            LobbyError: It is no name, or somebody else's.
        """
        name = _checked_name(text)
        taken = [chair.name for chair in self.chairs if chair.seat != seat]
        taken += self._plan.names[self._plan.people :]
        if name.casefold() in map(str.casefold, taken):
            raise LobbyError(f"somebody else is called {name}; take another name")
        self.chairs[seat].name = name

    def absent(self) -> tuple[int, ...]:
        """Return the seats of the people who are not here."""
        return tuple(chair.seat for chair in self.chairs if chair.page is None)

    def names(self, absent: Sequence[int]) -> tuple[str, ...]:
        """Return the display name of every seat, with robots in the seats of those who are absent."""
        people = [self._plan.stand_in if chair.seat in absent else chair.name for chair in self.chairs]
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
