"""``wildscav init --from-policy``: layers and ONNX; models of Stable-Baselines3 have a test of their own."""

import asyncio
import json
import tomllib
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from tests.engine.envs.common import OPEN
from tests.platform.helpers.policy_matches import assert_same, play_env, play_match, write_layers
from tests.platform.helpers.seats import ended, host, serving, start_agent
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.policy import Policy
from wildscav_engine.envs import SingleEnv, describe
from wildscav_server.match_server import MatchServer

SENSORS: dict[str, Any] = {"depth": {"width": 3, "height": 2}}
SHORT: dict[str, Any] = {"map": OPEN, "time_limit": 1.0, "sensors": SENSORS, "flat": True}
WIDTH = 3 + 3 + 6 + 3 + 2 + 8 + 9 + 3 * 2
DEPTH = 'sensors={"depth": {"width": 3, "height": 2}}'
OUTPUTS = {"multidiscrete": 9 + 2 + 7 + 5 + 2, "baseline": 8, "box": 5}


def layers(path: Path, inputs: int = WIDTH, outputs: int = 25, **more: Any) -> Path:
    return write_layers(path, inputs, 16, outputs, **more)


def init(*arguments: str | Path) -> Any:
    return CliRunner().invoke(app, ["init", *map(str, arguments)])


def made(model: Path, folder: Path, *arguments: str) -> Path:
    done = init(folder, "--from-policy", model, "--track", "navigation", "--option", DEPTH, *arguments)
    assert done.exit_code == 0, (done.output, done.exception)
    return folder


@pytest.mark.parametrize("choose", ["sampled", "deterministic"])
@pytest.mark.parametrize("mode", OUTPUTS)
def test_what_the_submission_does_is_what_the_policy_does_in_the_environment(
    mode: str, choose: str, tmp_path: Path
) -> None:
    """The same observations, choices and match: the policy plays in the environment, then over the wire."""
    more = {"log_std": np.full(5, -1.0)} if mode == "box" else {}
    model = layers(tmp_path / "model.npz", outputs=OUTPUTS[mode], **more)
    folder = made(model, tmp_path / "agent", "--choose", choose)
    env = SingleEnv("navigation", action_mode=mode, **SHORT)
    seed_of_match = []
    first = play_env(env, seed=3)  # only to have the match, whose private seed the agent draws by

    policy, random = Policy(folder), np.random.default_rng(0)

    def choose_in_env(row: Any) -> Any:
        choice = policy.chooser(policy.network(row), random)
        return choice[0] if mode == "baseline" else choice

    manifest = tomllib.loads((folder / "submission.toml").read_text())
    agent = Policy(folder)
    told, chosen = [], []

    def begin(match: Any) -> None:
        seed_of_match.append(match.seed)
        agent.begin(match)
        observe, choices = agent.environment.observe, agent.environment.action

        def telling(seen: Any) -> Any:
            told.append(observe(seen))
            return told[-1]

        def choosing(choice: Any, seen: Any) -> Any:
            chosen.append(np.asarray(choice).tolist())
            return choices(choice, seen)

        agent.environment.observe = telling  # type: ignore[method-assign]
        agent.environment.action = choosing  # type: ignore[method-assign]

    play_match(tmp_path, first.spec, manifest["sensors"], begin, agent.act)
    random = np.random.default_rng(seed_of_match[0])
    played = play_env(env, seed=3, choose=choose_in_env)
    assert [np.ravel(choice).tolist() for choice in played.choices] == chosen
    for ours, theirs in zip(told, played.observations, strict=True):
        assert_same(ours, theirs)


@pytest.mark.parametrize(("inputs", "version"), [(WIDTH - 9, 0), (WIDTH, 1)])
def test_the_version_of_the_observations_is_told_by_the_shape(
    inputs: int, version: Literal[0, 1], tmp_path: Path
) -> None:
    folder = made(layers(tmp_path / "model.npz", inputs=inputs), tmp_path / "agent")
    description = json.loads((folder / "policy.json").read_text())["environment"]
    env = SingleEnv("navigation", action_mode="multidiscrete", version=version, **SHORT)
    assert description == json.loads(json.dumps(describe(env.config)))


def test_the_folder_plays_as_an_agent_in_a_process_of_its_own(tmp_path: Path) -> None:
    folder = made(layers(tmp_path / "model.npz"), tmp_path / "my-walker")
    manifest = tomllib.loads((folder / "submission.toml").read_text())
    assert (manifest["name"], manifest["tracks"]) == ("my-walker", ["navigation"])
    spec = play_env(SingleEnv("navigation", action_mode="box", **SHORT), seed=3).spec

    async def test(server: MatchServer, address: str) -> tuple[int | None, str]:
        match = await host(server, spec, sensors={0: manifest["sensors"]})
        agent = await start_agent(manifest["entry_point"], address, match.seats[0].token, folder)
        told = await ended(agent)
        await asyncio.wait_for(match.task, 60)
        return told

    assert serving(tmp_path, test) == (0, "")


def test_several_observations_at_once_are_told_by_the_shape(tmp_path: Path) -> None:
    folder = made(layers(tmp_path / "model.npz", inputs=3 * WIDTH), tmp_path / "agent")
    policy = Policy(folder)
    stack: Any = policy.environment._stack
    first = stack.push(np.ones(2, np.float32))
    assert first.tolist() == [0, 0, 0, 0, 1, 1]  # as VecFrameStack of Stable-Baselines3
    assert stack.push(np.full(2, 5, np.float32)).tolist() == [0, 0, 1, 1, 5, 5]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "--track is missing: name the track that the policy was trained for"),
        (["--track", "chess"], "track is 'chess'; the tracks are navigation"),
        (["--track", "navigation"], "takes 40 numbers; the environment with these options returns body"),
        (["--track", "battle"], "returns 25 numbers, which does not fit the track battle with action_mode"),
        (["--track", "navigation", "--option", "speed=9"], "unexpected keyword argument 'speed'; the"),
        (["--track", "navigation", "--option", "sensors"], "--option is 'sensors', must be NAME=VALUE"),
        (["--track", "navigation", "--choose", "best"], "--choose is 'best', must be sampled or"),
        (["--track", "navigation", "--activation", "wave"], "--activation is 'wave', must be one of"),
        (["--option", "preset=paper-navigation"], "takes 40 numbers; the environment with these options"),
    ],
)
def test_what_does_not_fit_is_said_and_nothing_is_written(
    arguments: list[str], message: str, tmp_path: Path
) -> None:
    done = init(tmp_path / "agent", "--from-policy", layers(tmp_path / "model.npz"), *arguments)
    assert message in str(done.exception)
    assert done.exception.exit_code == 2  # type: ignore[union-attr]
    assert not (tmp_path / "agent").exists()


@pytest.mark.parametrize("option", ["--track", "--option", "--choose", "--activation"])
def test_without_a_policy_its_options_are_refused(option: str, tmp_path: Path) -> None:
    done = init(tmp_path / "agent", option, "x")
    assert str(done.exception) == "--track, --option, --choose and --activation are for --from-policy"
    assert not (tmp_path / "agent").exists()


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("gone.npz", None, "is not a file"),
        ("model.txt", b"", "ends in .txt; models end in .zip, .onnx, .npz"),
        ("model.npz", b"no arrays", "holds no layers"),
    ],
)
def test_a_file_that_is_no_model_is_refused(
    name: str, content: bytes | None, message: str, tmp_path: Path
) -> None:
    if content is not None:
        (tmp_path / name).write_bytes(content)
    done = init(tmp_path / "agent", "--from-policy", tmp_path / name, "--track", "navigation")
    assert message in str(done.exception)


@pytest.mark.parametrize("whole", [False, True], ids=["scores", "choices"])
def test_an_onnx_network_plays(whole: bool, tmp_path: Path) -> None:
    """One that gives scores, and one that gives the choice itself, in whole numbers."""
    onnx = pytest.importorskip("onnx")
    pytest.importorskip("onnxruntime")
    weights = np.random.default_rng(0).normal(size=(WIDTH, 8)).astype(np.float32)
    helper, kinds = onnx.helper, onnx.TensorProto
    nodes = [helper.make_node("MatMul", ["row", "weights"], ["scores"])]
    if whole:
        nodes.append(helper.make_node("ArgMax", ["scores"], ["choice"], axis=1))
    output = helper.make_tensor_value_info(
        "choice" if whole else "scores", kinds.INT64 if whole else kinds.FLOAT, ["batch", 1 if whole else 8]
    )
    graph = helper.make_graph(
        nodes,
        "policy",
        [helper.make_tensor_value_info("row", kinds.FLOAT, ["batch", WIDTH])],
        [output],
        [onnx.numpy_helper.from_array(weights, "weights")],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8)
    onnx.save(model, tmp_path / "model.onnx")
    mode = ["--option", "action_mode=baseline"] if whole else []
    folder = made(tmp_path / "model.onnx", tmp_path / "agent", "--choose", "deterministic", *mode)
    assert (folder / "requirements.txt").read_text() == "onnxruntime>=1.20\n"
    policy, env = Policy(folder), SingleEnv("navigation", action_mode="baseline", **SHORT)
    for row in play_env(env, seed=3).observations:
        choice = policy.chooser(policy.network(row), np.random.default_rng(0))
        assert choice.tolist() == [int(np.argmax(row @ weights))]
