"""A recorded match as pictures: from an agent's eyes, from behind, from above, or all seats at once."""

from collections.abc import Callable, Sequence
from functools import partial
from math import ceil, sqrt
from typing import Any, Literal, NamedTuple, get_args

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.record import Record, resimulate
from wildscav_engine.sensors import ColorCamera
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.match_spec import SUBMISSION
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.agent_notes import Note
from wildscav_engine.view.recording.history import History, collect_history
from wildscav_engine.view.video.cameras import ANGLE, Above, Camera, Follower, at_the_eyes
from wildscav_engine.view.video.moments import InterpolatedState, moment_at, objects_at
from wildscav_engine.view.video.overlay.drawing import put
from wildscav_engine.view.video.overlay.hud import Hud
from wildscav_engine.view.video.props import with_props

Report = Callable[[int], None]  # told the number of each step
View = Literal["eyes", "follow", "overview", "grid"]
VIEWS: tuple[View, ...] = get_args(View)
MAX_TILES = 16
DETAIL = 0.5  # share of a picture's width and height that is rendered, and then enlarged
GROUND = (18, 22, 28)  # behind the pictures of the seats
# How much a viewer wants to see of each kind of event.
SHOT, HIT, DEATH, PICK_UP = 1.0, 3.0, 8.0, 1.5
WALKING = 0.05  # a second
BEFORE, AFTER = 3.0, 1.0  # s, for which an event is worth to be seen before and after it
SHORTEST = 5.0  # s between two cuts
BETTER = 1.6  # times as much must be going on elsewhere before there is a cut
NEAR, SEEN, ACTS = 35.0, 4.0, 6.0  # m; how much a poster gains by each agent in sight, and by acting at most
TRIED = 100  # steps, that might make a good poster
DEAD_FOR = 1.5  # s, after which there is one from an agent that is dead


class VideoError(Exception):
    """A video cannot be made; the message is one line that says why."""


class Look(NamedTuple):
    """What pictures of a match show, and how large they are."""

    view: View = "eyes"
    seat: int | None = None  # None: the first submission; with "follow", whoever has most to do
    width: int = 1280  # pixels
    height: int = 720  # pixels
    detail: float = DETAIL  # 0.2-1, share of the width and height that is rendered


class Film:
    """The pictures of one match."""

    def __init__(
        self, record: Record, look: Look, played: Report | None = None, notes: Sequence[Note] = ()
    ) -> None:
        """Play a record again, and prepare the cameras.

        Args:
            played: Called after each step that was played again, with its number.
            notes: What agents said, in the order of their steps; it is written below the pictures.

        Raises:
            VideoError: There is no such seat, or the size or the detail is outside its range.
            RecordError: The record cannot be played by this engine.
        """
        _check(look, len(record.names))
        self.look, self._record = look, record
        match, self.history = collect_history(_told(resimulate(record), played), record.steps, None)
        self._map: GameMap = match.game_map
        self.hud = Hud(record, self._map, self.history, look.height, notes)
        self._followed = self._seats_to_follow()
        self._followers: dict[int, Follower] = {}
        self._prepare()

    def _prepare(self) -> None:
        """Do what pictures share, before threads take them at the same time."""
        if self.look.view == "overview":
            self._above = Above(self._map.world, self.history, self.look.width / self.look.height)
        if self.look.view == "follow":
            for seat in np.unique(self._followed).tolist():
                self._followers[seat] = Follower(self._map.world, self.history, seat)
        ColorCamera(16, 16).prepare(self._map)

    def _seats_to_follow(self) -> NDArray[np.int64]:
        """Return (T + 1,) the seat that the pictures are about."""
        look, seats = self.look, self._record.spec.seats
        if look.seat is None and look.view != "eyes":
            return whom_to_follow(self.history)
        first = seats.index(SUBMISSION) if SUBMISSION in seats else 0
        return np.full(len(self.history.frame), first if look.seat is None else look.seat, np.int64)

    @property
    def seconds(self) -> float:
        """How long the match took."""
        return float(self.history.frame[-1]) / FRAMES_PER_SECOND

    @property
    def best_time(self) -> float:
        """The time in s of the picture that shows most of the match."""
        row = best_row(self._map.world, self.history, self._followed)
        return float(self.history.frame[row]) / FRAMES_PER_SECOND

    def picture(self, seconds: float) -> Image.Image:
        """Return the picture at a time of the match."""
        moment = moment_at(self.history, seconds * FRAMES_PER_SECOND)
        if self.look.view == "grid":
            return self._grid(moment)
        seat = int(self._followed[moment.row])
        followed = None if self.look.view == "overview" else seat
        camera = self._camera(moment, seat)
        picture = self._render(camera, moment, self.look.width, self.look.height)
        if self.look.view == "eyes":
            self.hud.draw_aim(picture, moment, seat)
        self.hud.draw(picture, camera, moment, followed)
        return picture

    def _camera(self, moment: InterpolatedState, seat: int) -> Camera:
        if self.look.view == "overview":
            return self._above.at(moment)
        if self.look.view == "follow":
            return self._followers[seat].at(moment)
        return at_the_eyes(moment, seat)

    def _render(self, camera: Camera, moment: InterpolatedState, width: int, height: int) -> Image.Image:
        """Return what a camera sees, without the overlay."""
        detail = self.look.detail
        wide, high = max(16, round(width * detail)), max(16, round(height * detail))
        lens = ColorCamera(wide, high, far=camera.far, field_of_view=ANGLE)
        pixel = 2.0 * lens.lens[0] / lens.width
        objects = with_props(
            objects_at(self.history, moment), self._map.world, self.history, moment, camera.eye, pixel
        )
        pixels = lens.render(
            self._map,
            camera.eye[None],
            np.array([camera.yaw]),
            np.array([camera.pitch]),
            moving=objects,
            viewers=None if camera.hidden is None else [camera.hidden],
        )[0]
        picture = Image.fromarray(pixels)
        return picture if detail == 1.0 else picture.resize((width, height), Image.Resampling.BILINEAR)

    def _grid(self, moment: InterpolatedState) -> Image.Image:
        """Return what all seats see, side by side, with map and standings where there is room."""
        picture = Image.new("RGB", (self.look.width, self.look.height), GROUND)
        seats = list(range(min(MAX_TILES, len(self._record.names))))
        tiles: list[Callable[[int, int], Image.Image]] = [partial(self._tile, moment, seat) for seat in seats]
        columns = ceil(sqrt(len(tiles)))
        rows = ceil(len(tiles) / columns)
        wide, high = self.look.width // columns, self.look.height // rows
        for index, tile in enumerate(tiles):
            picture.paste(tile(wide - 2, high - 2), (index % columns * wide + 1, index // columns * high + 1))
        places = range(len(tiles), rows * columns)
        free = [((index % columns + 0.5) * wide, index // columns * high) for index in places]
        self._fill(picture, moment, free, wide, high)
        self.hud.draw_end(picture, moment)
        return picture

    def _fill(
        self,
        picture: Image.Image,
        moment: InterpolatedState,
        free: list[tuple[float, int]],
        wide: int,
        high: int,
    ) -> None:
        """Draw clock and map into the last place without a seat, and the standings into the one before."""
        clock, gap = self.hud.clock(moment), 4
        if not free:
            put(picture, clock, picture.width / 2, picture.height - gap, anchor="mb")
            return
        middle, top = free[-1]
        put(picture, clock, middle, top + gap, anchor="mt")
        room = high - clock.height - 3 * gap
        inset = _fitting(self.hud.inset.draw(moment, None), wide - 2 * gap, room)
        put(picture, inset, middle, top + high - gap, anchor="mb")
        if len(free) > 1:
            middle, top = free[-2]
            table = _fitting(self.hud.standings.draw(moment.row, None), wide - 2 * gap, high - 2 * gap)
            put(picture, table, middle, top + high / 2, anchor="mm")

    def _tile(self, moment: InterpolatedState, seat: int, width: int, height: int) -> Image.Image:
        picture = self._render(at_the_eyes(moment, seat), moment, width, height)
        self.hud.draw_label(picture, moment, seat)
        return picture


def _told(matches: Any, played: Report | None) -> Any:
    """Yield the steps of a re-simulation, and tell their numbers."""
    for step, match in enumerate(matches):
        yield match
        if played is not None:
            played(step)


def _check(look: Look, seats: int) -> None:
    if look.seat is not None and not 0 <= look.seat < seats:
        raise VideoError(f"there is no seat {look.seat}: the record has seats 0 to {seats - 1}")
    if not (160 <= look.width <= 1920 and 90 <= look.height <= 1080):
        raise VideoError(f"the size is {look.width}x{look.height}, must be from 160x90 to 1920x1080 pixels")
    if not 0.2 <= look.detail <= 1.0:
        raise VideoError(f"the detail is {look.detail:g}, must be 0.2 to 1")


def _fitting(patch: Image.Image, width: int, height: int) -> Image.Image:
    """Return a patch that is no larger than some pixels."""
    share = min(1.0, width / patch.width, height / patch.height)
    if share == 1.0:
        return patch
    size = (max(1, round(patch.width * share)), max(1, round(patch.height * share)))
    return patch.resize(size, Image.Resampling.BOX)


def interest(history: History) -> NDArray[np.float64]:
    """Return (T + 1, A) how much each seat does in each step."""
    agents = history.agents
    worth = SHOT * agents.fired + PICK_UP * (agents.gained > 0)
    worth = worth + DEATH * np.diff(agents.deaths, axis=0, prepend=agents.deaths[:1])
    for row, seat, victim in history.hits():
        worth[row, seat] += HIT
        worth[row, victim] += HIT / 2
    for death in history.deaths():
        if death.by != NOBODY:
            worth[death.row, death.by] += DEATH
    walked = np.diff(agents.walked, axis=0, prepend=agents.walked[:1])
    return np.asarray(worth + WALKING * (walked > 0.0), np.float64)


def whom_to_follow(history: History) -> NDArray[np.int64]:
    """Return (T + 1,) the seat to follow in each step, with few cuts."""
    per_second = max(
        1, round(FRAMES_PER_SECOND * (len(history.frame) - 1) / max(1.0, float(history.frame[-1])))
    )
    before, after = round(BEFORE * per_second), round(AFTER * per_second)
    padded = np.pad(interest(history), ((after, before), (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, before + after + 1, axis=0)
    worth = windows.sum(axis=-1)
    alive = history.agents.health > 0
    worth = np.where(alive, worth, 0.0)
    followed = np.empty(len(worth), np.int64)
    seat, since, dead = int(np.argmax(worth[0])), 0, 0
    for row, now in enumerate(worth):
        best = int(np.argmax(now))
        dead = 0 if alive[row, seat] else dead + 1
        is_time = row - since >= SHORTEST * per_second and now[best] > BETTER * now[seat]
        if is_time or (dead > DEAD_FOR * per_second and alive[row].any()):
            seat, since, dead = best, row, 0
        followed[row] = seat
    return followed


def best_row(world: World, history: History, followed: NDArray[np.int64]) -> int:
    """Return the step that shows most: the followed agent acts, and sees others before it."""
    rows = np.arange(len(followed))
    acts = np.minimum(interest(history)[rows, followed], ACTS)
    near = _are_near(history, followed)
    score = acts + SEEN * near.sum(axis=1)
    best: list[int] = np.argsort(-score, kind="stable")[:TRIED].tolist()
    seen = {row: _seen(world, history, row, int(followed[row]), near[row]) for row in best}
    return max(seen, key=lambda row: acts[row] + SEEN * seen[row])


def _are_near(history: History, followed: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (T + 1, A) who is near the followed agent and before it, while both are alive."""
    agents, rows = history.agents, np.arange(len(followed))
    ways = agents.position - agents.position[rows, followed][:, None]
    far, yaw = np.linalg.norm(ways, axis=-1), np.radians(agents.yaw[rows, followed])[:, None]
    ahead = ways[..., 0] * np.sin(yaw) + ways[..., 2] * np.cos(yaw)
    alive = agents.health > 0
    return np.asarray(
        (far > 1.0) & (far < NEAR) & (ahead > 0.8 * far) & alive & alive[rows, followed][:, None]
    )


def _seen(world: World, history: History, row: int, seat: int, near: NDArray[np.bool_]) -> int:
    """Return how many of those near a seat it sees."""
    eyes = history.agents.position[row] + np.array([0.0, EYE_HEIGHT, 0.0])
    return sum(
        bool(sight_is_clear(world, *eyes[seat].tolist(), *eyes[other].tolist()))
        for other in np.nonzero(near)[0].tolist()
    )
