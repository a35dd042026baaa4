"""The pictures of a match for all spectators: who watch the same get the same, and all share one thread."""

import asyncio
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, NamedTuple

from wildscav.play.shots import Photographer, photographer_of

if TYPE_CHECKING:
    from wildscav.server import HostedMatch

RATE = 20.0  # pictures a second of a view at most: those who play need the processor, too
View = int | None  # a seat whose eyes are seen through; None for the overview


class Hung(NamedTuple):
    """The latest picture of a view."""

    number: int  # among all pictures
    frame: int  # of the match
    shown: dict[str, Any]
    picture: bytes  # JPEG


class Gallery:
    """Takes the pictures that somebody watches."""

    def __init__(self) -> None:
        self._watched: dict[object, View] = {}  # what each spectator watches
        self._latest: dict[View, Hung] = {}
        self._number = 0
        self._changed = asyncio.Event()  # set, and replaced, when there is something new to see
        self._anybody = asyncio.Event()  # set while somebody watches

    def watch(self, spectator: object, view: View) -> None:
        """Note what a spectator watches from now on."""
        self._watched[spectator] = view
        self._anybody.set()
        self._tell()

    def leave(self, spectator: object) -> None:
        """Note that a spectator has left."""
        self._watched.pop(spectator, None)
        if not self._watched:
            self._anybody.clear()

    async def next(self, spectator: object, after: int) -> Hung:
        """Wait for a picture of what a spectator watches that is newer than a number."""
        while True:
            hung = self._latest.get(self._watched[spectator])
            if hung is not None and hung.number > after:
                return hung
            await self._changed.wait()

    async def show(self, hosted: "HostedMatch") -> None:
        """Take pictures of a match until it is cancelled."""
        self._latest.clear()
        photographers: dict[View, Photographer] = {}
        loop = asyncio.get_running_loop()
        with ThreadPoolExecutor(1, "spectators") as painter:
            while True:
                await self._anybody.wait()
                began = loop.time()
                for view in set(self._watched.values()):
                    if view is None or view < hosted.match.seats:
                        photographer = photographers.get(view) or photographer_of(hosted, view)
                        photographers[view] = photographer
                        await self._take(hosted, view, photographer, painter)
                await asyncio.sleep(max(0.0, began + 1.0 / RATE - loop.time()))

    async def _take(
        self, hosted: "HostedMatch", view: View, photographer: Photographer, painter: Executor
    ) -> None:
        """Take a picture of a view, unless there is one of this frame."""
        hung, frame = self._latest.get(view), hosted.match.frame
        if hung is not None and hung.frame == frame:
            return
        shot = photographer.take()
        picture = await asyncio.get_running_loop().run_in_executor(painter, shot.make)
        self._number += 1
        self._latest[view] = Hung(self._number, frame, shot.shown, picture)
        self._tell()

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()
