"""The original's client, unmodified: version 0.0.3, from PyPI."""

import math
from pathlib import Path

import pytest
from tests.platform.legacy.helpers.commands import face_to_face, open_way
from tests.platform.legacy.helpers.original import install, logs, play


@pytest.fixture(scope="session")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("legacy")
    install(folder, 1, 2)
    return folder


@pytest.mark.slow
def test_navigation(installed: Path) -> None:
    start = open_way(24, map_id=1)
    target = [start[0], start[1], start[2] + 22]
    slow, fast = play("navigation", installed, start, target)
    # 5 m/s for 2 s: 10 m north.
    assert slow[20]["frame"] == 100
    assert slow[20]["z"] - start[2] == pytest.approx(10.0, abs=0.01)
    assert slow[20]["yaw"] == pytest.approx(100.0)
    # 20 m in the 4 s of the time limit are not enough for the target, 40 m are.
    assert (slow[-1]["frame"], len(slow)) == (200, 41)
    last = fast[-1]
    assert last["frame"] < 115
    assert math.dist((last["x"], last["z"]), (target[0], target[2])) <= 1.0
    assert "2 episodes" in logs(installed)


@pytest.mark.slow
def test_gathering_with_a_depth_map_and_a_battle_of_ten_on_another_map(installed: Path) -> None:
    told = play("battle", installed, open_way(10, map_id=1), face_to_face(map_id=2))
    assert told["boxes"] > 10
    assert told["gathered"] > 0
    assert told["frames"] == 300
    assert told["depth"] == [22, 38]
    assert 0 < told["farthest"] <= 100
    # 20 hp a hit, and one shot in 10 frames: 60 hp are gone with the third.
    assert [health for health, _, _ in told["shots"][:5]] == [40, 40, 20, 20, 0]
    assert told["shots"][0] == [40, False, True]
    assert told["shots"][4] == [0, True, True]
    assert told["agents"] == 10
    assert told["ammo"] < 15
    # Back after 10 s with the health of its own set-up, and invincible for 10 s.
    assert told["last"] == [60, True]
