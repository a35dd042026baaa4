"""The table at which a person plays one match after another, and what it tells the person's page."""

import asyncio
import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wildscav.errors import WildscavError, describe
from wildscav.play.display import metric_titles, scores_of
from wildscav.play.eyes import Eyes
from wildscav.play.opponents import playing
from wildscav.play.person import Person
from wildscav.play.plan import Plan
from wildscav.server import Clock, MatchServer
from wildscav.terminal.console import command
from wildscav_engine.record import SUFFIX, write_record
from wildscav_engine.simulation.match import MatchSetupError
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAMES_PER_SECOND

if TYPE_CHECKING:
    from wildscav.server import HostedMatch

SEAT = 0  # the person's
SCORES_EVERY = 0.5  # s
LONGEST_PAUSE = 86_400.0  # s, of a match against robots alone, which wait for the person
AGENT_CLOCK = Clock(game_time_factor=10.0)  # at 50 steps a second, twice the game time would be 40 ms a step
ROBOT_CLOCK = Clock(time_bank=LONGEST_PAUSE, game_time_factor=LONGEST_PAUSE)
Tell = Callable[[dict[str, Any]], None]


class Table:
    """Plays matches of a plan when the person's page asks for them.

    Args:
        plan: What is played.
        server: The server that hosts the matches.
        address: Where it listens.
        folder: For records, and for the output of agents.
        say: Called with a line for whoever started the table.
    """

    def __init__(
        self, plan: Plan, server: MatchServer, address: str, folder: Path, say: Callable[[str], None]
    ) -> None:
        self.person, self.eyes = Person(), Eyes(SEAT)
        self._plan, self._server, self._address, self._folder = plan, server, address, folder
        self._say = say
        self._tell: Tell | None = None  # the page's
        self._situation: dict[str, Any] = {"kind": "lobby"}
        self._match: asyncio.Task[None] | None = None
        self._played = 0

    # The interface for the person's page.

    def attach(self, tell: Tell) -> None:
        """Tell everything to a page from now on, first what it needs to know of the present."""
        self._tell = tell
        spec = self._plan.spec
        tell(
            {
                "kind": "table",
                "track": spec.track,
                "names": self._plan.names,
                "seat": SEAT,
                "time_limit": spec.time_limit,
                "may_pause": self._plan.against_robots,
            }
        )
        tell(self._situation)

    def detach(self, tell: Tell) -> None:
        """Tell a page nothing anymore; the match is paused if it may be."""
        if self._tell == tell:
            self._tell = None
            self.person.controls.release()
            self.pause(True)

    def start(self) -> None:
        """Start the next match, unless one is being played."""
        if self._match is None or self._match.done():
            self._match = asyncio.create_task(self._run())

    def pause(self, paused: bool) -> None:
        """Pause the match, or go on; does nothing if others than robots would have to wait."""
        if not self._plan.against_robots or self._situation["kind"] != "begin":
            return
        if paused:
            self.person.clock_runs.clear()
        else:
            self.person.clock_runs.set()
        self._situation["paused"] = paused
        self._announce({"kind": "paused", "paused": paused})

    async def close(self) -> None:
        """End the match that is being played."""
        if self._match is not None:
            self._match.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._match

    # One match.

    async def _run(self) -> None:
        self._change({"kind": "preparing"})
        try:
            await self._play()
        except (WildscavError, MatchSetupError) as error:
            self._fail(str(error))
        except OSError as error:
            self._fail(describe(error))

    def _fail(self, message: str) -> None:
        self._say(message)
        self._change({"kind": "failed", "message": message})

    async def _play(self) -> None:
        spec = self._plan.played(self._played)
        self._played += 1
        opponents = dict(enumerate(self._plan.opponents, start=1))
        hosted = await self._server.host(
            spec,
            names=self._plan.names,
            sensors={seat: each.sensors for seat, each in opponents.items() if each.sensors},
            clock=ROBOT_CLOCK if self._plan.against_robots else AGENT_CLOCK,
        )
        folders = {seat: each.folder for seat, each in opponents.items() if each.folder is not None}
        try:
            await asyncio.to_thread(self.eyes.prepare, hosted.match.game_map)
            self._folder.mkdir(parents=True, exist_ok=True)
            async with playing(folders, hosted, self._address, self._folder):
                await self._play_hosted(hosted)
        finally:
            hosted.cancel()  # does nothing after its end

    async def _play_hosted(self, hosted: "HostedMatch") -> None:
        self.person.clock_runs.set()
        fields = hosted.match.track.fields
        self._change(
            {
                "kind": "begin",
                "paused": False,
                "weapon": Field.SHOOT in fields,
                "supplies": Field.PICK_UP in fields,
                "has_target": hosted.match.track.has_target,
                "metrics": metric_titles(hosted.match),
            }
        )
        if self._tell is None:
            self.pause(True)
        scoring = asyncio.create_task(self._tell_scores(hosted))
        try:
            await self.person.play(hosted.match, self._address, hosted.tokens[SEAT])
        finally:
            scoring.cancel()
        await self._finish(hosted)

    async def _tell_scores(self, hosted: "HostedMatch") -> None:
        while True:
            self._announce({"kind": "scores", "rows": scores_of(hosted.match, hosted.names)})
            await asyncio.sleep(SCORES_EVERY)

    async def _finish(self, hosted: "HostedMatch") -> None:
        """Write the record, and tell the result."""
        match = (await hosted.finished()).match
        path = self._folder / f"{match.spec.track}-{time.strftime('%Y%m%d-%H%M%S')}{SUFFIX}"
        await asyncio.to_thread(write_record, path, match, hosted.names)
        self._say(f"record: {path}")
        ending = match.result().ending
        self._change(
            {
                "kind": "over",
                "ending": ending,
                "time": match.frame / FRAMES_PER_SECOND,
                "metrics": metric_titles(match),
                "rows": scores_of(match, hosted.names),
                "record": str(path.absolute()),
                "commands": [f"{command('wildscav')} {verb} {path}" for verb in ("replay", "verify")],
            }
        )

    def _change(self, situation: dict[str, Any]) -> None:
        self._situation = situation
        self._announce(situation)

    def _announce(self, message: dict[str, Any]) -> None:
        if self._tell is not None:
            self._tell(message)
