"""What an episode is played on: its seed and its map, from the seed of the environment and a count.

The n-th episode after ``reset(seed=s)`` depends on s and n alone, so environment i of a vector with the seed
s is a single environment with the seed s + i. Train and test episodes never share a seed: matches to train on
have even seeds and those to test on odd ones, as random maps have (``maps/pools.py``).
"""

from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from wildscav_engine.arithmetic.random_numbers import philox
from wildscav_engine.maps import MapError, map_of, map_spec
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.pools import PARITY, Level, MapPool, Split, numbered_maps, random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

Land = int | MapSpec | MapConfig | tuple[int, ...] | None

# Beside the streams of ``rng.Stream``: episodes draw from seeds of environments, matches from their own.
EPISODES = 64
WORDS = 2**64


class Episode(NamedTuple):
    """One match that is to be played."""

    spec: MatchSpec
    game_map: GameMap


def pool_of(land: Land, level: Level, split: Split, maps: int) -> MapPool:
    """Return the maps that episodes are drawn from.

    Args:
        land: A numbered map, several, one map by its spec, or a kind of random maps; None: the level's.
        level: How hard random maps are.
        split: Whether random maps are those to train or to test on.
        maps: How many random maps there are.

    Raises:
        ValueError: There is no map of a number.
    """
    if isinstance(land, MapSpec):
        return MapPool([[land]])
    if isinstance(land, int | tuple):
        try:
            return numbered_maps((land,) if isinstance(land, int) else land)
        except MapError as error:
            raise ValueError(f"map: {error}") from error
    return random_maps(level if land is None else land, split, size=maps)


class Episodes:
    """The episodes of one environment, one after another."""

    def __init__(self, template: MatchSpec, pool: MapPool, split: Split, seed: int) -> None:
        """Begin with the first episode of a seed.

        Args:
            template: The match, but for its seed and its map.
            pool: The maps to choose from.
            split: Whether seeds are those to train or to test on.
            seed: 0 or more; it counts modulo 2 to the 64th.
        """
        self.seed, self.number = seed % WORDS, 0
        self._template, self._pool, self._split = template, pool, split

    def next(self, options: Mapping[str, Any] | None = None) -> Episode:
        """Return the next episode.

        Args:
            options: ``start``, ``target`` and ``map`` of this episode alone; others are ignored.

        Raises:
            ValueError: An option is wrong.
            MapError: The map cannot be made.
        """
        first, second = philox(np.uint64(self.seed), EPISODES, 0, 0, self.number)
        self.number += 1
        seed = int(first) // 2 * 2 + PARITY[self._split]
        game_map = self._pool.draw(int(second))
        spec = self._template.model_copy(update={"seed": seed, "map": game_map.spec})
        if options and not options.keys().isdisjoint({"start", "target", "map"}):
            spec = _changed(spec, options)
            game_map = map_of(spec.map) if "map" in options else game_map
        return Episode(spec, game_map)


def _changed(spec: MatchSpec, options: Mapping[str, Any]) -> MatchSpec:
    """Return a match with what the options of a reset say."""
    fields = {name: getattr(spec, name) for name in MatchSpec.model_fields}
    for name in ("start", "target"):
        if name in options:
            fields[name] = options[name]
            fields["starts"] = None if name == "start" else fields["starts"]
    if "map" in options:
        place = options["map"]
        fields["map"] = map_spec(place) if isinstance(place, int) else place
    return MatchSpec(**fields)
