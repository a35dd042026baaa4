"""What an episode is played on: its seed and its map, from the seed of the environment and a count.

The n-th episode after ``reset(seed=s)`` depends on s and n alone, so environment i of a vector with the seed
s is a single environment with the seed s + i. Train and test episodes never share a seed: those to train on
have even seeds, those to test on odd ones, of the matches and of the random maps alike.
"""

from collections.abc import Mapping
from typing import Any, Literal, NamedTuple

import numpy as np

from wildscav_engine.maps import MapError, load_map, map_of, map_spec
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rng import philox
from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec

Split = Literal["train", "test"]
Level = Literal["easy", "normal", "hard"]
Place = int | MapSpec | MapConfig | tuple[int, ...] | None

# Beside the streams of ``rng.Stream``: episodes draw from seeds of environments, matches from their own.
EPISODES = 64
ODD: dict[Split, int] = {"train": 0, "test": 1}
WORDS = 2**64

LEVELS: dict[Level, MapConfig] = {
    "easy": MapConfig(
        size=80, relief=0.4, ruggedness=0.2, water=0.03, houses=2, storeys=(1, 1), vegetation=0.2
    ),
    "normal": MapConfig(size=160, houses=6),
    "hard": MapConfig(
        size=300, relief=1.4, ruggedness=0.7, water=0.12, houses=14, storeys=(1, 3), vegetation=0.7
    ),
}


class Episode(NamedTuple):
    """One match that is to be played."""

    spec: MatchSpec
    game_map: GameMap


class MapPool:
    """The maps that episodes are drawn from, made when one is first played on."""

    def __init__(self, place: Place, level: Level, split: Split, random_maps: int) -> None:
        """Choose the maps.

        Args:
            place: A numbered map, several, one map by its spec, or a kind of random maps; None: the level's.
            level: How hard random maps are.
            split: Whether random maps are those to train or to test on.
            random_maps: How many random maps there are.

        Raises:
            ValueError: There is no map of a number.
        """
        self.specs = _specs_of(place, level, split, random_maps)
        self._made: dict[MapSpec, GameMap] = {}

    def map_of(self, spec: MapSpec) -> GameMap:
        """Return a map, remembered."""
        if spec not in self._made:
            self._made[spec] = map_of(spec)
        return self._made[spec]

    def largest(self) -> float:
        """Return the size of the largest map in m."""
        return max(spec.config.size for spec in self.specs)


def _specs_of(place: Place, level: Level, split: Split, random_maps: int) -> tuple[MapSpec, ...]:
    if isinstance(place, MapSpec):
        return (place,)
    if isinstance(place, int | tuple):
        ids = (place,) if isinstance(place, int) else place
        try:
            return tuple(map_spec(number) for number in ids)
        except MapError as error:
            raise ValueError(f"map: {error}") from error
    config = LEVELS[level] if place is None else place
    return tuple(MapSpec(config=config, seed=2 * number + ODD[split]) for number in range(random_maps))


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
        """Return the next episode, its map included; ``plan`` says what options may be."""
        spec = self.plan(options)
        return Episode(spec, self._pool.map_of(spec.map))

    def plan(self, options: Mapping[str, Any] | None = None) -> MatchSpec:
        """Return the match of the next episode.

        Args:
            options: ``start``, ``target`` and ``map`` of this episode alone; others are ignored.

        Raises:
            ValueError: An option is wrong.
        """
        first, second = philox(np.uint64(self.seed), EPISODES, 0, 0, self.number)
        self.number += 1
        seed = int(first) // 2 * 2 + ODD[self._split]
        specs = self._pool.specs
        spec = self._template.varied(seed=seed, map=specs[int(second) % len(specs)])
        if options and not options.keys().isdisjoint({"start", "target", "map"}):
            spec = _changed(spec, options)
        return spec


def _changed(spec: MatchSpec, options: Mapping[str, Any]) -> MatchSpec:
    """Return a match with what the options of a reset say."""
    fields = {name: getattr(spec, name) for name in MatchSpec.model_fields}
    for name in ("start", "target"):
        if name in options:
            fields[name] = options[name]
            fields["starts"] = None if name == "start" else fields["starts"]
    if "map" in options:
        place = options["map"]
        fields["map"] = load_map(place).spec if isinstance(place, int) else place
    return MatchSpec(**fields)
