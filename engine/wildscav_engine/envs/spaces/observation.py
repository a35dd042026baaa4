"""Observations of learners: groups of columns side by side in one row per learner, and the chosen sensors."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import EVENTS, OUTCOME, PARTS, Part, groups_of, parts_of
from wildscav_engine.envs.spaces.flattening import Flattener
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.parallel.threads import SharedWork, share
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.dynamic_objects import ObjectSets
from wildscav_engine.sensors.base import Sensor, StateSensor
from wildscav_engine.sensors.optics.dynamic_objects import objects_of_matches
from wildscav_engine.sensors.optics.image_sensor import (
    NO_DYNAMIC_OBJECTS,
    ImageSensor,
    ShownMaps,
    in_one_match,
)
from wildscav_engine.tracks import TRACKS

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.batch import Batch
    from wildscav_engine.simulation.systems.visibility import Seen

Readings = dict[str, NDArray[Any]]  # by names of groups and sensors
Observation = Readings | NDArray[np.float32]  # the latter if the environment is flat
# (N, 3) m, the eyes; (N,) degrees, the yaws; and (N,) degrees, the pitches.
Poses = tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]


class Layout(NamedTuple):
    """The positions of the parts in a row."""

    start: NDArray[np.int64]  # (PARTS,) the first column of each part, or -1 if absent
    groups: tuple[tuple[str, int, int], ...]  # of the observation: name, first column, end column
    width: int

    def first(self, part: Part) -> int:
        """Return a part's first column."""
        return int(self.start[part])


def layout_of(config: EnvConfig) -> Layout:
    """Return the layout of the rows of an environment."""
    start = np.full(PARTS, -1, np.int64)
    groups, column = [], 0
    kinds, parts = groups_of(config.version), parts_of(TRACKS[config.track], config.version)
    for part in sorted(parts, key=lambda part: kinds[part].name):  # as in flat observations
        start[part] = column
        column += len(kinds[part].columns)
    for part in parts:
        first = int(start[part])
        groups.append((kinds[part].name, first, first + len(kinds[part].columns)))
    for part, width in (
        (Part.OUTCOME, len(OUTCOME)),
        (Part.EVENTS, len(EVENTS)),
        (Part.TERMS, len(config.reward_weights) + len(config.reward_functions)),
    ):
        start[part] = column
        column += width
    return Layout(start, tuple(groups), column)


def observation_space(config: EnvConfig) -> Dict | Box:
    """Return the space of one learner's observation."""
    space = readings_space(config)
    return Flattener(space, config.version).space if config.flat else space


def part_of(observation: Observation, index: Any) -> Observation:
    """Return the observations at an index of the first axes: those of some learners, or of one."""
    if isinstance(observation, dict):
        return {name: values[index] for name, values in observation.items()}
    part: NDArray[np.float32] = observation[index]
    return part


def readings_space(config: EnvConfig) -> Dict:
    """Return the space of one learner's readings by name."""
    spaces: dict[str, Space[Any]] = {}
    for part in parts_of(TRACKS[config.track], config.version):
        name, columns = groups_of(config.version)[part]
        low = np.array([column.low for column in columns], np.float32)
        high = np.array([column.high for column in columns], np.float32)
        spaces[name] = Box(low, high, dtype=np.float32)
    for name, sensor in config.read_sensors().items():
        spaces[name] = _bounded(sensor.space)
    for name, observer in config.observers.items():
        if name in spaces:
            raise ValueError(f"observers: {name!r} is already part of the observation: choose another name")
        spaces[name] = _bounded(observer.space)
    return Dict(spaces)


def _bounded(space: Box) -> Box:
    """Return a space with finite bounds that are valid in all matches."""
    if not np.issubdtype(space.dtype, np.floating):
        return space
    limit = np.float32(10_000.0)
    low, high = np.maximum(space.low, -limit), space.high
    return Box(low, np.where(np.isinf(high), limit, high), dtype=np.float32)


class SensorReader:
    """Reads the chosen sensors of some seats of all matches of a batch."""

    def __init__(
        self, sensors: Mapping[str, Sensor], seats: Sequence[int], poses: Poses, threads: int
    ) -> None:
        """Create a reader of sensors, by their names in observations, for some seats of all matches.

        The poses are those of the seats, match by match, and up to date whenever ``begin`` is called.
        """
        self._images = [sensor for sensor in sensors.values() if isinstance(sensor, ImageSensor)]
        self._together = {
            name: sensor
            for name, sensor in sensors.items()
            if isinstance(sensor, ImageSensor) and (_reads_many(sensor) or _sees_map_only(sensor))
        }
        self._others = {name: sensor for name, sensor in sensors.items() if name not in self._together}
        self._seats, self._threads = list(seats), threads
        self._rows = np.array(self._seats, np.int64)
        self._shown = ShownMaps([])  # the map of every seat that is read
        self._begun: list[SharedWork] = []
        self._displays: list[tuple[ImageSensor, NDArray[Any]]] = []  # to draw over finished images
        self._batch: Batch | None = None  # whose images they are
        count = len(poses[1])
        viewers = np.resize(np.array(self._seats, np.int32), count)
        self._cameras = {
            name: Cameras(*poses, viewers, *sensor.lens) for name, sensor in self._together.items()
        }
        self._matches = np.arange(count) // len(self._seats)  # of every seat that is read
        self._moves = {name for name, sensor in self._together.items() if not _sees_map_only(sensor)}
        self._objects: ObjectSets | None = None  # of the last step

    def set_maps(self, maps: "Sequence[GameMap]") -> None:
        """Set the map of every match."""
        self._shown = ShownMaps([game_map for game_map in maps for _ in self._seats])
        for game_map in maps:
            for sensor in self._images:
                sensor.prepare(game_map)  # in advance, because all threads would do it

    def begin(self, batch: "Batch", view: Callable[[int], MatchInBatch], found: Readings) -> None:
        """Add (B, L, *shape) readings of all sensors to an observation, by their names.

        Other threads begin with images. All readings are complete after ``finish``.
        """
        self._begun, self._displays, self._batch = [], [], batch
        if self._together:
            self._begin_together(batch, found)
        for name, sensor in self._others.items():
            if isinstance(sensor, StateSensor):
                found[name] = sensor.read_batch(batch.state, self._seen(batch, sensor.sight), self._rows)
                continue
            readings = self._read_each(sensor, [view(match) for match in range(len(batch.specs))])
            found[name] = readings[0][np.newaxis] if len(readings) == 1 else np.stack(readings)

    def _seen(self, batch: "Batch", sight: str) -> "Seen":
        """Return what agents see, up to date as far as a sensor needs it; see ``StateSensor.sight``."""
        if sight == "all":
            return batch.seen
        return batch.seen_by(self._seats if sight == "own" else (), self._threads)

    def finish(self) -> None:
        """Render the images that no other thread has begun with, wait for those, and draw the displays."""
        while self._begun:
            self._begun.pop().finish()
        while self._displays and self._batch is not None:
            sensor, images = self._displays.pop()
            batch, seen = self._batch, self._seen(self._batch, "own")
            sensor.draw_over(batch.state, seen, batch.track.name, self._rows, images)

    def _read_each(self, sensor: Sensor, matches: Sequence[MatchInBatch]) -> list[NDArray[Any]]:
        """Return the readings of a sensor in each match."""
        readings: dict[int, NDArray[Any]] = {}

        def read(part: slice) -> bool:
            for match in range(part.start, part.stop):
                readings[match] = sensor.read(matches[match], self._seats)
            return True

        _ = matches[0].seen  # in advance, because all threads would do it
        least = len(matches)
        if isinstance(sensor, ImageSensor):
            least = -(-sensor.min_images_per_thread // len(self._seats))
        share(read, len(matches), self._threads, least)
        return [readings[match] for match in range(len(matches))]

    def _begin_together(self, batch: "Batch", found: Readings) -> None:
        """Begin to render the images of all matches, in one call of each thread for each sensor."""
        if self._moves:
            self._objects = objects_of_matches(batch.state, self._objects)
        count, seats = len(self._matches), len(self._seats)
        for name, sensor in self._together.items():
            images = np.empty((count // seats, seats, *sensor.shape), sensor.dtype)
            found[name] = images
            if sensor.has_display:
                self._displays.append((sensor, images))
            shown: Any = (NO_DYNAMIC_OBJECTS.sets, in_one_match(count))
            if name in self._moves:
                shown = (self._objects, self._matches)
            arguments = *shown, self._cameras[name], images.reshape(count, *sensor.shape)
            if self._threads == 1:
                sensor.render_matches_into(self._shown, *arguments)
                continue
            render = partial(sensor.render_matches_into, self._shown, *arguments)
            self._begun.append(SharedWork(render, count, self._threads, sensor.min_images_per_thread))


def _reads_many(sensor: ImageSensor) -> bool:
    """Return whether one call of a sensor makes the images of many matches, each with what moves in it."""
    return type(sensor).write_images is not ImageSensor.write_images


def _sees_map_only(sensor: ImageSensor) -> bool:
    """Return whether a sensor sees only the map of a match."""
    return type(sensor).moving_in is ImageSensor.moving_in and not sensor.sees_objects
