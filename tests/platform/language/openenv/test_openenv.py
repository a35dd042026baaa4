"""Seats as environments of OpenEnv: its client plays over its server, and mistakes cost nobody else."""

import base64
import runpy
import threading
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("openenv", reason="needs OpenEnv, in an environment of its own: make test-openenv")

import httpx
import uvicorn
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect
from tests.end_to_end.pages import ROOT, blocks, run_code

from wildscav.errors import UserError
from wildscav_engine.record import read_record, verify_record
from wildscav_language.openenv.app import make_app
from wildscav_language.openenv.client import WildscavEnv
from wildscav_language.openenv.environment import WildscavEnvironment
from wildscav_language.openenv.host import Host, _ended
from wildscav_language.openenv.models import WildscavAction, WildscavObservation

SMALL = {"map": 103, "time_limit": 20.0}  # 100 m


def call(tool: str, **arguments: Any) -> WildscavAction:
    return WildscavAction(tool=tool, arguments=arguments)


TO_TARGET = call("go", place="target", seconds=20.0)


@pytest.fixture(scope="module")
def records(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("records")


@pytest.fixture(scope="module")
def url(records: Path) -> Iterator[str]:
    """A server that keeps records."""
    app = make_app(records=records)
    server = uvicorn.Server(uvicorn.Config(app, port=0, log_level="warning"))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive()
            thread.join(0.02)
        yield f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
    finally:
        server.should_exit = True
        thread.join()


@pytest.fixture(scope="module")
def host() -> Iterator[Host]:
    host = Host()
    yield host
    host.close()


@pytest.fixture
def environment(host: Host) -> WildscavEnvironment:
    return WildscavEnvironment(host)


def played(url: str, **options: Any) -> tuple[list[str], list[Any], Any]:
    """Walk to the target; return the texts, the rewards and the last state."""
    texts, rewards = [], []
    with WildscavEnv(base_url=url).sync() as client:
        result = client.reset(**SMALL, **options)
        while not result.done:
            texts.append(result.observation.text)
            result = client.step(TO_TARGET)
            rewards.append(result.reward)
        return [*texts, result.observation.text], rewards, client.state()


def test_the_official_client_reaches_the_target(url: str, records: Path) -> None:
    texts, rewards, state = played(url, seed=3, episode_id="first")

    assert "Reach the target" in texts[0]
    assert "Target: " in texts[0]
    assert texts[-1] == state.ending == "The match is over, because of goal."
    assert state.options["seed"] == 3
    assert state.record.startswith("first-")
    record = read_record(records / state.record)
    assert record.spec.clock == "paused"
    assert verify_record(record).holds
    at_start = -record.result.seats[0].metrics["time"] - sum(rewards)
    assert -20.0 < at_start < 0.0, "the punish time for the way to the target"


def test_the_same_seed_and_calls_give_the_same_episode(url: str) -> None:
    first, second = (played(url, seed=5, episode_id="same") for _ in range(2))
    assert first[:2] == second[:2]
    assert first[2].record != second[2].record, "neither has overwritten the other"
    assert played(url, seed=6)[0] != first[0]


def test_sessions_play_at_once_and_a_silent_one_costs_nobody_else(url: str) -> None:
    with WildscavEnv(base_url=url).sync() as silent:
        begun = silent.reset(track="gathering", seed=1, **SMALL)
        assert played(url, seed=3)[2].ending == "The match is over, because of goal."
        with WildscavEnv(base_url=url).sync() as other:
            other.reset(track="gathering", seed=1, **SMALL)
            with ThreadPoolExecutor() as pool:
                walk = call("explore", seconds=5.0, stop_for=[])
                results = list(pool.map(lambda client: client.step(walk), (silent, other)))
    assert begun.observation.metadata["steps"] == 0
    assert results[0].observation == results[1].observation
    assert results[0].observation.metadata["seconds"] == 5.0


def test_a_client_that_says_nothing_loses_its_own_seat(tmp_path: Path) -> None:
    host = Host(tmp_path, idle_limit=0.3)
    try:
        silent = WildscavEnvironment(host)
        silent.reset(seed=1, episode_id="silent", **SMALL)
        host._do(_ended(silent._episode))
        ended = silent.step(TO_TARGET)
    finally:
        host.close()
    assert ended.done
    assert ended.text.startswith("The match is over, because of time up. Your seat was closed: ")
    (record,) = tmp_path.glob("silent-*.wsr")
    assert read_record(record).result.ending == "time_up"


def test_a_connection_that_says_nothing_makes_room_for_another() -> None:
    with TestClient(make_app(sessions=1, idle_limit=0.1)) as client:
        for _ in range(2):
            with client.websocket_connect("/ws") as socket, pytest.raises(WebSocketDisconnect) as closed:
                socket.receive_text()  # not that the server has no room
            assert closed.value.code == 1000


@pytest.mark.parametrize("path", ["/reset", "/step", "/mcp"])
def test_matches_are_played_over_websockets_alone(url: str, path: str) -> None:
    assert httpx.get(f"{url}/health").json() == {"status": "healthy"}
    assert httpx.post(url + path, json={}).status_code == 404


def test_a_client_is_told_why_a_match_has_no_record_and_a_host_that_closes_ends_its_matches(
    tmp_path: Path,
) -> None:
    host = Host(tmp_path / "records")
    (tmp_path / "records").rmdir()
    environment = WildscavEnvironment(host)
    environment.reset(map=103, time_limit=1.0)
    ended = environment.step(call("wait_until", seconds=9.0))
    environment.reset(**SMALL)
    task = environment._episode.task
    host.close()
    environment.close()
    assert ended.text.endswith("because of time up. It has no record: No such file or directory.")
    assert task.done()


@pytest.mark.parametrize(
    ("action", "said"),
    [
        (
            call("fly"),
            "There is no tool 'fly' here; the tools are look_around, turn, go, explore,",
        ),
        (call("go", place="target", seconds=1e9), "go refuses seconds 1000000000.0"),
        (call("go", place="target", speed=3), "It takes bearing, box, place, seconds, stop_for."),
        (call("go", place="Atlantis"), "There is no such place; known places are"),
    ],
)
def test_a_bad_call_costs_time_and_is_told_what_is_allowed(
    environment: WildscavEnvironment, action: WildscavAction, said: str
) -> None:
    environment.reset(seed=3, **SMALL)
    refused = environment.step(action)
    assert said in refused.text
    assert (refused.ended, refused.done) == ("refused", False)
    assert refused.reward == pytest.approx(-0.5), "the time that it cost"
    assert refused.metadata["seconds"] == 0.5
    assert (refused.metadata["calls"], refused.metadata["refused"]) == (1, 1)


def test_what_is_called_at_the_wrong_time_is_told_what_to_call(url: str) -> None:
    with WildscavEnv(base_url=url).sync() as client:
        with pytest.raises(RuntimeError, match="No match has begun: call reset first"):
            client.step(TO_TARGET)
        client.reset(seed=3, map=103, time_limit=1.0)
        assert client.step(call("wait_until", seconds=9.0)).done
        with pytest.raises(RuntimeError, match="The match is over: call reset to begin another"):
            client.step(TO_TARGET)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"track": "chess"}, "the tracks are navigation"),
        ({"clients": 2}, "reset takes track, level, map"),
        ({"others": ["mallory"]}, "the robots are"),
        ({"episode_id": "../../etc/passwd"}, "episode_id"),
    ],
)
def test_a_match_that_does_not_exist_is_refused(
    environment: WildscavEnvironment, options: dict[str, Any], said: str
) -> None:
    environment.reset(seed=3, **SMALL)
    with pytest.raises(UserError, match=said):
        environment.reset(**options)
    assert not environment.step(call("look_around")).done, "the match before goes on"


def test_the_reward_is_what_the_seat_gathers(environment: WildscavEnvironment) -> None:
    observation = environment.reset(seed=2, track="gathering", others=["homing"], map=103, time_limit=30.0)
    gathered = 0.0
    while not observation.done:
        observation = environment.step(call("explore", seconds=20.0, stop_for=[]))
        gathered += observation.reward
    assert gathered == observation.metadata["score"] > 0


def test_observations_have_a_picture_if_the_reset_asks_for_it(environment: WildscavEnvironment) -> None:
    seen: WildscavObservation = environment.reset(seed=3, pictures=True, **SMALL)
    assert base64.b64decode(seen.picture or "").startswith(b"\x89PNG")
    later = environment.step(call("turn", right=90.0))
    assert later.picture not in (None, seen.picture)
    assert [tool.name for tool in seen.tools] == ["look_around", "turn", "go", "explore", "wait_until"]
    assert not later.tools


def test_the_lines_of_the_page_reach_the_target(url: str, tmp_path: Path) -> None:
    (code,) = blocks(ROOT / "docs" / "mcp.md", "python")
    said = run_code(code.replace("http://127.0.0.1:8000", url), tmp_path)
    assert said.endswith("The match is over, because of goal.\n")


def test_the_example_rewards_whom_its_tools_lead_to_the_target(url: str) -> None:
    """What TRL does with it is not tested here, since TRL and PyTorch are large."""
    example = runpy.run_path(str(ROOT / "docs" / "examples" / "openenv_trl.py"))
    navigation = example["Navigation"](url)
    rewards = []
    for name, arguments in example["CALLS"][:-1]:  # the last is no tool
        assert "Target: " in navigation.reset(seed=4)
        before = getattr(navigation, name)(**arguments)
        assert "ended after" in before or "The match is over" in before
        rewards.append(navigation.get_reward())
    assert max(rewards) == rewards[0] > -5.0
    assert max(rewards[1:]) < -15.0


def test_openenvs_own_command_accepts_the_manifest() -> None:
    from openenv.cli.__main__ import app
    from typer.testing import CliRunner

    folder = ROOT / "platform" / "wildscav_language" / "openenv"
    done = CliRunner().invoke(app, ["validate", str(folder), "--level", "static", "--skip-build"])
    assert "Verdict: PASS" in done.output, done.output
