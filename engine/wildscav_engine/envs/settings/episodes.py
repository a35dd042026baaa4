"""The sequence of episodes of an environment: the seed and the map of each.

The n-th episode after ``reset(seed=s)`` depends only on s and n, so environment i of a vector with the seed s
equals a single environment with the seed s + i. Train and test episodes never share a seed: matches for
training have even seeds and those for testing odd ones, as random maps do (``maps/pools.py``).
"""

import operator
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import philox
from wildscav_engine.envs.settings.config import ONCE, EnvConfig, check_reset, config_of_episode
from wildscav_engine.maps import MapError
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.pools import PARITY, MapPool, numbered_maps, random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

# A random stream in addition to those of ``Stream``: episodes draw from the seeds of environments.
EPISODES = 64
WORDS = 2**64


class Episode(NamedTuple):
    """The match of one episode."""

    spec: MatchSpec
    game_map: GameMap


def pool_of(config: EnvConfig) -> MapPool:
    """Return the maps that the episodes of an environment are drawn from; ValueError if there are none."""
    choice = config.map
    if choice is None or isinstance(choice, MapConfig):
        kind = config.level if choice is None else choice
        return random_maps(kind, config.split, size=config.random_maps, unseen=config.unseen)
    if config.unseen:
        raise ValueError("unseen is True, but map names fixed maps; only random maps have unseen pieces")
    if isinstance(choice, MapSpec):
        return MapPool(1, [[choice]].__getitem__)
    try:
        return numbered_maps((choice,) if isinstance(choice, int) else choice)
    except MapError as error:
        raise ValueError(f"map: {error}") from error


class Plan:
    """What the episodes of an environment have in common."""

    def __init__(self, config: EnvConfig, pool: MapPool | None = None) -> None:
        """Plan the episodes of an environment with these options, on the maps of a pool if it is given."""
        self.config = config
        self.template = config.match_spec()  # apart from seed and map
        self.pool = pool_of(config) if pool is None else pool

    def once(self, options: Mapping[str, Any] | None) -> "Plan":
        """Return the plan of one episode with the options of a reset; errors as ``config_of_episode``."""
        if not options:
            return self
        config = config_of_episode(self.config, options)
        return Plan(config, None if "map" in options else self.pool)


@dataclass
class Episodes:
    """The sequence of episodes of one environment."""

    seed: int  # taken modulo 2 to the 64th
    number: int = 0  # of the next episode

    def next(self, plan: Plan) -> Episode:
        """Return the next episode. It stays the next one until ``number`` is raised."""
        first, second = self.draw()
        seed = first // 2 * 2 + PARITY[plan.config.split]
        game_map = plan.pool.draw(second)
        spec = plan.template.model_copy(update={"seed": seed, "map": game_map.spec})
        return Episode(spec, game_map)

    def draw(self) -> tuple[int, int]:
        """Return two random integers: for the seed and for the map of the next episode."""
        first, second = philox(np.uint64(self.seed % WORDS), EPISODES, 0, 0, self.number)
        return int(first), int(second)


def next_episodes(sequences: Collection[Episodes], plans: Sequence[Plan]) -> list[Episode]:
    """Return the next episode of each sequence by its plan; maps that several need are made at once."""
    if len(sequences) > 1:
        for pool in {id(plan.pool): plan.pool for plan in plans}.values():
            if not pool.is_made:
                pairs = zip(sequences, plans, strict=True)
                pool.prepare(each.draw()[1] for each, plan in pairs if plan.pool is pool)
    return [each.next(plan) for each, plan in zip(sequences, plans, strict=True)]


def read_each(options: Any, rows: int) -> list[Mapping[str, Any]]:
    """Return the options of a reset for each row: those in ``each`` take precedence over those beside it."""
    if "each" not in options:
        return [options] * rows
    each = options["each"]
    if not isinstance(each, list | tuple) or len(each) != rows:
        raise ValueError(f"each is {each!r}, must be a list of {rows} dictionaries, one for each row")
    common = {name: value for name, value in options.items() if name != "each"}
    for one in each:
        if one is not None:
            check_reset(one, ONCE)
    return [{**common, **(one or {})} for one in each]


def read_rows(rows: Any, count: int) -> list[int]:
    """Return the numbers of some rows, of which there are ``count``."""
    try:
        numbers = [-1 if isinstance(row, bool) else operator.index(row) for row in rows]
    except TypeError:
        numbers = [-1]
    if not all(0 <= number < count for number in numbers):
        raise ValueError(f"rows is {rows!r}, must be a list of numbers from 0 to {count - 1}")
    return numbers


def read_seed(seed: Any) -> int:
    """Return the seed of an environment."""
    try:
        number = operator.index(seed)
    except TypeError:
        number = -1
    if number < 0:
        raise ValueError(f"seed is {seed!r}, must be a whole number, 0 or more")
    return number


def read_seeds(seed: Any, rows: int) -> list[int | None]:
    """Return the seeds of the rows of an environment, None to continue their sequences of episodes.

    One seed is that of the first row, from which the others count on; a list has those of all rows.
    """
    has_length = seed.ndim > 0 if isinstance(seed, np.ndarray) else isinstance(seed, Sequence)
    if not has_length or isinstance(seed, str | bytes):
        return [None if seed is None else read_seed(seed) + row for row in range(rows)]
    seeds = [None if one is None else read_seed(one) for one in seed]
    if len(seeds) != rows:
        raise ValueError(f"{len(seeds)} seeds are given for {rows} environments")
    return seeds


def read_mask(mask: Any, rows: int, name: str) -> NDArray[np.bool_]:
    """Return a copy of a mask (rows,) of rows to reset; ``name`` is its own, for errors."""
    try:
        array = np.array(mask)
    except ValueError:  # rows of different lengths
        array = np.empty(0, object)
    if array.shape != (rows,) or array.dtype != np.bool_ or not array.any():
        raise ValueError(
            f"{name} is {array.dtype} of shape {array.shape}, must be bool of shape ({rows},) and True "
            "somewhere"
        )
    return array
