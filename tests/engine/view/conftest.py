from pathlib import Path

import pytest

from wildscav_engine.record import Record, record_of, resimulate
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.view import write_replay
from wildscav_engine.view.recording.history import History, collect_history

SMALL_MAP = MapSpec(config=MapConfig(size=60, houses=1, water=0.1), seed=1)
ROBOTS = {
    "battle": ("submission", "fighter", "fighter"),
    "gathering": ("gatherer",),
    "navigation": ("walker",),
    "royale": ("fighter", "fighter"),
}


def robots_play(track: str) -> Record:
    """Ten seconds on a small map; the seat of the submission stands still."""
    match = Match(MatchSpec(track=track, map=SMALL_MAP, seats=ROBOTS[track], time_limit=10.0, seed=3))
    match.play_out()
    return record_of(match, [f"{name} {seat}" for seat, name in enumerate(match.spec.seats)])


@pytest.fixture(scope="package")
def battle() -> Record:
    return robots_play("battle")


@pytest.fixture(scope="package")
def battle_file(battle: Record, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("replay") / "battle.rrd"
    write_replay(battle, path, follow=1)
    return path


@pytest.fixture(scope="package")
def bare_files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """A replay without images of each track."""
    folder = tmp_path_factory.mktemp("bare")
    for track in ROBOTS:
        write_replay(robots_play(track), folder / f"{track}.rrd", images=False)
    return {track: folder / f"{track}.rrd" for track in ROBOTS}


@pytest.fixture(scope="package")
def seen(battle: Record) -> History:
    """The battle, with what seat 1 sees."""
    return collect_history(resimulate(battle), battle.steps, images_of=1)[1]
