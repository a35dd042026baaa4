"""What spectators are sent: one message a moment, made once for all of them, and told some time later.

A message is JSON in the units of ``sight.py``: ``frame``, ``shots``, ``deaths``, and what is new since the
message before: ``moved``, of each agent that has changed the seat, bits that say which numbers of its row
have, and by how much each; ``left``, the seats that are no longer in the match; ``boxes``, ``gone`` and
``zone``. The first message to a page, and the next after any that it missed, has everything (``all`` is 1):
``agents``, of each that is in the match the seat and its row, all boxes, the zone, and the ``target``.
"""

import asyncio
import json
from collections import deque
from collections.abc import Callable
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from wildscav_stage.playing.sight import Happenings, box_rows, boxes_of, rows_of, zone_of
from wildscav_stage.scene.map_file import centimetres

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

Told = TypeVar("Told")
AUDIENCE_FRAMES = 4  # from one message to the next
KEPT = 6  # moments, so that whoever is a little late misses none
ROW = (0, 1, 2, 3, 4, *range(9, 16))  # columns of ``rows_of``: all but velocities and flags
BITS = 1 << np.arange(len(ROW))


class Moment:
    """What is told of one moment: what has happened since the moment before, and what is different now."""

    def __init__(self, match: "Match", happened: dict[str, Any], before: "Moment | None") -> None:
        matches = match.state.matches
        self.rows = rows_of(match)[:, ROW]
        self.present = match.state.agents.present[0].copy()
        self.boxes = {row[0]: row for row in box_rows(match, boxes_of(match))}
        self.zone = zone_of(match)
        self._target = centimetres(matches.target[0]).tolist() if matches.has_target[0] else None
        self._told = {"frame": match.frame, **happened}
        self._everything = ""
        self.number = 0  # of all that were told
        self.news: str | None = None  # None if everything is told, since somebody has come to the match
        if before is not None and not (self.present & ~before.present).any():
            self.news = self._news(before)

    def _news(self, before: "Moment") -> str:
        change = self.rows - before.rows
        moved = np.flatnonzero(self.present & change.any(axis=1)).tolist()
        new = {
            "moved": [
                [seat, int((change[seat] != 0) @ BITS), *change[seat][change[seat] != 0].tolist()]
                for seat in moved
            ],
            "left": np.flatnonzero(before.present & ~self.present).tolist(),
            "boxes": [row for serial, row in self.boxes.items() if serial not in before.boxes],
            "gone": [serial for serial in before.boxes if serial not in self.boxes],
            "zone": self.zone if self.zone != before.zone else None,
        }
        return self._text(new)

    @property
    def everything(self) -> str:
        """All of it, for whoever does not have the moment before."""
        if not self._everything:
            agents = [[seat, *self.rows[seat].tolist()] for seat in np.flatnonzero(self.present).tolist()]
            boxes = list(self.boxes.values())
            always = {"all": 1, "agents": agents, "boxes": boxes}
            self._everything = self._text(always | {"zone": self.zone, "target": self._target})
        return self._everything

    def _text(self, told: dict[str, Any]) -> str:
        """Return JSON without ``{``."""
        filled = {name: value for name, value in (self._told | told).items() if value or name == "frame"}
        return json.dumps(filled, separators=(",", ":"))[1:]


class Audience:
    """Makes the messages of one match after another, which are told some s later."""

    def __init__(self, delay: float = 0.0) -> None:
        self.delay = delay
        self._match: Match | None = None
        self._last: Moment | None = None  # that was made
        self._shown = deque[Moment](maxlen=KEPT)
        self._number = 0
        self._changed = asyncio.Event()  # set, and replaced, when there is a new message

    def begin(self, match: "Match") -> None:
        """Show a match from now on."""
        self._match, self._happenings, self._last = match, Happenings(match), None
        self._shots: list[list[int]] = []
        self._deaths: list[list[int]] = []
        self._noted = match.frame
        self._offer()

    def end(self) -> None:
        """Show nothing."""
        self._match = None
        self.later(self._show, None)

    def note(self) -> None:
        """Note what happened in a frame that was played; it may be called several times."""
        match = self._match
        if match is None or match.frame == self._noted:
            return
        self._noted = match.frame
        shooters = self._happenings.shooters()
        ends = centimetres(match.state.agents.shot_end[0, shooters]).tolist()
        self._shots += [[seat, *end] for seat, end in zip(shooters, ends, strict=True)]
        self._deaths += self._happenings.deaths()
        if match.frame % AUDIENCE_FRAMES == 0:
            self._offer()

    def _offer(self) -> None:
        """Make a message of this moment."""
        if self._match is None:
            return
        happened = {"shots": self._shots, "deaths": self._deaths}
        self._shots, self._deaths = [], []
        self._last = Moment(self._match, happened, self._last)
        self.later(self._show, self._last)

    def later(self, show: Callable[[Told], None], told: Told) -> None:
        """Show something when spectators may see it: what is given first is shown first."""
        if self.delay:
            asyncio.get_running_loop().call_later(self.delay, show, told)
        else:
            show(told)

    def _show(self, moment: Moment | None) -> None:
        """Tell a moment to everybody; None for nothing anymore."""
        if moment is None or moment.news is None:
            self._shown.clear()
        if moment is None:
            return
        self._number += 1
        moment.number = self._number
        self._shown.append(moment)
        self._changed.set()
        self._changed = asyncio.Event()

    async def next(self, after: int) -> tuple[int, str]:
        """Wait for a message that is newer than a number; return its number, and JSON without ``{``."""
        while not self._shown or self._shown[-1].number <= after:
            await self._changed.wait()
        for moment in self._shown:
            if moment.number == after + 1 and moment.news is not None:
                return moment.number, moment.news
        newest = self._shown[-1]
        return newest.number, newest.everything
