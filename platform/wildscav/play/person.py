"""A person's seat: a client of the match server whose answers come in real time."""

import asyncio
from typing import TYPE_CHECKING, Any, NamedTuple

from wildscav.play.display import Events, display_of
from wildscav.play.eyes import Moment, moment_of
from wildscav.play.inputs import Controls
from wildscav.sdk.connection import Connection
from wildscav.version import __version__

if TYPE_CHECKING:
    from wildscav.agent import MatchInfo, Observation
    from wildscav_engine.simulation.match import Match

MOST_BEHIND = 0.1  # s that the match may be behind real time before it stops catching up


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
                due = max(due + self._info.step_time, loop.time() - MOST_BEHIND)
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
