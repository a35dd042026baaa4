"""What learners observe: groups of facts, side by side in one row a learner, and the chosen sensors."""

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import EVENTS, GROUPS, PARTS, STANDING, Part, parts_of
from wildscav_engine.envs.spaces.flattening import Flattener
from wildscav_engine.envs.spaces.match_in_batch import MatchInBatch
from wildscav_engine.parallel.threads import share
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.sensors.base import Sensor
from wildscav_engine.sensors.optics.optical import MovingOption, OpticalSensor, select_cameras
from wildscav_engine.sensors.scalars import ScalarSensor
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.tracks import TRACKS

if TYPE_CHECKING:
    from wildscav_engine.maps.game_map import GameMap
    from wildscav_engine.simulation.batch import Batch

EYES = np.array([0.0, EYE_HEIGHT, 0.0])
Readings = dict[str, NDArray[Any]]  # by the names of groups and sensors
Observation = Readings | NDArray[np.float32]  # the latter if the environment is flat


class Layout(NamedTuple):
    """Where each part lies in a row."""

    start: NDArray[np.int64]  # (PARTS,) its first column, or -1
    groups: tuple[tuple[str, int, int], ...]  # name, first column and the one after the last, of what is told
    told: int  # columns of the observation; those that follow are not part of it
    width: int

    def first(self, part: Part) -> int:
        """Return a part's first column."""
        return int(self.start[part])


def layout_of(config: EnvConfig) -> Layout:
    """Return how the rows of an environment are laid out."""
    start = np.full(PARTS, -1, np.int64)
    groups, column = [], 0
    for part in parts_of(TRACKS[config.track]):
        start[part] = column
        name, columns = GROUPS[part]
        width = len(columns)
        groups.append((name, column, column + width))
        column += width
    told = column
    for part, width in (
        (Part.STANDING, len(STANDING)),
        (Part.EVENTS, len(EVENTS)),
        (Part.TERMS, len(config.reward_weights)),
    ):
        start[part] = column
        column += width
    return Layout(start, tuple(groups), told, column)


def observation_space(config: EnvConfig) -> Dict | Box:
    """Return the space of one learner's observation."""
    space = readings_space(config)
    return Flattener(space).space if config.flat else space


def part_of(observation: Observation, place: Any) -> Observation:
    """Return what lies at a place of the first axes: some learners' observations, or one's."""
    if isinstance(observation, dict):
        return {name: values[place] for name, values in observation.items()}
    part: NDArray[np.float32] = observation[place]
    return part


def readings_space(config: EnvConfig) -> Dict:
    """Return the space of what one learner reads, by name."""
    spaces: dict[str, Space[Any]] = {}
    for part in parts_of(TRACKS[config.track]):
        name, columns = GROUPS[part]
        low = np.array([column.low for column in columns], np.float32)
        high = np.array([column.high for column in columns], np.float32)
        spaces[name] = Box(low, high, dtype=np.float32)
    for name, sensor in config.read_sensors().items():
        spaces[name] = _bounded(sensor.space)
    return Dict(spaces)


def _bounded(space: Box) -> Box:
    """Return a space with finite bounds that hold for all matches."""
    if not np.issubdtype(space.dtype, np.floating):
        return space
    limit = np.float32(10_000.0)
    low, high = np.maximum(space.low, -limit), space.high
    return Box(low, np.where(np.isinf(high), limit, high), dtype=np.float32)


class Sight:
    """The chosen sensors of all learners of a batch."""

    def __init__(self, sensors: Mapping[str, Sensor], learners: Sequence[int], threads: int) -> None:
        self._still = {
            name: sensor
            for name, sensor in sensors.items()
            if isinstance(sensor, OpticalSensor) and _sees_map_only(sensor)
        }
        self._others = {name: sensor for name, sensor in sensors.items() if name not in self._still}
        self._optical = [sensor for sensor in sensors.values() if isinstance(sensor, OpticalSensor)]
        self._lenses = {name: sensor.lens for name, sensor in self._still.items()}
        self._learners, self._threads = list(learners), threads
        self._rows = np.array(self._learners, np.int64)
        self._maps: list[GameMap] = []  # of every learner
        self._viewers = np.zeros(0, np.int32)

    def look_at(self, maps: "Sequence[GameMap]") -> None:
        """Take notice of which map each match is on."""
        self._maps = [game_map for game_map in maps for _ in self._learners]
        self._viewers = np.tile(np.array(self._learners, np.int32), len(maps))
        for game_map in maps:
            for sensor in self._optical:
                sensor.prepare(game_map)  # before the threads, which would all do it

    def read(self, batch: "Batch", view: Callable[[int], MatchInBatch], found: Readings) -> None:
        """Add (B, L, *shape) readings of all sensors to an observation, by their names."""
        if self._still:
            self._read_still(batch, found)
        for name, sensor in self._others.items():
            if isinstance(sensor, ScalarSensor):
                found[name] = sensor.read_all(batch.state, self._rows)
                continue
            readings = self._read_each(sensor, [view(match) for match in range(len(batch.specs))])
            found[name] = readings[0][np.newaxis] if len(readings) == 1 else np.stack(readings)

    def _read_each(self, sensor: Sensor, matches: Sequence[MatchInBatch]) -> list[NDArray[Any]]:
        """Return the readings of a sensor in each match."""
        readings: dict[int, NDArray[Any]] = {}

        def read(part: slice) -> bool:
            for match in range(part.start, part.stop):
                readings[match] = sensor.read(matches[match], self._learners)
            return True

        least = len(matches)
        if isinstance(sensor, OpticalSensor):
            least = -(-sensor.min_images_per_thread // len(self._learners))
        share(read, len(matches), self._threads, least)
        return [readings[match] for match in range(len(matches))]

    def _read_still(self, batch: "Batch", found: Readings) -> None:
        """Look at the maps alone, which needs no more of the matches than where the learners are."""
        agents, count = batch.state.agents, len(self._learners)
        eyes = (agents.position[:, :count] + EYES).reshape(-1, 3)
        yaws, pitches = agents.yaw[:, :count].flatten(), agents.pitch[:, :count].flatten()
        for name, sensor in self._still.items():
            images = self._look(sensor, Cameras(eyes, yaws, pitches, self._viewers, *self._lenses[name]))
            found[name] = images.reshape(-1, count, *sensor.shape)

    def _look(self, sensor: OpticalSensor, cameras: Cameras) -> NDArray[Any]:
        """Return (N, *shape) images of the maps alone."""
        images = np.empty((len(self._maps), *sensor.shape), sensor.dtype)
        if self._threads == 1:
            sensor.render_maps_into(self._maps, cameras, images)
            return images

        def render_part(part: slice) -> bool:
            return sensor.render_maps_into(self._maps[part], select_cameras(cameras, part), images[part])

        share(render_part, len(images), self._threads, sensor.min_images_per_thread)
        return images


def _sees_map_only(sensor: OpticalSensor) -> bool:
    """Return whether a sensor sees nothing of a match but its map."""
    if isinstance(sensor, MovingOption):
        return not sensor.moving
    return type(sensor).moving_in is OpticalSensor.moving_in
