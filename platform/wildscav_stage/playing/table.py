"""The table at which people play one match after another, and what it tells their pages."""

import asyncio
import contextlib
import time
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from wildscav.errors import describe
from wildscav.terminal.console import command
from wildscav_engine.simulation.robots.decide import ROBOTS
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_stage.playing import lobby
from wildscav_stage.playing.audience import Audience
from wildscav_stage.playing.fights import Fights, metric_titles, scores_of
from wildscav_stage.playing.links import Base, Links, new_secret
from wildscav_stage.playing.lobby import HOST, Lobby, PlayerSeat, only_host
from wildscav_stage.playing.page import RENEWED, REPLACED, SEATED, OpenPage
from wildscav_stage.playing.plan import Plan
from wildscav_stage.playing.rounds import MatchHosting, beside, hosted_match, play_out
from wildscav_stage.scene.map_file import map_file
from wildscav_stage.scene.trails import seats_shown
from wildscav_stage.viewer_files import digest

if TYPE_CHECKING:
    from wildscav_engine.specs.map_spec import MapSpec
    from wildscav_server.hosting.hosted_match import HostedMatch

SCORES_EVERY = 0.5  # s
MAX_SPECTATORS = 20
COUNTDOWN = 3  # s before a match of several people, so that all are ready
ENDED = ("over", "failed")  # situations in which the next match may start
# What a page needs to show what it expects until the server tells what happened.
TOLD_RULES = (
    "water_speed_factor",
    "turn_speed",
    "fire_interval",
    "supply_sight",
    "reload_time",
    "view_angle",
)
HOST_KNOWS, NOBODY_KNOWS = "The host's page says why.", "Something went wrong here. Try again in a moment."
HOST_ALONE_KNOWS = ("record", "commands")  # of a match's end: where files lie


class Table:
    """Plays matches of a plan when the host's page asks for them.

    Args:
        plan: What is played.
        hosting: Where the matches are played.
        links: The links of its people and spectators.
        base: Where its pages are reached.
        say: Called with a line for whoever started the table.
        countdown: s before a match of several people.
        delay: s after which spectators are told of a match; None for what the plan says.
        at_home: Whether this machine is the host's, who may then know where files lie and what went wrong.
    """

    def __init__(
        self,
        plan: Plan,
        hosting: MatchHosting,
        links: Links,
        base: Base,
        say: Callable[[str], None],
        countdown: int = COUNTDOWN,
        *,
        delay: float | None = None,
        at_home: bool = True,
    ) -> None:
        self.lobby = Lobby(plan, links)
        self.audience = Audience(plan.delay if delay is None else delay)
        self.map_file: bytes | None = None  # of the present match, or of the last one
        self.map_key = ""  # the digest of ``map_file``
        # The pages of spectators in the order in which they came, and the seats of those who wait for one.
        self._spectators: dict[OpenPage, int | None] = {}
        self._hosting, self._links, self._base, self._say = hosting, links, base, say
        self._countdown, self.at_home = countdown, at_home
        self.records: dict[str, Path] = {}  # of the matches that were played, each with a secret of its own
        self._situation: dict[str, Any] = {"kind": "lobby"}
        self._shown = self._situation  # to spectators, who are told later
        self._playing: frozenset[int] = frozenset()  # the people's seats in the present match
        self._match: asyncio.Task[None] | None = None
        self._is_wanted = False  # whether another match starts when the present one has left
        self._played = 0
        self._is_complete = False  # whether the last of the given matches was played
        self._drawn: MapSpec | None = None  # the map in ``map_file``

    @property
    def _plan(self) -> Plan:
        return self.lobby.plan

    @property
    def is_attended(self) -> bool:
        """Whether somebody who plays has a page open."""
        return any(player.page is not None for player in self.lobby.seats)

    # The interface for people's pages.

    def attach(self, seat: int, page: OpenPage) -> None:
        """Tell everything to a page from now on, first what it needs to know of the present."""
        player = self.lobby.seats[seat]
        if player.page is not None:
            player.page.dismiss(REPLACED, "the link was opened elsewhere")
        player.page, player.came = page, True
        player.person.controls.release()
        page.tell(self._introduction(player))
        self.tell_people()
        page.tell(self._present_to(player))

    def detach(self, seat: int, page: OpenPage) -> None:
        """Tell a page nothing anymore; its seat stands idle, and the match is paused if it may be."""
        player = self.lobby.seats[seat]
        if player.page is page:
            player.page, player.is_ready, player.left = None, False, time.monotonic()
            player.person.controls.release()
            self.pause(True)
            self.tell_people()
            asyncio.get_running_loop().call_later(lobby.HOST_RETURNS + 0.1, self._start_if_all_want)
            self._start_if_all_want()

    def start(self, seat: int) -> None:
        """Start the next match, unless one is being played.

        Raises:
            LobbyError: Somebody else than the host asks for it.
        """
        only_host(seat, "starts matches")
        if self._is_complete:
            raise lobby.LobbyError("all matches were played")
        self._start()

    def vote(self, seat: int, *, ready: bool) -> None:
        """Note whether a person wants the next match to start; without the host, it does when all want it."""
        self.lobby.seats[seat].is_ready = ready and not self._is_playing
        self._start_if_all_want()

    def _start_if_all_want(self) -> None:
        if self.lobby.all_ready:
            self._start()

    @property
    def _is_playing(self) -> bool:
        return self._is_running and self._situation["kind"] not in ENDED

    @property
    def _is_running(self) -> bool:
        return self._match is not None and not self._match.done()

    def _start(self) -> None:
        if not self._is_running:
            self._match = asyncio.create_task(self._run())
        elif not self._is_playing:
            self._is_wanted = True

    def pause(self, paused: bool) -> None:
        """Pause the match, or go on; does nothing if others than robots would have to wait."""
        if not self._plan.may_pause or self._situation["kind"] != "begin":
            return
        (player,) = self.lobby.seats
        if paused:
            player.person.clock_runs.clear()
        else:
            player.person.clock_runs.set()
        self._situation["paused"] = paused
        self._announce({"kind": "paused", "paused": paused})

    def is_waiting(self, seat: int) -> bool:
        """Return whether a person waits for the end of the match that others play."""
        return bool(self._playing) and seat not in self._playing

    def let_in(self, code: str) -> str:
        """Give a free seat to whoever has the code, and return its secret.

        Raises:
            EntryError: The code is wrong, too many were tried, or all seats are taken.
        """
        secret = self.lobby.let_in(code)
        self.tell_people()
        return secret

    def admit(self, page: OpenPage, seat: int | None = None) -> bool:
        """Tell everything to a spectator's page from now on; return whether there was room for it.

        ``seat`` is the seat of whoever watches until they can take it.
        """
        if len(self._spectators) >= MAX_SPECTATORS:
            return False
        self._spectators[page] = seat
        page.tell(self._introduction(None))
        self.tell_people()
        page.tell(self._shown)
        return True

    def free(self, asked_by: int, seat: int) -> None:
        """Free a seat, and put out whoever has it or watches by its link; see ``Lobby.free``."""
        self.lobby.free(asked_by, seat)
        for page, own in self._spectators.items():
            if own == seat:
                page.dismiss(RENEWED, "the host has freed this seat")

    def dismiss(self, page: OpenPage) -> None:
        """Tell a spectator's page nothing anymore."""
        del self._spectators[page]
        self.tell_people()

    async def close(self) -> None:
        """End the match that is being played."""
        if self._match is not None:
            self._match.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await self._match

    # One match.

    async def _run(self) -> None:
        """Play a match, and others as long as they are wanted while the one before leaves."""
        self._is_wanted = True
        while self._is_wanted:
            self._is_wanted = False
            await self._run_one()

    async def _run_one(self) -> None:
        self._change({"kind": "preparing"})
        try:
            await self._play()
        except Exception as error:  # noqa: BLE001 - pages are told of any, and may start another match
            self._fail(describe(error))
        finally:
            self._playing = frozenset()
            self.audience.end()
            for page, seat in self._spectators.items():
                if seat is not None:
                    page.dismiss(SEATED, "the match is over")

    def _fail(self, message: str) -> None:
        self._say(message)
        self._change({"kind": "failed", "message": message})

    async def _play(self) -> None:
        absent, plan = self.lobby.absent(), self.lobby.begin()
        spec, names = plan.played(self._played, absent), self.lobby.names(absent)
        self._played += 1
        if plan.given is not None:
            plan.given.begin()
        for page, player in self._people():
            page.tell(self._introduction(player))  # another match may be on another track
        self.tell_people()
        people = {player.seat: player.person for player in self.lobby.seats if player.seat not in absent}
        async with hosted_match(self._hosting, plan, spec, names) as hosted:
            if self._drawn != spec.map:
                self.map_file = await asyncio.to_thread(map_file, hosted.match.game_map)
                self.map_key, self._drawn = digest(self.map_file), spec.map
            self._playing = frozenset(people)
            if len(people) > 1:
                await self._count_down()
            self._begin(hosted)
            fights = Fights(hosted.match)

            def note() -> None:
                self.audience.note()
                fights.note()

            async with beside(self._tell_scores(hosted)):
                record = None if plan.given is None else plan.given.record
                path = await play_out(self._hosting, hosted, people, note, record)
            if plan.given is not None:
                following = plan.given.end(await hosted.finished())
                self._is_complete = following is None
                self.lobby.plan = following or plan
            self._finish(hosted, path, fights)

    async def _count_down(self) -> None:
        for seconds in range(self._countdown, 0, -1):
            self._change({"kind": "countdown", "seconds": seconds})
            await asyncio.sleep(1.0)

    def _begin(self, hosted: "HostedMatch") -> None:
        for seat in self._playing:
            self.lobby.seats[seat].person.clock_runs.set()
        fields, spec = hosted.match.track.fields, hosted.match.spec
        self._change(
            {
                "kind": "begin",
                "paused": False,
                "map": self.map_key,
                "weapon": Field.SHOOT in fields,
                "supplies": Field.PICK_UP in fields,
                "metrics": metric_titles(hosted.match),
                "seats": [seat.model_dump() for seat in seats_shown(spec, hosted.names, None)],
                "frame_limit": spec.frame_limit,
                "frames_per_action": spec.frames_per_action,
                "rules": {name: getattr(spec.rules, name) for name in TOLD_RULES},
            }
        )
        self.audience.begin(hosted.match)
        if self.lobby.seats[HOST].page is None:
            self.pause(True)

    async def _tell_scores(self, hosted: "HostedMatch") -> None:
        while True:
            self._announce({"kind": "scores", "rows": scores_of(hosted.match, hosted.names)})
            await asyncio.sleep(SCORES_EVERY)

    def _finish(self, hosted: "HostedMatch", path: Path, fights: Fights) -> None:
        """Tell the result."""
        match = hosted.match
        fights.note()  # the last frame, which nobody was told of
        metrics, rows = metric_titles(match), scores_of(match, hosted.names)
        columns = fights.columns(metrics)
        for row in rows:
            row["values"] += [fights.figure(row["seat"], column["title"]) for column in columns]
        self._say(f"record: {path}")
        secret = new_secret()
        self.records[secret] = path
        self._change(
            {
                "kind": "over",
                "ending": match.result().ending,
                "time": match.frame / FRAMES_PER_SECOND,
                "metrics": metrics + columns,
                "rows": rows,
                "played": sorted(self._playing),
                "match": {"secret": secret, "record": path.name if self.at_home else None},
                "next": self._next(),
                "record": str(path.absolute()),
                "commands": [command("wildscav", verb, path) for verb in ("replay", "verify")],
            }
        )

    def _next(self) -> str:
        """Return what the button says that starts the next match; an empty text if there is none."""
        given = self._plan.given
        return "" if self._is_complete else "Play again" if given is None else f"Play {given.title}"

    # What pages are told.

    def _introduction(self, player: PlayerSeat | None) -> dict[str, Any]:
        spec = self._plan.spec
        return {
            "kind": "table",
            "track": spec.track,
            "title": spec.track if self._plan.given is None else self._plan.given.title,
            "names": [each.name for each in self.lobby.seats] + list(self._plan.names[self._plan.people :]),
            "people": self._plan.people,
            "seat": None if player is None else player.seat,
            "may_pause": self._plan.may_pause,
            "stand_in": self._plan.stand_in,
            "is_range": bool(self._plan.targets),
            "kinds": [] if self._plan.targets or self._plan.given else list(ROBOTS),
            "delay": self.audience.delay,
        }

    def tell_people(self) -> None:
        """Tell everybody who is here, and what is played next; how to invite others, to the host alone."""
        people = [player.describe() for player in self.lobby.seats]
        told = {
            "kind": "people",
            "people": people,
            "spectators": len(self._spectators),
            "opponents": self._plan.names[self._plan.people :],
            "robots": self._plan.robots,
            "new_map": self.lobby.wants_new_map,
        }
        for page, player in self._people():
            page.tell(told | self._invitations() if _is_host(player) else told)
        for page in self._spectators:
            page.tell(told)

    def _invitations(self) -> dict[str, Any]:
        guests = self.lobby.seats[HOST + 1 :]
        return {
            "links": {player.seat: self._base.invitation(self._links, player.seat) for player in guests},
            "room": self._entrance() if guests else None,
            "watch_link": self._base.watching(self._links),
            "local_only": self.at_home and self._base.local_only,
        }

    def _entrance(self) -> dict[str, Any]:
        code = self.lobby.room.code
        return {"code": code, "link": self._base.entrance(code), "seconds": self.lobby.room.seconds_left}

    def _present_to(self, player: PlayerSeat | None) -> dict[str, Any]:
        """Return the situation as a person, or a spectator, may know it."""
        situation = self._situation
        if situation["kind"] in ("begin", "countdown") and player and player.seat not in self._playing:
            return {"kind": "elsewhere"}
        if self.at_home and _is_host(player):
            return situation
        if situation["kind"] == "over":
            return {key: value for key, value in situation.items() if key not in HOST_ALONE_KNOWS}
        if situation["kind"] == "failed":
            return {"kind": "failed", "message": HOST_KNOWS if self.at_home else NOBODY_KNOWS}
        return situation

    def _change(self, situation: dict[str, Any]) -> None:
        self._situation = situation
        for page, player in self._people():
            page.tell(self._present_to(player))
        self.audience.later(self._show, dict(self._present_to(None)))

    def _announce(self, message: dict[str, Any]) -> None:
        for page, _ in self._people():
            page.tell(message)
        self.audience.later(self._show, dict(message))

    def _show(self, message: dict[str, Any]) -> None:
        """Tell spectators what happens to a match."""
        if message["kind"] == "paused":
            self._shown |= {"paused": message["paused"]}
        elif message["kind"] != "scores":
            self._shown = message
        for page in self._spectators:
            page.tell(message)

    def _people(self) -> list[tuple[OpenPage, PlayerSeat]]:
        """Return the pages of people with their seats."""
        return [(player.page, player) for player in self.lobby.seats if player.page is not None]


def _is_host(player: PlayerSeat | None) -> bool:
    return player is not None and player.seat == HOST
