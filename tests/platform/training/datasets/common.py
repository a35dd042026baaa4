"""What the tests of data sets share: a record of a match that an environment can play again."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.episodes import Episodes, Plan
from wildscav_engine.envs.spaces.actions import action_mode
from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS, Field, no_actions


def random_rows(seats: int, seed: int) -> NDArray[np.float32]:
    """Actions that all modes of a battle know in the form of the engine."""
    random = np.random.default_rng(seed)
    rows = np.zeros((seats, FIELDS), np.float32)
    rows[:, Field.WALK_DIRECTION] = random.uniform(0.0, 360.0, seats)
    rows[:, Field.WALK_SPEED] = random.uniform(0.0, 10.0, seats)
    rows[:, Field.TURN], rows[:, Field.LOOK] = random.uniform(-9.0, 9.0, (2, seats))
    rows[:, Field.JUMP :] = random.integers(0, 2, (seats, FIELDS - Field.JUMP))
    return rows


def write_match(path: Path, config: EnvConfig, seed: int, names: tuple[str, ...] | None = None) -> Match:
    """Play the first match of an environment at random and write its record."""
    episode = Episodes(seed).next(Plan(config))
    match = Match(episode.spec, episode.game_map)
    while not match.over:
        match.step(random_rows(match.seats, match.step_number))
    write_record(path, match, names or tuple(f"agent {seat}" for seat in range(match.seats)))
    return match


def write_keys(path: Path, config: EnvConfig, seed: int) -> list[dict[str, Any]]:
    """Play the first match of an environment by random keys, write its record, and return the keys."""
    episode, mode = Episodes(seed).next(Plan(config)), action_mode(config)
    match, held, space = Match(episode.spec, episode.game_map), [], mode.space
    space.seed(seed)
    while not match.over:
        held.append(space.sample())
        rows = no_actions(match.seats)
        mode.decode(held[-1], match.state.agents.yaw[0, :1], rows[:1], ())
        match.step(rows)
    write_record(path, match, [f"agent {seat}" for seat in range(match.seats)])
    return held


def at(values: Any, step: int) -> Any:
    """Return the observation or the action of one step, as arrays."""
    if isinstance(values, dict):
        return {name: at(value, step) for name, value in values.items()}
    return np.asarray(values[step])
