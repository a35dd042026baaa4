"""The levels: frozen, and solvable on every map."""

import typing
from hashlib import blake2b

import numpy as np
import pytest

from wildscav_engine.maps.levels import LEVELS, Level
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.map_spec import Country, MapConfig
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.storage.binary_format import canonical_json

FROZEN = {  # the digest of each config
    "easy": "da38b5a65f393bfc",
    "normal": "e8b8044a96b5d224",
    "hard": "ef02fc796a7cd03c",
    "tough": "d5810ccfbe059b8b",
    "severe": "1445758b65b9562a",
    "brutal": "eb527960aa957dc6",
    "extreme": "168e737d6d1e2158",
    "expert": "8c0e2efde22ad933",
}


@pytest.mark.parametrize("level", LEVELS)
def test_a_level_is_frozen(level: Level) -> None:
    dumped = canonical_json(LEVELS[level].model_dump(mode="json"))

    assert blake2b(dumped, digest_size=8).hexdigest() == FROZEN[level]


def test_the_levels_are_in_the_order_of_their_names() -> None:
    assert tuple(LEVELS) == typing.get_args(Level) == tuple(FROZEN)
    assert LEVELS["expert"] == MapConfig(
        size=200, relief=0.5, ruggedness=0.2, water=0.03, houses=6, storeys=(1, 3), country=Country()
    )


@pytest.mark.parametrize("level", LEVELS)
def test_a_way_leads_to_the_target_on_every_map_of_a_level(level: Level) -> None:
    game_map = random_maps(level, "test", size=1)[0]
    specs = [MatchSpec(track="navigation", map=game_map.spec, seed=seed) for seed in range(4)]
    state = Batch(specs, [game_map] * 4).state
    for start, target in zip(state.agents.position[:, 0], state.matches.target, strict=True):
        path = find_path(game_map.graph, start, target)
        assert path is not None
        assert path.length > 0.9 * np.hypot(*(target - start)[[0, 2]]) - 2.0
