"""A script that reads the texts and nothing else plays real matches."""

import tomllib

import pytest
from tests.end_to_end.pages import ROOT

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import Rules, Senses
from wildscav_language.senses import sensors
from wildscav_training.opponents import named_agent
from wildscav_training.trials import play

READER = ROOT / "benchmarks" / "strength" / "reader"
SMALL = MapSpec(config=MapConfig(size=50, houses=1, vegetation=0.2), seed=3)


def test_it_has_the_sensors_of_seats_of_words() -> None:
    assert tomllib.loads((READER / "submission.toml").read_text("utf-8"))["sensors"] == sensors()


def test_it_reaches_the_target() -> None:
    spec = MatchSpec(track="navigation", map=SMALL, seed=2, time_limit=30.0)

    assert play(named_agent(str(READER)), spec).metrics["success"] == 1.0


@pytest.mark.parametrize("senses", [Senses.ORIGINAL, Senses.SIGHTED])
def test_it_gathers(senses: Senses) -> None:
    rules = Rules(senses=int(senses))
    spec = MatchSpec(track="gathering", map=SMALL, seed=2, time_limit=10.0, rules=rules)

    assert play(named_agent(str(READER)), spec).metrics["supplies"] > 3
