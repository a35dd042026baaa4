"""A record for all commands that show one."""

from pathlib import Path

import pytest

from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec


@pytest.fixture(scope="module")
def record(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A battle of 2 s, in a folder of its own."""
    place = MapSpec(config=MapConfig(size=60, houses=1, water=0.1), seed=1)
    match = Match(MatchSpec(track="battle", map=place, seats=("fighter",) * 3, time_limit=2.0, seed=3))
    match.play_out()
    path = tmp_path_factory.mktemp("record") / "battle.wsr"
    write_record(path, match, ["ann", "bob", "eve"])
    return path
