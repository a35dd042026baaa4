"""A script that reads the texts and nothing else plays real matches."""

import pytest
from benchmarks.strength.words import READER, Readers

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import Rules, Senses
from wildscav_training.trials import play

SMALL = MapSpec(config=MapConfig(size=50, houses=1, vegetation=0.2), seed=3)


def test_it_reaches_the_target() -> None:
    spec = MatchSpec(track="navigation", map=SMALL, seed=2, time_limit=30.0)

    assert play(Readers(READER), spec).metrics["success"] == 1.0


@pytest.mark.parametrize("senses", [Senses.ORIGINAL, Senses.SIGHTED])
def test_it_gathers(senses: Senses) -> None:
    rules = Rules(senses=int(senses))
    spec = MatchSpec(track="gathering", map=SMALL, seed=2, time_limit=10.0, rules=rules)

    assert play(Readers(READER), spec).metrics["supplies"] > 3
