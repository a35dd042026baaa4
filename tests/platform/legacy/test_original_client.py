"""The original's client, unmodified: version 0.0.3, from PyPI."""

import math
import subprocess
from pathlib import Path

import pytest
from tests.commands import run_command
from tests.platform.legacy.helpers.commands import face_to_face, open_way
from tests.platform.legacy.helpers.original import SCRIPTS, environment, install, logs, play
from tests.ports import free_ports

from wildscav_engine.record import read_record, verify_record


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
def test_records_hold_and_have_the_names_that_the_client_gives(installed: Path) -> None:
    if not list(installed.glob("engine/records/*.wsr")):
        play("navigation", installed, open_way(24, map_id=1), [0, 0, 0])
    one, other = sorted(installed.glob("engine/records/*.wsr"))
    assert one.stem.endswith("_speed_5")
    assert other.stem.endswith("_speed_10")
    record = read_record(one)
    assert record.names == ("agent_0",)
    assert verify_record(record).holds
    done = run_command("replay", one, "--no-images", "--out", installed / "one.rrd")
    assert done.returncode == 0, done.stderr
    assert (installed / "one.rrd").stat().st_size > 100_000


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


@pytest.mark.slow
def test_a_client_that_asks_for_what_cannot_be_told_stops_and_its_user_knows_why(installed: Path) -> None:
    crowd = [environment(), SCRIPTS / "crowd.py", installed, str(free_ports())]
    done = subprocess.run(crowd, capture_output=True, text=True, timeout=300)
    assert "KeyboardInterrupt" in done.stderr
    assert done.returncode != 0
    told = [line for line in done.stderr.splitlines() if line.startswith("wildscav: ")]
    assert "it has to ask for fewer agents or supplies" in told[-1]
