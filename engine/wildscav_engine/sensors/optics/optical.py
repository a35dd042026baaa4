"""What all sensors share that look out of the eyes of agents, or from any other place."""

from abc import abstractmethod
from collections.abc import Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from wildscav_engine.parallel.threads import share
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.tracing.solids import Solids, gather_solids
from wildscav_engine.sensors.base import Sensor, rows_of
from wildscav_engine.sensors.optics.dynamic_objects import dynamic_objects_of
from wildscav_engine.specs.body import EYE_HEIGHT

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.match_view import MatchView

LEAST_TIME = 250_000  # ns of work that a thread is given: less takes no longer than waking the thread
IMAGE_TIME = 2_500  # ns that an image takes besides its rays
ARRAY = np.ndarray
FLOAT = np.dtype(np.float64)
MOST_SEAT = 2**31 - 1
NO_VIEWER = -2  # sees every body
NOTHING_MOVES = gather_solids([])


class OpticalSensor(Sensor):
    """A sensor that looks: out of agents' eyes, who never see their own bodies, or from any other place."""

    dtype: ClassVar[type[np.generic]]
    ray_time: ClassVar[int] = 10  # ns that a ray takes, about; it decides which images threads share

    @property
    @abstractmethod
    def shape(self) -> tuple[int, ...]:
        """The shape of one image."""

    @property
    @abstractmethod
    def lens(self) -> tuple[float, float]:
        """The half width and the reach of ``Cameras``."""

    @abstractmethod
    def look(self, game_map: "GameMap", moving: Solids, cameras: Cameras, images: NDArray[Any]) -> bool:
        """Make the images of some cameras.

        Args:
            game_map: The map to look at; its scene is made already.
            moving: What is in it besides.
            cameras: N of them.
            images: (N, *shape), written.

        Returns:
            Whether all cameras are finite numbers; else nothing is written.
        """

    def look_at_maps(self, maps: "Sequence[GameMap]", cameras: Cameras, images: NDArray[Any]) -> bool:
        """Make the images of some cameras on maps in which nothing moves.

        Args:
            maps: N of them, which may be the same; their scenes are made already.
            cameras: N of them.
            images: (N, *shape), written.

        Returns:
            Whether all cameras are finite numbers.
        """
        rows_of: dict[int, list[int]] = {}
        for row, game_map in enumerate(maps):
            rows_of.setdefault(id(game_map), []).append(row)
        for rows in rows_of.values():
            found = np.empty((len(rows), *self.shape), self.dtype)
            if not self.look(maps[rows[0]], NOTHING_MOVES, some_of(cameras, rows), found):
                return False
            images[rows] = found
        return True

    def prepare(self, game_map: "GameMap") -> None:
        """Make what images of a map are made from, which takes longer than an image."""
        _ = game_map.scene

    @property
    def rays(self) -> int:
        """How many rays one reading takes."""
        return self.shape[0] * self.shape[1]

    @property
    def least_images(self) -> int:
        """How many images take so long that a thread is worth waking for them."""
        return -(-LEAST_TIME // (IMAGE_TIME + self.rays * self.ray_time))

    def moving_in(self, match: "MatchView") -> Solids:  # noqa: ARG002
        """Return what is seen in a match besides the static world: nothing, unless a sensor says else."""
        return NOTHING_MOVES

    def read(self, match: "MatchView", seats: Sequence[int]) -> NDArray[Any]:
        """Return what some agents see, (len(seats), *shape).

        Raises:
            ValueError: The match has no such seat.
        """
        rows = rows_of(match, seats)
        agents, moving = match.state.agents, self.moving_in(match)
        bodies: dict[str, Any] = {"moving": moving, "viewers": rows} if len(moving.kind) else {}
        return self.render(
            match.game_map,
            agents.position[0, rows] + np.array([0.0, EYE_HEIGHT, 0.0]),
            agents.yaw[0, rows],
            agents.pitch[0, rows],
            **bodies,
        )

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
        """Return what is seen from N places.

        Args:
            game_map: The map to look at.
            positions: (N, 3) m, of the eyes themselves.
            yaws: (N,) degrees, clockwise from +z.
            pitches: (N,) degrees, positive looks down.
            moving: What is in the map besides; nothing if None.
            viewers: (N,) seats, whose own bodies are not seen; everything is seen if None.
            threads: How many threads share the places at most. The images are the same, bit for bit.

        Returns:
            (N, *shape) of the sensor's dtype.

        Raises:
            ValueError: An array is not of its shape or holds what is no finite number, or there is no
                thread.
        """
        if threads < 1:
            raise ValueError(f"threads is {threads}, must be at least 1")
        cameras = self._cameras(positions, yaws, pitches, viewers)
        images = np.empty((len(cameras.yaws), *self.shape), self.dtype)
        solids = NOTHING_MOVES if moving is None else moving
        self.prepare(game_map)  # here, not in several threads at once

        def look_at(part: slice) -> bool:
            return self.look(game_map, solids, some_of(cameras, part), images[part])

        if not share(look_at, len(images), threads, self.least_images):
            _refuse_numbers(cameras.eyes, cameras.yaws, cameras.pitches)
        return images

    def _cameras(
        self, positions: ArrayLike, yaws: ArrayLike, pitches: ArrayLike, viewers: ArrayLike | None
    ) -> Cameras:
        eyes: Any = positions
        turns: Any = yaws
        tilts: Any = pitches
        if not are_ready(eyes, turns, tilts):
            eyes, turns, tilts = _real("positions", positions), _real("yaws", yaws), _real("pitches", pitches)
            _check_shapes(eyes, turns, tilts)
        count = len(turns)
        seats = _nobody(count) if viewers is None else _seats_of(viewers, count)
        return Cameras(eyes, turns, tilts, seats, *self.lens)


@lru_cache(maxsize=8)
def _nobody(count: int) -> NDArray[np.int32]:
    """Return the viewers of so many places where nobody is."""
    return np.full(count, NO_VIEWER, np.int32)


def _seats_of(viewers: ArrayLike, count: int) -> NDArray[np.int32]:
    """Return (count,) seats whose eyes look.

    Raises:
        ValueError: They are not as many, or no whole numbers.
    """
    seats = np.asarray(viewers)
    if seats.shape != (count,) or seats.dtype.kind not in "iu":
        raise ValueError(
            f"viewers are {seats.dtype} of shape {seats.shape}, must be whole numbers of shape ({count},)"
        )
    if (seats < 0).any() or (seats > MOST_SEAT).any():
        raise ValueError(
            f"viewers hold {seats[(seats < 0) | (seats > MOST_SEAT)][0]}, must be seats, 0 or more"
        )
    return seats.astype(np.int32)


class MovingOption(OpticalSensor):
    """A sensor with the option ``moving``: whether agents and supply boxes are seen, too."""

    moving: bool

    def moving_in(self, match: "MatchView") -> Solids:
        """Return the agents and supply boxes if they are asked for."""
        return dynamic_objects_of(match) if self.moving else NOTHING_MOVES


def some_of(cameras: Cameras, part: "slice | list[int]") -> Cameras:
    """Return some of the cameras."""
    return cameras._replace(
        eyes=cameras.eyes[part],
        yaws=cameras.yaws[part],
        pitches=cameras.pitches[part],
        viewers=cameras.viewers[part],
    )


def are_ready(eyes: Any, yaws: Any, pitches: Any) -> bool:
    """Return whether kernels take three arrays as they are, without being compiled once more."""
    return (
        type(eyes) is type(yaws) is type(pitches) is ARRAY
        and eyes.dtype is yaws.dtype is pitches.dtype is FLOAT
        and yaws.shape == pitches.shape
        and eyes.ndim == 2
        and eyes.shape == (*yaws.shape, 3)
        # In order, aligned and writable.
        and eyes.flags.carray
        and yaws.flags.carray
        and pitches.flags.carray
    )


def _real(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """Return values as an array of the sort that kernels take.

    Raises:
        ValueError: They are no real numbers.
    """
    array = np.asarray(values)
    if array.dtype.kind not in "biuf":
        raise ValueError(f"{name} are {array.dtype} of shape {array.shape}, must be real numbers")
    return np.array(array, np.float64, order="C")


def _check_shapes(eyes: NDArray[np.float64], yaws: NDArray[np.float64], pitches: NDArray[np.float64]) -> None:
    """Check that three arrays are (N, 3), (N,) and (N,).

    Raises:
        ValueError: One is not.
    """
    if eyes.ndim != 2 or eyes.shape[1] != 3:
        raise ValueError(f"positions are float64 of shape {eyes.shape}, must be of shape (N, 3)")
    for name, values in (("yaws", yaws), ("pitches", pitches)):
        if values.shape != (len(eyes),):
            raise ValueError(f"{name} are float64 of shape {values.shape}, must be of shape ({len(eyes)},)")


def _refuse_numbers(*arrays: NDArray[np.float64]) -> NoReturn:
    """Say which of positions, yaws and pitches holds what is no finite number."""
    for name, values in zip(("positions", "yaws", "pitches"), arrays, strict=True):
        if not np.isfinite(values).all():
            raise ValueError(f"{name} hold {values[~np.isfinite(values)][0]}, must be finite")
    raise ValueError("positions, yaws and pitches add up to what is not finite")
