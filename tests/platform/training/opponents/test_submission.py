"""A submission in an environment plays as it plays in a match over gRPC."""

import asyncio
import copy
import pickle
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.helpers.policy_matches import PATIENT
from tests.platform.helpers.seats import ended, host, serving, start_agent

from wildscav.agent import Action
from wildscav.errors import AgentError, UserError
from wildscav.sdk.connection import Connection
from wildscav_engine.envs import SingleEnv, VectorArena
from wildscav_engine.simulation.snapshot import StateError
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_server.match_server import MatchServer
from wildscav_training.opponents import submission

SUBMISSIONS = Path(__file__).parents[4] / "submissions"
SMALL = MapSpec(config=MapConfig(size=40, houses=1), seed=7)
FEW_BOXES = {"waves": [{"center": (0, 0), "radius": 15}], "spacing": 5}
OPTIONS: dict[str, Any] = {"map": SMALL, "supplies": FEW_BOXES, "action_mode": "box", "sensors": {}}
MANIFEST = """name = "{name}"
version = "1.0.0"
entry_point = "agent:Own"
tracks = ["navigation", "battle"]
"""
# Turns by a digest of everything that it was told, so that actions are equal only if all of it was.
WATCHER = """
import zlib
from dataclasses import fields

from wildscav import Action, Agent


def digest(record, without):
    told = {field.name: getattr(record, field.name) for field in fields(record) if field.name not in without}
    readings = [(name, one.dtype.str, one.tobytes()) for name, one in told.pop("tensors", {}).items()]
    return zlib.crc32(repr((told, readings)).encode())


class Own(Agent):
    def reset(self, match):
        self.told = digest(match, {"step_budget", "time_bank"})

    def act(self, observation):
        self.told = zlib.crc32(repr((self.told, digest(observation, {"time_bank"}))).encode())
        told = self.told
        direction, turn, shoot = told % 3600 / 10, told % 97 / 7, told % 3 == 0
        return Action(walk_direction=direction, walk_speed=4.7, turn=turn, shoot=shoot)
"""
SENSORS = """
[sensors.depth]
width = 6
height = 4

[sensors.camera]
width = 8
height = 6

[sensors.visible_agents]
"""


def written(folder: Path, code: str, name: str = "own", manifest: str = MANIFEST, more: str = "") -> Path:
    """Write a submission into a folder."""
    folder.mkdir()
    (folder / "submission.toml").write_text(manifest.format(name=name) + more)
    (folder / "agent.py").write_text(code)
    return folder


def play_here(folders: list[Path]) -> tuple[MatchSpec, list[int], np.ndarray]:
    """Play an episode of an idle learner; return its match, all states' digests and the last actions."""
    players = [submission(folder) for folder in folders]
    env = SingleEnv("battle", time_limit=6.0, opponents=(*players, "fighter"), **OPTIONS)
    env.reset(seed=4)
    batch: Any = env.arena.batch
    digests, over = [], False
    while not over:
        _, _, terminated, truncated, _ = env.step(np.zeros(8, np.float32))
        digests.append(int(batch.state.matches.digest[0]))
        over = terminated or truncated
    return batch.specs[0], digests, env.arena.actions[0].copy()


def play_there(
    tmp_path: Path, spec: MatchSpec, folders: list[Path], sensors: dict[int, Any]
) -> tuple[list[int], np.ndarray]:
    """Play a match over a real server with agents in processes of their own, and an idle one in seat 0."""

    async def test(server: MatchServer, address: str) -> tuple[list[int], np.ndarray]:
        match = await host(server, spec, sensors=sensors, clock=PATIENT)
        agents = []
        for seat, folder in enumerate(folders, start=1):
            class_name = {"hunter": "Hunter", "homing": "Homing"}.get(folder.name, "Own")
            agents.append(await start_agent(f"agent:{class_name}", address, match.tokens[seat], folder))
        async with Connection(address, match.tokens[0], "test") as connection:
            seen = await connection.first()
            while seen is not None:
                seen = await connection.answer(seen.step, Action())
        await asyncio.wait_for(match.task, 120)
        assert [await ended(agent) for agent in agents] == [(0, "")] * len(agents)
        return match.match.digests, match.match.actions_played[-1]

    return serving(tmp_path, test)


def test_agents_do_the_same_as_over_grpc_step_by_step(tmp_path: Path) -> None:
    watcher = written(tmp_path / "watcher", WATCHER, more=SENSORS)
    folders = [SUBMISSIONS / "hunter", watcher, SUBMISSIONS / "homing"]
    spec, here, last_here = play_here(folders)
    assert spec.seats == ("submission",) * 4 + ("fighter",)
    sensors: dict[int, dict[str, dict[str, object]]] = {
        1: {"zone": {}, "teammates": {}},
        2: {"depth": {"width": 6, "height": 4}, "camera": {"width": 8, "height": 6}, "visible_agents": {}},
        3: {"zone": {}, "teammates": {}},
    }
    there, last_there = play_there(tmp_path, spec, folders, sensors)
    assert np.array_equal(last_here[1:4], last_there[1:4])
    assert (last_here[1:4] != 0).any(axis=1).all()
    assert len(there) == 60
    assert here == there


def test_every_row_of_a_vector_has_agents_of_its_own() -> None:
    def played(matches: int, seed: int) -> list[int]:
        opponents = (submission(SUBMISSIONS / "hunter"), submission(SUBMISSIONS / "random"))
        vector = VectorArena("battle", matches, opponents=opponents, time_limit=2.0, **OPTIONS)
        vector.reset(seed=seed)
        digests = []
        for _ in range(30):  # past the end of the first episodes
            vector.step(np.zeros((matches, 8), np.float32))
            assert vector.arena.batch is not None
            digests.append(int(vector.arena.batch.state.matches.digest[-1]))
        return digests

    assert played(3, seed=5) == played(1, seed=7)


def test_a_baseline_is_known_by_its_name() -> None:
    assert submission("hunter").folder == submission("baseline:hunter").folder == SUBMISSIONS / "hunter"
    with pytest.raises(UserError, match=r"there is no baseline 'hunted' .did you mean 'hunter'"):
        submission("baseline:hunted")


def test_modules_of_equal_names_do_not_meet(tmp_path: Path) -> None:
    late = (
        "from wildscav import Action, Agent\nclass Own(Agent):\n    def act(self, _):\n        import speed\n"
    )
    late += "        return Action(walk_speed=speed.SPEED)\n"
    folders = [written(tmp_path / name, late) for name in ("one", "two")]
    for folder, speed in zip(folders, (3.0, 5.0), strict=True):
        (folder / "speed.py").write_text(f"SPEED = {speed}\n")
    path = list(sys.path)
    env = SingleEnv("battle", opponents=[submission(folder) for folder in folders], **OPTIONS)
    env.reset(seed=0)
    env.step(np.zeros(8, np.float32))
    assert env.arena.actions[0, 1:, 1].tolist() == [3.0, 5.0]
    assert not {"agent", "speed"} & sys.modules.keys()
    assert sys.path == path


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))])  # noqa: S301
def test_a_copy_loads_the_submission_anew(copied: Any) -> None:
    first = submission(SUBMISSIONS / "hunter")
    env = SingleEnv("battle", opponents=(first,), **OPTIONS)
    env.reset(seed=0)
    again = copied(first)
    assert (again.folder, again.name) == (first.folder, "hunter")
    other = SingleEnv("battle", opponents=(again,), **OPTIONS)
    other.reset(seed=0)
    for each in (env, other):
        each.step(np.zeros(8, np.float32))
    assert np.array_equal(env.arena.actions, other.arena.actions)


def test_a_state_does_not_hold_the_memory_of_agents() -> None:
    env = SingleEnv("battle", opponents=(submission(SUBMISSIONS / "hunter"),), **OPTIONS)
    env.reset(seed=0)
    with pytest.raises(StateError, match="'hunter' has a memory of its own"):
        env.get_state()


@pytest.mark.parametrize(
    ("folder", "message"),
    [
        ("huntr", "huntr does not exist .did you mean 'hunter'..: give a folder with a submission.toml"),
        ("hunter/agent.py", "agent.py is not a folder"),
        (".", "submission.toml is missing"),
    ],
)
def test_what_is_not_a_submission_is_refused(folder: str, message: str) -> None:
    with pytest.raises(UserError, match=message):
        submission(SUBMISSIONS / folder)


@pytest.mark.parametrize(
    ("manifest", "code", "message"),
    [
        (MANIFEST.replace("entry_point", "command").replace('"agent:Own"', '["node"]'), "", "has a command"),
        (MANIFEST.replace('entry_point = "agent:Own"', ""), "", "entry_point: is missing"),
        (MANIFEST, "import nothing_of_this_name", "cannot be imported: ModuleNotFoundError"),
        (MANIFEST, "", "has no class Own"),
        (MANIFEST + 'interface = "words"\n', "class Own: ...", "here, agents must play by numbers"),
        (MANIFEST + "model = true\n", "class Own: ...", "model: is true; here, agents cannot ask a language"),
        (MANIFEST + "[sensors.sonar]\n", "class Own: ...", "sensors: "),
    ],
)
def test_a_submission_that_cannot_play_here_is_refused(
    tmp_path: Path, manifest: str, code: str, message: str
) -> None:
    with pytest.raises(UserError, match=message) as refused:
        submission(written(tmp_path / "own", code, manifest=manifest))
    assert "\n" not in str(refused.value)
    assert "agent" not in sys.modules


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("return 1 / 0", r"own failed in act \(match 0, seat 1\): ZeroDivisionError: division by zero"),
        ("return None", r"Own.act\(\) must return an Action, .* and returned None"),
    ],
)
def test_errors_of_an_agent_name_it(tmp_path: Path, body: str, message: str) -> None:
    code = f"from wildscav import Agent\nclass Own(Agent):\n    def act(self, _):\n        {body}\n"
    env = SingleEnv("battle", opponents=(submission(written(tmp_path / "own", code)),), **OPTIONS)
    env.reset(seed=0)
    with pytest.raises(AgentError, match=message):
        env.step(np.zeros(8, np.float32))


def test_the_old_name_of_the_package_still_works_and_warns() -> None:
    with pytest.warns(DeprecationWarning, match="is called wildscav_training.opponents now"):
        from wildscav.opponents import submission as moved
    assert moved is submission
