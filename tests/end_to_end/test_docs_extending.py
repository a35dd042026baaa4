"""What the page of extensions says is true: its packages, built and installed, play, measure and record."""

import json
import os
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks

ROOT = Path(__file__).parents[2]
EXAMPLES = ROOT / "docs" / "examples"
AGENT = """\
from wildscav import Action, Agent


class Climber(Agent):
    def act(self, observation):
        (others,), (walked,) = observation.sensor("crowd"), observation.sensor("odometer")
        assert others >= 0.0 and walked >= 0.0
        assert walked > 0.0 or observation.frame < 50
        return Action(walk_direction=0.0, walk_speed=8.0)
"""
MANIFEST = """\
name = "climber"
version = "1.0.0"
entry_point = "agent:Climber"
tracks = ["summit"]

[sensors.crowd]
radius = 20.0

[sensors.odometer]
"""
ENVIRONMENTS = """\
import gymnasium, numpy as np
import wildscav_engine
from wildscav_engine.sensors import parse_sensor
from wildscav_engine.simulation.match import Match
from wildscav_engine.envs.registry import env_id
from wildscav_server.hosting.precompile import every_sensor

sensors = {"crowd": {"radius": 20.0}, "odometer": {}}
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
where = {"map": MapSpec(config=MapConfig(size=60, houses=0, relief=0, vegetation=0), seed=3)}
ahead = {"walk_direction": 180.0, "walk_speed": 8.0}
env = gymnasium.make(env_id("summit"), sensors=sensors, **where)
space = env.observation_space
assert set(sensors) < set(space.spaces), space
observation, _ = env.reset(seed=1)
action = {name: np.asarray(ahead.get(name, 0), part.dtype).reshape(part.shape)
          for name, part in env.action_space.spaces.items()}
paid = 0.0
for _ in range(20):
    observation, reward, *_ = env.step(action)
    paid += reward
assert space.contains(observation)
assert observation["odometer"][0] > 1.0, observation["odometer"]
assert abs(paid - 0.1 * observation["odometer"][0]) < 1e-3


many = gymnasium.make_vec(env_id("summit"), num_envs=3, sensors=sensors, **where)
many.reset(seed=1)
stacked = {name: np.stack([part] * 3) for name, part in action.items()}
for _ in range(20):
    observations, *_ = many.step(stacked)
assert observations["odometer"][:, 0].max() > 1.0
assert observations["crowd"].shape == (3, 1)
default = gymnasium.make(env_id("summit"), **where)
assert "odometer" in default.observation_space.spaces
flat = gymnasium.make(env_id("summit"), flat=True, **where)
assert flat.reset(seed=1)[0].ndim == 1

from wildscav_engine.envs.parallel import parallel_env
together = parallel_env(track="summit", sensors=sensors, **where)
assert len(together.reset(seed=1)[0]) == 2
assert {"crowd", "odometer"} <= {sensor.name for sensor in every_sensor()}
print("played")
"""


def test_the_entry_points_that_the_page_shows_are_those_of_the_hills() -> None:
    def entry_points(text: str) -> dict[str, dict[str, str]]:
        return tomllib.loads(text)["project"]["entry-points"]

    (shown,) = blocks(ROOT / "docs" / "extending.md", "toml")
    of_hills = entry_points((EXAMPLES / "hills" / "pyproject.toml").read_text("utf-8"))
    for group, named in entry_points(shown).items():
        assert named.items() <= of_hills[group].items()


def install(project: Path, target: Path) -> None:
    """Build a package as its author would, and unpack it as an installer would."""
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(project / "dist")]
    subprocess.run(build, cwd=project, check=True, capture_output=True)
    (wheel,) = (project / "dist").glob("*.whl")
    zipfile.ZipFile(wheel).extractall(target)


def run(target: Path, command: list[object], **options: object) -> "subprocess.CompletedProcess[str]":
    environment = {**os.environ, "PYTHONPATH": str(target), "COLUMNS": "200"}
    return subprocess.run(  # type: ignore[call-overload, no-any-return]
        [str(part) for part in command],
        capture_output=True,
        text=True,
        env=environment,
        timeout=600,
        **options,
    )


def wildscav(target: Path, *arguments: object, **options: object) -> "subprocess.CompletedProcess[str]":
    return run(target, [Path(sys.executable).parent / "wildscav", *arguments], **options)


@pytest.fixture(scope="module")
def pages(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The packages of the page, and an agent that wants their sensors."""
    folder = tmp_path_factory.mktemp("pages")
    for name in ("hills", "orbit"):
        shutil.copytree(EXAMPLES / name, folder / name)
    (folder / "climber").mkdir()
    (folder / "climber/agent.py").write_text(AGENT)
    (folder / "climber/submission.toml").write_text(MANIFEST)
    return folder


@pytest.fixture(scope="module")
def hills(pages: Path) -> Path:
    """A folder in which the package of the hills is installed."""
    install(pages / "hills", pages / "site")
    return pages / "site"


@pytest.fixture(scope="module")
def evaluated(pages: Path, hills: Path) -> Path:
    """The output of an evaluation on the package's suite, in its sandbox."""
    out = pages / "out"
    done = wildscav(
        hills,
        *("evaluate", pages / "climber", "--suite", "hills", "--sandbox", "trusting"),
        *("--out", out, "--replays", "first", "--workers", "1"),
        cwd=pages,
    )
    assert done.returncode == 0, done.stderr
    return out


@pytest.mark.slow
def test_environments_know_the_track_its_rewards_and_the_sensors(hills: Path) -> None:
    done = run(hills, [sys.executable, "-c", ENVIRONMENTS])
    assert done.returncode == 0, done.stderr
    assert done.stdout.endswith("played\n")


@pytest.mark.slow
def test_an_evaluation_plays_the_suite_in_the_sandbox_and_measures_what_it_asks_for(evaluated: Path) -> None:
    results = json.loads((evaluated / "results.json").read_text())
    (evaluation,) = results["evaluations"]

    assert results["suite"] == "hills@1.0"
    assert results["sandbox"] == "trusting"
    assert [metric["name"] for metric in evaluation["metrics"]] == ["height", "walked", "pace"]
    assert [row["status"] for row in evaluation["matches"]] == ["finished", "finished"]
    for row in evaluation["matches"]:
        assert row["metrics"]["walked"] > 1.0
        assert row["metrics"]["pace"] == pytest.approx(row["metrics"]["walked"] / 3.0)
    assert evaluation["summary"]["pace"]["mean"] > 0.3
    assert list((evaluated / "replays").iterdir())


@pytest.mark.slow
def test_records_hold_and_give_the_same_metrics_again(hills: Path, evaluated: Path) -> None:
    rescored = wildscav(hills, "verify", evaluated, "--workers", "1")
    assert rescored.returncode == 0, rescored.stderr
    assert "pace" in rescored.stdout


@pytest.mark.slow
def test_without_the_package_a_record_says_what_is_missing(evaluated: Path, tmp_path: Path) -> None:
    (record, *_) = sorted((evaluated / "records").iterdir())
    done = wildscav(tmp_path, "verify", record)
    assert done.returncode == 1
    assert "track is 'summit'; the tracks are navigation, gathering" in done.stderr + done.stdout
    assert "Traceback" not in done.stderr


@pytest.mark.slow
def test_a_match_can_be_played_on_the_track(pages: Path, hills: Path, tmp_path: Path) -> None:
    record = tmp_path / "match.wsrec"
    done = wildscav(
        hills,
        *("play", pages / "climber", "--sandbox", "process", "--time-limit", "2", "--size", "60"),
        *("--record", record, "--json"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    played = json.loads(done.stdout)
    assert played["track"] == "summit"
    assert set(played["seats"][0]["metrics"]) == {"height", "walked"}
    assert record.exists()


ORBIT = """\
from pathlib import Path
import numpy as np
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.record import read_record, verify_record, write_record

game_map = MapSpec(config=MapConfig(size=60, houses=0, relief=0), seed=3)
seats = ("orbiter", "orbiter-hard", "fighter", "walker", "submission")
spec = MatchSpec(track="battle", map=game_map, seats=seats, time_limit=4, seed=1)
match = Match(spec)
match.play_out()
walked = match.state.agents.walked[0]
assert (walked[:4] > 1.0).all() and walked[4] == 0.0, walked
turns = np.array(match.actions_played)[:, :, 2]
assert np.median(turns[:, 0]) == 2.0, turns[:, 0]
record = Path("orbit.wsr")
write_record(record, match, seats)
assert verify_record(read_record(record)).holds
plain = Match(spec.model_copy(update={"seats": ("fighter", "walker", "gatherer", "seeker", "submission")}))
plain.play_out()
print(plain.digest, match.state.agents.robot[0].tolist())
"""
PLAIN = """\
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec

game_map = MapSpec(config=MapConfig(size=60, houses=0, relief=0), seed=3)
seats = ("fighter", "walker", "gatherer", "seeker", "submission")
match = Match(MatchSpec(track="battle", map=game_map, seats=seats, time_limit=4, seed=1))
match.play_out()
print(match.digest)
"""


@pytest.mark.slow
def test_a_robot_is_compiled_into_the_simulation_and_changes_no_other(pages: Path, tmp_path: Path) -> None:
    target = tmp_path / "site"
    install(pages / "orbit", target)

    done = run(target, [sys.executable, "-c", ORBIT], cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    alone = run(tmp_path, [sys.executable, "-c", PLAIN])
    assert alone.returncode == 0, alone.stderr
    assert done.stdout.split()[0] == alone.stdout.strip()


@pytest.fixture
def clashing(tmp_path: Path) -> Path:
    """A folder with a package that adds a track under the name of one of ours."""
    info = tmp_path / "clash-0.5.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: clash\nVersion: 0.5\n")
    (info / "entry_points.txt").write_text("[wildscav.tracks]\nbattle = clash:Battle\n")
    return tmp_path


def test_a_command_names_the_package_that_it_cannot_use(clashing: Path) -> None:
    done = wildscav(clashing, "play", "random")
    assert done.returncode == 1
    assert done.stderr == (
        "wildscav: the package clash 0.5 adds a track 'battle', but Wildscav has one of that name; "
        "uninstall the package; `wildscav doctor` lists what is installed\n"
    )


@pytest.mark.slow
def test_the_doctor_lists_what_is_installed(hills: Path, clashing: Path) -> None:
    done = wildscav(hills, "doctor", "--json")
    added = json.loads(done.stdout)["extensions"]
    assert {one["name"] for one in added} == {"summit", "crowd", "odometer", "pace", "trusting", "hills"}
    assert {one["problem"] for one in added} == {""}

    broken = wildscav(clashing, "doctor", "--json")
    assert broken.returncode == 1
    assert "the package clash 0.5 adds a track 'battle'" in broken.stderr
