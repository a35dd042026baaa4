"""The short code with which guests take the free seats of a table."""

import secrets
import time
from collections.abc import Callable
from http import HTTPStatus

from wildscav.errors import WildscavError
from wildscav_stage.playing.page import Allowance

LETTERS = "BCDFGHJKLMNPQRSTVWXZ"  # no vowels: there are no words, and nothing looks like 0 or 1
LETTERS_OF_CODE = 6
LASTING = 1800.0  # s that a code is valid
NOT_VALID = "This code is not valid. It may have ended: ask the host for the present one."
MAX_TRIES, MINUTE = 30, 60.0  # codes that all strangers together may try, in so many s


class EntryError(WildscavError):
    """Somebody is not let in; the message says why, and what to do."""

    def __init__(self, message: str, status: HTTPStatus) -> None:
        super().__init__(message)
        self.status = status


class Room:
    """Who may come to a table by a code, and until when."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock, self._code, self._end = clock, "", 0.0
        self._tries = Allowance(MAX_TRIES, MINUTE, clock)

    @property
    def code(self) -> str:
        """The present code; an empty text if there is none."""
        return self._code if self.seconds_left else ""

    @property
    def seconds_left(self) -> int:
        """How long the code is still valid."""
        return max(0, int(self._end - self._clock()))

    def open(self) -> None:
        """Make another code, which replaces the present one."""
        self._code = "".join(secrets.choice(LETTERS) for _ in range(LETTERS_OF_CODE))
        self._end = self._clock() + LASTING

    def close(self) -> None:
        """End the code."""
        self._end = 0.0

    def check(self, text: str) -> None:
        """Check a code that somebody typed.

        Raises:
            EntryError: It is wrong, or too many were tried.
        """
        if not self._tries.count():
            raise EntryError(
                "Too many codes were tried. Try again in a minute.", HTTPStatus.TOO_MANY_REQUESTS
            )
        if not is_code(text, self.code):
            raise EntryError(NOT_VALID, HTTPStatus.FORBIDDEN)


def is_code(text: str, code: str) -> bool:
    """Return whether what somebody typed, in letters of either size, is a code; an empty one is none."""
    typed = "".join(letter for letter in text.upper() if letter.isalnum())
    return bool(code) and secrets.compare_digest(typed.encode(errors="replace"), code.encode())
