"""From the actions that were played to those of an action mode: the nearest ones, for learners that imitate.

The mode ``dict`` keeps what was played, so its space here allows any walk speed; ``keys`` are those that were
held, by agents that play so. The others approximate: ``box`` limits how fast an agent turns, and the others
have few choices.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium.spaces import Box, Dict, Space
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.spaces.actions import (
    DIRECTIONS,
    LOOK_STEP,
    TURN_STEP,
    WALK_SPEEDS,
    BaselineMode,
    MultiDiscreteMode,
    action_mode,
)
from wildscav_engine.envs.spaces.keys import KeysMode
from wildscav_engine.specs.actions import LOOK_LIMIT, MAX_WALK_SPEED, TURN_LIMIT, Field

Played = NDArray[np.float32]  # (N, FIELDS) rows as the engine returned them
Yaws = NDArray[np.float64]  # (N,) degrees, of the agents before the step
Encoder = Callable[[Played, Yaws], Any]  # returns N actions, as Gymnasium batches them


def played_space(config: EnvConfig) -> Space[Any]:
    """Return the space of one learner's actions as an ``Encoder`` of an environment returns them."""
    space = action_mode(config).space
    if config.action_mode == "dict" and isinstance(space, Dict):
        walk = Field.WALK_SPEED.name.lower()
        return Dict({**space.spaces, walk: Box(0.0, MAX_WALK_SPEED, (), np.float32)})
    return space


def played_encoder(config: EnvConfig) -> Encoder:
    """Return what turns played actions into those of an environment's action mode."""
    flags = [field for field in config.fields if field > Field.LOOK]
    frames = config.frames_per_action
    if config.action_mode == "dict":
        return lambda rows, _: _fields(rows, config.fields)
    if config.action_mode == "box":
        return lambda rows, _: _box(rows, frames, flags)
    mode = action_mode(config)
    if isinstance(mode, KeysMode):
        return mode.recover
    if isinstance(mode, MultiDiscreteMode):
        return lambda rows, yaws: _choices(rows, yaws, mode, flags)
    table = BaselineMode(config.fields, frames).table
    return lambda rows, _: _nearest_rows(rows, table)


def _fields(rows: Played, fields: tuple[Field, ...]) -> dict[str, NDArray[Any]]:
    """Return actions of the mode ``dict``: (N,) numbers by the names of the fields."""
    found: dict[str, NDArray[Any]] = {}
    for field in fields:
        column = rows[:, field]
        if field == Field.WALK_DIRECTION:
            column = np.where((column >= 0.0) & (column <= 360.0), column, np.mod(column, np.float32(360.0)))
        elif field == Field.TURN:
            column = np.where(np.abs(column) <= TURN_LIMIT, column, np.mod(column + 180.0, 360.0) - 180.0)
        elif field == Field.LOOK:
            column = column.clip(-LOOK_LIMIT, LOOK_LIMIT)
        found[field.name.lower()] = column.astype(np.int64 if field > Field.LOOK else np.float32)
    return found


def _walks(rows: Played) -> NDArray[np.float64]:
    """Return (N, 2) the walks to the east and to the north, m/s."""
    angle, speed = np.radians(rows[:, Field.WALK_DIRECTION].astype(np.float64)), rows[:, Field.WALK_SPEED]
    return np.stack([np.sin(angle) * speed, np.cos(angle) * speed], axis=1)


def _box(rows: Played, frames: int, flags: list[Field]) -> NDArray[np.float32]:
    """Return (N, k) actions of the mode ``box``."""
    turns = rows[:, [Field.TURN, Field.LOOK]] * frames / np.array([TURN_STEP, LOOK_STEP])
    parts = (_walks(rows) / MAX_WALK_SPEED, turns, rows[:, flags] * 2.0 - 1.0)
    return np.concatenate(parts, axis=1).clip(-1.0, 1.0).astype(np.float32)


def _choices(rows: Played, yaws: Yaws, mode: MultiDiscreteMode, flags: list[Field]) -> NDArray[np.int64]:
    """Return (N, k) actions of the modes ``multidiscrete`` and ``fine``."""
    speed = rows[:, Field.WALK_SPEED]
    sector = np.rint((rows[:, Field.WALK_DIRECTION] - yaws) / (360.0 / DIRECTIONS)).astype(np.int64)
    walk = np.where(speed < WALK_SPEEDS[0] / 2.0, 0, 1 + sector % DIRECTIONS)
    chosen = [
        walk,
        _nearest(speed, WALK_SPEEDS),
        _nearest(rows[:, Field.TURN] * mode.frames, mode.turns),
        _nearest(rows[:, Field.LOOK] * mode.frames, mode.looks),
    ]
    return np.concatenate([np.stack(chosen, axis=1), rows[:, flags].astype(np.int64)], axis=1)


def _nearest(values: NDArray[np.float32], choices: tuple[float, ...]) -> NDArray[np.int64]:
    """Return (N,) the indices of the choices nearest to values."""
    return np.asarray(np.abs(values[:, np.newaxis] - np.array(choices)).argmin(axis=1))


def _nearest_rows(rows: Played, table: Played) -> NDArray[np.int64]:
    """Return (N,) actions of the mode ``baseline``: the nearest walk, and above all whether to pick up."""
    apart = _walks(rows)[:, np.newaxis] - _walks(table)
    distance = (apart * apart).sum(axis=2)
    other = rows[:, Field.PICK_UP, np.newaxis] != table[:, Field.PICK_UP]
    distance += other * (2.0 * MAX_WALK_SPEED) ** 2
    return np.asarray(distance.argmin(axis=1))
