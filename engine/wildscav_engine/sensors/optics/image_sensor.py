"""The base class of sensors that make images from the eyes of agents or from any other place."""

from abc import abstractmethod
from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.parallel.threads import share
from wildscav_engine.parallel.turns import ALONE, Turns, items_of
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.rendering.shading.appearance import Appearance, Appearances
from wildscav_engine.rendering.trace import Scene, Scenes
from wildscav_engine.rendering.tracing.solids import Solids, gather_solids
from wildscav_engine.rendering.tracing.workspace import LARGEST_CACHED
from wildscav_engine.sensors.base import Sensor, rows_of
from wildscav_engine.sensors.optics.dynamic_objects import as_dynamic_objects, dynamic_objects_of
from wildscav_engine.specs.body import EYE_HEIGHT

if TYPE_CHECKING:
    from gymnasium.spaces import Box

    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView
    from wildscav_engine.simulation.state import State
    from wildscav_engine.simulation.systems.visibility import Seen

MIN_THREAD_TIME = 250_000  # ns of work for a thread; less takes no longer than waking the thread
IMAGE_TIME = 2_500  # ns that an image takes in addition to its rays
ARRAY = np.ndarray
FLOAT = np.dtype(np.float64)
MAX_SEAT = 2**31 - 1
POSES = "positions", "yaws", "pitches"
NO_VIEWER = -2  # a camera that sees all bodies
NO_DYNAMIC_OBJECTS = as_dynamic_objects(gather_solids([]))
FROM_SOLES = np.array([[-0.0, EYE_HEIGHT, -0.0]])  # (1, 3) m, to the eyes; adding -0.0 changes no bit


class ShownMaps:
    """The maps that N images show, possibly with repetitions, or one map that all of them show.

    What kernels need of them is collected once, for many readings. Nobody changes it while they are used.

    Attributes:
        maps: The maps, which have been prepared for the sensors that are read.
    """

    def __init__(self, maps: "Sequence[GameMap]") -> None:
        """Collect maps."""
        self.maps = maps

    def __reduce__(self) -> tuple[type["ShownMaps"], tuple[Any]]:
        """Copy and pickle only the maps: what kernels need is addresses."""
        return ShownMaps, (self.maps,)

    def map_of(self, image: int) -> "GameMap":
        """Return the map that an image shows."""
        return self.maps[image if len(self.maps) > 1 else 0]

    @cached_property
    def scenes(self) -> Scene | Scenes:
        """What rays are traced in."""
        return self.maps[0].scene if len(self.maps) == 1 else Scenes([one.scene for one in self.maps])

    @cached_property
    def appearances(self) -> Appearance | Appearances:
        """What pictures show."""
        if len(self.maps) == 1:
            return self.maps[0].appearance
        return Appearances([one.appearance for one in self.maps])


class ImageSensor(Sensor):
    """A sensor that casts rays from any position, or from the eyes of agents, whose own bodies it omits.

    It makes images by ``write_images``, which makes those of all matches of a vector environment in one call,
    or by ``render_into``, those of one map. Each does what the other one does; a kind of sensor replaces at
    least one of them.
    """

    dtype: ClassVar[type[np.generic]]
    ray_time: ClassVar[int] = 10  # approximate ns per ray, which decides how threads share images
    has_display: ClassVar[bool] = False  # whether ``draw_over`` draws anything

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The shape of one image."""

    @property
    @abstractmethod
    def lens(self) -> tuple[float, float]:
        """The half width and the range, as ``Cameras`` has them."""

    @property
    def bounds(self) -> tuple[float, float]:
        """The least and the greatest number of an image; by default 0 and the range."""
        return 0.0, self.lens[1]

    @property
    def space(self) -> "Box":
        """The images, between their bounds."""
        from gymnasium.spaces import Box

        dtype: Any = self.dtype
        low, high = self.bounds
        return Box(dtype(low), dtype(high), self.shape, dtype)

    def prepare(self, game_map: "GameMap") -> None:
        """Compute in advance what images of a map are made from; it takes longer than one image."""
        _ = game_map.scene

    @property
    def rays(self) -> int:
        """The number of rays that one reading casts."""
        return self.shape[0] * self.shape[1]

    @property
    def min_images_per_thread(self) -> int:
        """The least number of images that are worth waking a thread for."""
        return -(-MIN_THREAD_TIME // (IMAGE_TIME + self.rays * self.ray_time))

    @property
    def sees_objects(self) -> bool:
        """Whether agents and supply boxes are visible; by default, as the option ``moving`` says, if any."""
        return bool(getattr(self, "moving", False))

    def moving_in(self, match: "MatchView") -> Solids:
        """Return the dynamic objects that the sensor sees in a match."""
        return dynamic_objects_of(match) if self.sees_objects else NO_DYNAMIC_OBJECTS

    def write_images(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[Any],
        turns: Turns,
    ) -> bool:
        """Render the images of cameras in different matches.

        Args:
            shown: The map of each camera, or one for all.
            objects: The dynamic objects of some matches.
            matches: (N,) the index in ``objects`` of the match that each camera is in.
            cameras: N cameras.
            images: (N, *shape), written.
            turns: In which order to render them, with other threads.

        Returns:
            Whether all numbers of the cameras are finite; if not, nothing is written.
        """
        kind = type(self)
        if (kind.write_images, kind.render_into) == (ImageSensor.write_images, ImageSensor.render_into):
            raise NotImplementedError(f"{kind.__name__} has neither write_images nor render_into")
        parts = (slice(row, row + 1) for row in items_of(turns, len(images)))
        return all(
            self.render_into(
                shown.map_of(part.start),
                objects.solids_of(matches[part.start]),
                select_cameras(cameras, part),
                images[part],
            )
            for part in parts
        )

    def render_into(
        self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[Any]
    ) -> bool:
        """Render the images of some cameras on one map, whose scene has been prepared.

        Args:
            game_map: The map.
            moving: The dynamic objects.
            cameras: N cameras.
            images: (N, *shape), written.

        Returns:
            Whether all numbers of the cameras are finite; if not, nothing is written.
        """
        objects = as_dynamic_objects(moving).sets
        return self.write_images(
            ShownMaps((game_map,)), objects, in_one_match(len(images)), cameras, images, ALONE
        )

    def render_matches_into(
        self,
        shown: ShownMaps,
        objects: ObjectSets,
        matches: NDArray[np.int64],
        cameras: Cameras,
        images: NDArray[Any],
        turns: Turns = ALONE,
    ) -> bool:
        """Do the same as ``write_images``, with large images one after another."""
        if self.rays <= LARGEST_CACHED:
            return self.write_images(shown, objects, matches, cameras, images, turns)
        # What one of them is traced in is large, so only one is used at a time.
        parts = (slice(row, row + 1) for row in items_of(turns, len(images)))
        return all(
            self.write_images(
                ShownMaps((shown.map_of(part.start),)),
                objects,
                matches[part],
                select_cameras(cameras, part),
                images[part],
                ALONE,
            )
            for part in parts
        )

    def draw_over(
        self, state: "State", seen: "Seen", track: str, seats: NDArray[np.int64], images: NDArray[Any]
    ) -> None:
        """Draw what the world does not show over the images of some seats.

        Args:
            state: The state of B matches.
            seen: What these seats see now.
            track: The track of the matches.
            seats: (S,) the numbers of the seats, which all matches have.
            images: (B, S, *shape), drawn over.
        """

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[Any]:
        """Return the images of some agents, (len(seats), *shape).

        Raises:
            ValueError: The match has no such seat.
        """
        cameras = self.cameras_of(match, seats)
        images = np.empty((len(seats), *self.shape), self.dtype)
        if not self.render_into(match.game_map, self.moving_in(match), cameras, images):
            _raise_not_finite(*cameras[:3])
        if self.has_display:
            rows = rows_of(match, seats)
            self.draw_over(match.state, match.seen, match.spec.track, rows, images[np.newaxis])
        return images

    def cameras_of(self, match: "MatchView", seats: Sequence[int]) -> Cameras:
        """Return the cameras of some agents.

        Raises:
            ValueError: The match has no such seat.
        """
        rows: slice | NDArray[np.int64]
        if len(seats) == 1 and 0 <= seats[0] < match.seats:
            rows, viewers = _only(seats[0])
        else:
            rows = rows_of(match, seats)
            viewers = rows.astype(np.int32)
        agents = match.state.agents
        eyes = agents.position[0, rows] + FROM_SOLES
        return Cameras(eyes, agents.yaw[0, rows], agents.pitch[0, rows], viewers, *self.lens)

    def render(
        self,
        game_map: "GameMap",
        positions: ArrayLike,
        yaws: ArrayLike,
        pitches: ArrayLike,
        *,
        moving: Solids | None = None,
        viewers: ArrayLike | None = None,
        threads: int = 1,
    ) -> NDArray[Any]:
        """Return the images from N positions.

        Args:
            game_map: The map.
            positions: (N, 3) m, of the eyes.
            yaws: (N,) degrees, clockwise from +z.
            pitches: (N,) degrees, positive looks down.
            moving: The dynamic objects; None for none.
            viewers: (N,) seats whose own bodies are invisible; None to see all bodies.
            threads: The maximum number of threads. It does not change any bit of the images.

        Returns:
            (N, *shape) of the sensor's dtype.

        Raises:
            ValueError: An array has the wrong shape or holds a number that is not finite, or ``threads`` is
                less than 1.
        """
        if threads < 1:
            raise ValueError(f"threads is {threads}, must be at least 1")
        cameras, objects = self._cameras(positions, yaws, pitches, viewers), moving or NO_DYNAMIC_OBJECTS
        images = np.empty((len(cameras.yaws), *self.shape), self.dtype)
        self.prepare(game_map)  # before the threads, which would all do it

        def render_part(part: slice) -> bool:
            return self.render_into(game_map, objects, select_cameras(cameras, part), images[part])

        if threads == 1:
            is_finite = self.render_into(game_map, objects, cameras, images)
        else:
            is_finite = share(render_part, len(images), threads, self.min_images_per_thread)
        if not is_finite:
            _raise_not_finite(*cameras[:3])
        return images

    def _cameras(
        self, positions: ArrayLike, yaws: ArrayLike, pitches: ArrayLike, viewers: ArrayLike | None
    ) -> Cameras:
        poses: Any = positions, yaws, pitches
        eyes, turns, tilts = poses if are_ready(*poses) else _checked(*poses)
        count = len(turns)
        seats = _no_viewers(count) if viewers is None else _seats_of(viewers, count)
        return Cameras(eyes, turns, tilts, seats, *self.lens)


@lru_cache(maxsize=1024)
def _only(seat: int) -> tuple[slice, NDArray[np.int32]]:
    """Return what selects the row of a single seat, faster than an index array, and the seat as a viewer."""
    return slice(seat, seat + 1), np.array([seat], np.int32)


@lru_cache(maxsize=8)
def _no_viewers(count: int) -> NDArray[np.int32]:
    """Return the viewers of ``count`` cameras that belong to no seat."""
    return np.full(count, NO_VIEWER, np.int32)


@lru_cache(maxsize=64)
def in_one_match(count: int) -> NDArray[np.int64]:
    """Return the indices of the matches of ``count`` cameras that are all in the first one."""
    return np.zeros(count, np.int64)


def _seats_of(viewers: ArrayLike, count: int) -> NDArray[np.int32]:
    """Return (count,) the seats of the viewers.

    Raises:
        ValueError: Their number differs, or they are not whole numbers.
    """
    seats = np.asarray(viewers)
    if seats.shape != (count,) or seats.dtype.kind not in "iu":
        raise ValueError(
            f"viewers are {seats.dtype} of shape {seats.shape}, must be whole numbers of shape ({count},)"
        )
    if (seats < 0).any() or (seats > MAX_SEAT).any():
        raise ValueError(
            f"viewers hold {seats[(seats < 0) | (seats > MAX_SEAT)][0]}, must be seats, 0 or more"
        )
    return seats.astype(np.int32)


def select_cameras(cameras: Cameras, part: slice) -> Cameras:
    """Return some successive cameras."""
    return cameras._replace(
        eyes=cameras.eyes[part],
        yaws=cameras.yaws[part],
        pitches=cameras.pitches[part],
        viewers=cameras.viewers[part],
    )


def are_ready(eyes: Any, yaws: Any, pitches: Any) -> bool:
    """Return whether kernels accept three arrays as they are, without another compilation."""
    return (
        type(eyes) is type(yaws) is type(pitches) is ARRAY
        and eyes.dtype is yaws.dtype is pitches.dtype is FLOAT
        and yaws.shape == pitches.shape
        and eyes.ndim == 2
        and eyes.shape == (*yaws.shape, 3)
        # C-contiguous, aligned and writable.
        and eyes.flags.carray
        and yaws.flags.carray
        and pitches.flags.carray
    )


def _checked(*poses: ArrayLike) -> tuple[NDArray[np.float64], ...]:
    """Return positions, yaws and pitches as arrays that kernels accept: (N, 3), (N,) and (N,).

    Raises:
        ValueError: They have other shapes or are not real numbers.
    """
    arrays = [np.asarray(values) for values in poses]
    for name, array in zip(POSES, arrays, strict=True):
        if array.dtype.kind not in "biuf":
            raise ValueError(f"{name} are {array.dtype} of shape {array.shape}, must be real numbers")
    eyes, yaws, pitches = (np.array(array, np.float64, order="C") for array in arrays)
    if eyes.ndim != 2 or eyes.shape[1] != 3:
        raise ValueError(f"positions are float64 of shape {eyes.shape}, must be of shape (N, 3)")
    for name, angles in (("yaws", yaws), ("pitches", pitches)):
        if angles.shape != (len(eyes),):
            raise ValueError(f"{name} are float64 of shape {angles.shape}, must be of shape ({len(eyes)},)")
    return eyes, yaws, pitches


def _raise_not_finite(*arrays: NDArray[np.float64]) -> NoReturn:
    """Raise a ValueError that names the array with a number that is not finite."""
    for name, values in zip(POSES, arrays, strict=True):
        if not np.isfinite(values).all():
            raise ValueError(f"{name} hold {values[~np.isfinite(values)][0]}, must be finite")
    raise ValueError("positions, yaws and pitches are too large: sums of them are not finite")
