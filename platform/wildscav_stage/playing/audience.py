"""What spectators are sent: one message a moment, made once for all of them when the first one takes it.

A message is JSON in the units of ``sight.py``: ``frame``; ``agents``, of each that is in the match the seat
and its row; ``shots`` and ``deaths``; ``boxes`` and ``gone``; ``zone``. The first one to a page, and the next
after any that it missed, has all boxes (``all`` is 1) and the ``target``.
"""

import asyncio
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from wildscav_stage.playing.sight import Happenings, box_rows, boxes_of, rows_of, zone_of
from wildscav_stage.scene.map_file import centimetres

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

AUDIENCE_FRAMES = 4  # from one message to the next


class Audience:
    """Makes the messages of one match after another."""

    def __init__(self) -> None:
        self._match: Match | None = None
        self._number = 0
        self._changed = asyncio.Event()  # set, and replaced, when there is a new message

    def begin(self, match: "Match") -> None:
        """Show a match from now on."""
        self._match, self._happenings = match, Happenings(match)
        self._number += 1  # so that nobody has the one before the first message
        self._shots: list[list[int]] = []
        self._deaths: list[list[int]] = []
        self._boxes: dict[int, list[int]] = {}  # the rows of those that were told, by serials
        self._noted = match.frame
        self._offer()

    def end(self) -> None:
        """Show nothing."""
        self._match = None

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
        """Offer a message of this moment to everybody; what nobody took of the last one is forgotten."""
        self._number += 1
        self._happened = {"shots": self._shots, "deaths": self._deaths}
        self._shots, self._deaths = [], []
        self._told: dict[str, Any] = {}  # not made yet
        self._changed.set()
        self._changed = asyncio.Event()

    def _make(self) -> None:
        match = self._present()
        agents = [[seat, *row] for seat, row in enumerate(rows_of(match).tolist())]
        present = {row[0]: row for row in box_rows(match, boxes_of(match))}
        told = {
            "agents": [agents[seat] for seat in np.flatnonzero(match.state.agents.present[0]).tolist()],
            "zone": zone_of(match),
            **self._happened,
        }
        new = [row for serial, row in present.items() if serial not in self._boxes]
        gone = [serial for serial in self._boxes if serial not in present]
        self._told = {"frame": match.frame} | {name: value for name, value in told.items() if value}
        self._news = {name: value for name, value in (("boxes", new), ("gone", gone)) if value}
        self._boxes, self._texts = present, dict[bool, str]()

    async def next(self, after: int) -> tuple[int, str]:
        """Wait for a message that is newer than a number; return its number, and JSON without ``{``."""
        while self._match is None or self._number <= after:
            await self._changed.wait()
        if not self._told:
            self._make()
        is_next = self._number == after + 1
        if is_next not in self._texts:
            more = self._news if is_next else self._everything()
            self._texts[is_next] = json.dumps(self._told | more, separators=(",", ":"))[1:]
        return self._number, self._texts[is_next]

    def _everything(self) -> dict[str, Any]:
        matches = self._present().state.matches
        target = {"target": centimetres(matches.target[0]).tolist()} if matches.has_target[0] else {}
        return {"all": 1, "boxes": list(self._boxes.values()), **target}

    def _present(self) -> "Match":
        if self._match is None:
            raise RuntimeError("there is no match to show")
        return self._match
