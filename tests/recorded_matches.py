"""Records of real matches, one of each track: a fixture for the ``conftest.py`` of a folder."""

from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

SMALL_MAP = MapSpec(config=MapConfig(size=60, houses=1, water=0.1), seed=1)
SEATS = {
    "navigation": ("seeker", "seeker"),
    "gathering": ("gatherer", "gatherer"),
    "battle": ("submission", "fighter", "fighter", "fighter"),
    "capture": ("seeker", "seeker"),
    "royale": ("fighter", "walker", "walker"),
}
SECONDS = {"royale": 60.0}


@pytest.fixture(scope="session")
def record_of_track(tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Path]:
    """Play half a minute of a track on a small map, and return the file of its record."""
    folder = tmp_path_factory.mktemp("records")

    def play(track: str) -> Path:
        path = folder / f"{track}.wsr"
        if not path.exists():
            limit = SECONDS.get(track, 30.0)
            match = Match(MatchSpec(track=track, map=SMALL_MAP, seats=SEATS[track], time_limit=limit, seed=3))
            match.play_out()
            write_record(path, match, [f"{name} {seat}" for seat, name in enumerate(SEATS[track])])
        return path

    return play
