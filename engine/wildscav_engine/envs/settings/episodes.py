"""The sequence of episodes of an environment: the seed and the map of each.

The n-th episode after ``reset(seed=s)`` depends only on s and n, so environment i of a vector with the seed s
equals a single environment with the seed s + i. Train and test episodes never share a seed: matches for
training have even seeds and those for testing odd ones, as random maps do (``maps/pools.py``).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from wildscav_engine.arithmetic.random_numbers import philox
from wildscav_engine.maps import MapError, map_of, map_spec
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.pools import PARITY, Level, MapPool, Split, numbered_maps, random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

MapChoice = int | MapSpec | MapConfig | tuple[int, ...] | None

# A random stream in addition to those of ``Stream``: episodes draw from the seeds of environments.
EPISODES = 64
WORDS = 2**64
ONCE = {"start", "start_range", "target", "map"}  # what the options of a reset set for one episode


class Episode(NamedTuple):
    """The match of one episode."""

    spec: MatchSpec
    game_map: GameMap


def pool_of(choice: MapChoice, level: Level, split: Split, maps: int, *, unseen: bool = False) -> MapPool:
    """Return the maps that episodes are drawn from.

    Args:
        choice: A numbered map, several, one map by its spec, or the config of random maps; None: the level's.
        level: The difficulty of random maps.
        split: Whether random maps are for training or for testing.
        maps: The number of random maps.
        unseen: Whether random maps for testing hold only pieces that those for training lack.

    Raises:
        ValueError: There is no map with a given number, or such maps have no unseen pieces.
    """
    if unseen and isinstance(choice, MapSpec | int | tuple):
        raise ValueError("unseen is True, but map names fixed maps; only random maps have unseen pieces")
    if isinstance(choice, MapSpec):
        return MapPool([[choice]])
    if isinstance(choice, int | tuple):
        try:
            return numbered_maps((choice,) if isinstance(choice, int) else choice)
        except MapError as error:
            raise ValueError(f"map: {error}") from error
    return random_maps(level if choice is None else choice, split, size=maps, unseen=unseen)


@dataclass
class Plan:
    """What the episodes of an environment have in common. Changes of it apply to the episodes that follow."""

    template: MatchSpec  # apart from seed and map
    pool: MapPool  # the maps from which to draw
    split: Split  # whether seeds are for training or for testing


class Episodes:
    """The sequence of episodes of one environment."""

    def __init__(self, plan: Plan, seed: int) -> None:
        """Create the sequence of episodes of a seed.

        Args:
            plan: What they have in common.
            seed: 0 or more, taken modulo 2 to the 64th.
        """
        self.seed, self.number = seed % WORDS, 0
        self._plan = plan

    def next(self, options: Mapping[str, Any] | None = None) -> Episode:
        """Return the next episode.

        Args:
            options: ``start``, ``start_range``, ``target`` and ``map`` of this episode alone; others are
                ignored.

        Raises:
            ValueError: An option is wrong.
            MapError: The map cannot be made.
        """
        first, second = philox(np.uint64(self.seed), EPISODES, 0, 0, self.number)
        self.number += 1
        plan = self._plan
        seed = int(first) // 2 * 2 + PARITY[plan.split]
        game_map = plan.pool.draw(int(second))
        spec = plan.template.model_copy(update={"seed": seed, "map": game_map.spec})
        if options and not options.keys().isdisjoint(ONCE):
            spec = _changed(spec, options)
            game_map = map_of(spec.map) if "map" in options else game_map
        return Episode(spec, game_map)


def _changed(spec: MatchSpec, options: Mapping[str, Any]) -> MatchSpec:
    """Return a spec with the changes that the options of a reset demand."""
    fields = {name: getattr(spec, name) for name in MatchSpec.model_fields}
    for name in ("start", "start_range", "target"):
        if name in options:
            fields[name] = options[name]
            fields["starts"] = None if name == "start" else fields["starts"]
    if "map" in options:
        chosen = options["map"]
        fields["map"] = map_spec(chosen) if isinstance(chosen, int) else chosen
    return MatchSpec(**fields)
