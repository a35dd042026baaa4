"""The pictures of a match for all spectators: who watch the same get the same, and all share one thread."""

import asyncio
from collections.abc import Callable
from concurrent.futures import Executor, ThreadPoolExecutor
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np

from wildscav.proto.match_pb2 import Observation
from wildscav.wire.observations import decode_observation
from wildscav_engine.sensors import parse_sensors
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.video.cameras import ABOVE_FAR, ANGLE, HEAD, Camera, LiveAbove
from wildscav_server.hosting.observations import SeatObservations, match_info
from wildscav_stage.display import display_of
from wildscav_stage.eyes import HEIGHT, WIDTH, Eyes, Moment, as_jpeg, moment_of

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match
    from wildscav_server.hosting.hosted_match import HostedMatch

LABEL_ABOVE = HEAD + 0.4  # m above the soles, where a name is shown
RATE = 20.0  # pictures a second of a view at most: those who play need the processor, too
View = int | None  # a seat whose eyes are seen through; None for the overview


class PendingFrame(NamedTuple):
    """A picture that is to be made."""

    shown: dict[str, Any]  # beside it
    make: Callable[[], bytes]  # returns it, as JPEG; may be called in another thread


class Photographer(Protocol):
    """Takes pictures of one match from one view."""

    def take(self) -> PendingFrame:
        """Return a picture of the present."""


class SeatView:
    """Pictures as the person or agent in a seat sees them, with what a person's page shows beside them.

    Args:
        hosted: The match.
        seat: The seat.
    """

    def __init__(self, hosted: "HostedMatch", seat: int) -> None:
        self._match, self._seat, self._eyes = hosted.match, seat, Eyes(seat)
        self._info = match_info(hosted.match, seat, hosted.clock)
        self._observations = SeatObservations(hosted.match, [seat])
        self._counted = self._count()

    def take(self) -> PendingFrame:
        """Return a picture of the present."""
        self._observations.encode([0.0])
        message = Observation.FromString(self._observations.of(self._seat))
        observation = decode_observation(message, FRAMES_PER_SECOND)
        shown = {"seat": self._seat, **display_of(observation, self._info), **self._events()}
        moment = moment_of(self._match)
        return PendingFrame(shown, lambda: self._eyes.picture(moment))

    def _count(self) -> dict[str, int]:
        agents, seat = self._match.state.agents, self._seat
        counted = {
            "fired": agents.shots,
            "hits": agents.hits,
            "gained": agents.picked_up,
            "hurt": agents.health,
        }
        return {name: int(array[0, seat]) for name, array in counted.items()}

    def _events(self) -> dict[str, Any]:
        """Return what happened since the last picture, which may be many steps ago."""
        before, now = self._counted, self._count()
        self._counted = now
        more = {name: max(0, now[name] - before[name]) for name in ("hits", "gained")}
        return {"fired": now["fired"] > before["fired"], "hurt": int(now["hurt"] < before["hurt"]), **more}


class Overview:
    """Pictures from above, with the places of names.

    Args:
        match: The match.
    """

    def __init__(self, match: "Match") -> None:
        self._match, self._above = match, LiveAbove(match.game_map.world, WIDTH / HEIGHT)
        options = {"width": WIDTH, "height": HEIGHT, "field_of_view": ANGLE, "far": ABOVE_FAR}
        self._camera: Any = parse_sensors({"camera": options})["camera"]

    def take(self) -> PendingFrame:
        """Return a picture of the present."""
        match, agents = self._match, self._match.state.agents
        alive = agents.present[0] & (agents.health[0] > 0)
        time = match.frame / FRAMES_PER_SECOND
        camera = self._above.at(agents.position[0][alive], time)
        heads = agents.position[0] + [0.0, LABEL_ABOVE, 0.0]
        places = camera.onto(heads, WIDTH, HEIGHT)
        labels = [
            {"seat": seat, "x": places[seat, 0] / WIDTH, "y": places[seat, 1] / HEIGHT}
            for seat in np.flatnonzero(alive).tolist()
            if places[seat, 2] > 0.0
        ]
        shown = {"seat": None, "time": time, "left": max(0.0, match.spec.time_limit - time), "labels": labels}
        moment = moment_of(match)
        return PendingFrame(shown, lambda: self._picture(moment, camera))

    def _picture(self, moment: Moment, camera: Camera) -> bytes:
        pixels = self._camera.render(
            moment.game_map,
            camera.eye[None],
            np.array([camera.yaw]),
            np.array([camera.pitch]),
            moving=dynamic_objects_of(moment),
        )[0]
        return as_jpeg(pixels)


class Frame(NamedTuple):
    """The latest picture of a view."""

    number: int  # among all pictures
    frame: int  # of the match
    shown: dict[str, Any]
    picture: bytes  # JPEG


class Gallery:
    """Takes the pictures that somebody watches."""

    def __init__(self) -> None:
        self._watched: dict[object, View] = {}  # what each spectator watches
        self._latest: dict[View, Frame] = {}
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

    async def next(self, spectator: object, after: int) -> Frame:
        """Wait for a picture of what a spectator watches that is newer than a number."""
        while True:
            latest = self._latest.get(self._watched[spectator])
            if latest is not None and latest.number > after:
                return latest
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
                        if view not in photographers:
                            photographers[view] = (
                                Overview(hosted.match) if view is None else SeatView(hosted, view)
                            )
                        await self._take(hosted, view, photographers[view], painter)
                await asyncio.sleep(max(0.0, began + 1.0 / RATE - loop.time()))

    async def _take(
        self, hosted: "HostedMatch", view: View, photographer: Photographer, painter: Executor
    ) -> None:
        """Take a picture of a view, unless there is one of this frame."""
        latest, frame = self._latest.get(view), hosted.match.frame
        if latest is not None and latest.frame == frame:
            return
        pending = photographer.take()
        picture = await asyncio.get_running_loop().run_in_executor(painter, pending.make)
        self._number += 1
        self._latest[view] = Frame(self._number, frame, pending.shown, picture)
        self._tell()

    def _tell(self) -> None:
        self._changed.set()
        self._changed = asyncio.Event()
