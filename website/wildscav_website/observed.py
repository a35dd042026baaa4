"""The meaning of each number of an observation and its place in flat rows, as rows of tables."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from gymnasium.spaces import Box, Dict

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.columns import groups_of
from wildscav_engine.envs.spaces.observation import readings_space
from wildscav_engine.sensors.base import Column


class Row(NamedTuple):
    """One number of an observation, or several of one kind: the pixels of an image, a column of a list."""

    part: str  # the group or sensor that it belongs to
    place: str  # its index in the part's array, as written in Python
    column: Column
    indexes: range  # its places in a flat row


def observation_rows(config: EnvConfig) -> list[Row]:
    """Return the rows of an environment's observation, in the order of its flat rows."""
    spaces: Dict = readings_space(config)
    columns = {group.name: group.columns for group in groups_of(config.version).values()}
    sensors = config.read_sensors()
    rows: list[Row] = []
    first = 0
    for name, box in spaces.spaces.items():
        assert isinstance(box, Box)  # noqa: S101 - what readings_space makes
        if name not in sensors:
            rows += _columns(name, columns[name], box, first)
        elif sensors[name].columns:
            rows += _columns(name, sensors[name].columns, box, first)
        else:
            rows.append(_pixels(name, sensors[name].title, box, first))
        first += math.prod(box.shape)
    return rows


def _columns(part: str, columns: tuple[Column, ...], box: Box, first: int) -> Iterator[Row]:
    """Describe a row of numbers, or a list of such rows; the bounds are those of the space."""
    size, width = math.prod(box.shape), len(columns)
    for place, column in enumerate(columns):
        low, high = float(box.low[..., place].min()), float(box.high[..., place].max())
        index = str(place) if len(box.shape) == 1 else f"i, {place}"
        bounded = column._replace(low=low, high=high)
        yield Row(part, index, bounded, range(first + place, first + size, width))


def _pixels(part: str, title: str, box: Box, first: int) -> Row:
    """Describe an image, whose numbers are all of one kind."""
    meaning, _, unit = title.rpartition(", ")
    shape = " × ".join(map(str, box.shape))
    column = Column(
        part, unit, float(box.low.min()), float(box.high.max()), f"{meaning or title}: {shape} pixels"
    )
    index = ", ".join("ijk"[: len(box.shape)])
    return Row(part, index, column, range(first, first + math.prod(box.shape)))
