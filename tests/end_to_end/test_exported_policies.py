"""Models of Stable-Baselines3 as submissions: they choose as the model itself does in the environment."""

import json
import signal
import time
from pathlib import Path
from typing import Any

import httpx
import numpy as np
import pytest
from tests.commands import running
from tests.end_to_end.pages import blocks, run_line
from tests.engine.envs.common import OPEN
from tests.leaderboard.seasons_made import make_season
from tests.platform.helpers.policy_matches import observed, play_env
from tests.ports import free_ports
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.policy import Policy
from wildscav_engine.envs import SingleEnv, describe

pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

SHORT: dict[str, Any] = {"map": OPEN, "time_limit": 2.0}
FLAT: dict[str, Any] = {"flat": True, "sensors": {"depth": {"width": 4, "height": 3}}}
SMALL = '--option=sensors={"depth": {"width": 4, "height": 3}}'
CAMERA: dict[str, Any] = {"sensors": {"camera": {"width": 36, "height": 36}}}
PICTURES = '--option=sensors={"camera": {"width": 36, "height": 36}}'
DOCS = Path(__file__).parents[2] / "docs"
PATIENCE = 600  # looks at a season that plays
BUFFER = {"learning_starts": 20, "buffer_size": 500}


def wait_for(address: str) -> None:
    """Wait until a site answers."""
    for _ in range(PATIENCE):
        try:
            httpx.get(f"{address}/health", trust_env=False)
        except httpx.TransportError:
            time.sleep(0.1)
        else:
            return
    raise AssertionError(address)


@pytest.fixture(autouse=True)
def one_thread() -> None:
    pytest.importorskip("stable_baselines3")
    pytest.importorskip("torch").set_num_threads(1)


def export(model: Any, tmp_path: Path, *options: str) -> Policy:
    """Save a model that chooses the likeliest, and make a submission of it."""
    model.save(tmp_path / "model.zip")
    arguments = ["--from-policy", str(tmp_path / "model.zip"), "--track", "navigation", *options]
    done = CliRunner().invoke(app, ["init", str(tmp_path / "agent"), "--choose", "deterministic", *arguments])
    assert done.exit_code == 0, (done.output, done.exception)
    return Policy(tmp_path / "agent")


def learned(algorithm: str, policy: str, envs: Any, **more: Any) -> Any:
    import stable_baselines3

    model = getattr(stable_baselines3, algorithm)(policy, envs, device="cpu", seed=0, **more)
    return model.learn(64)


def same_choice(model: Any, policy: Policy, observation: Any, stacked: Any) -> None:
    expected, _ = model.predict(stacked, deterministic=True)
    chosen = policy.chooser(policy.network(observation), np.random.default_rng(0))
    np.testing.assert_allclose(chosen, np.ravel(expected), atol=1e-5)


@pytest.mark.parametrize(
    ("algorithm", "mode", "more"),
    [
        ("PPO", "multidiscrete", {"n_steps": 32}),
        ("PPO", "box", {"n_steps": 32}),
        ("A2C", "baseline", {"policy_kwargs": {"net_arch": [32]}}),
        ("DQN", "baseline", BUFFER),
        ("SAC", "box", BUFFER),
        ("TD3", "box", BUFFER),
    ],
)
def test_fully_connected_policies_run_on_numpy(
    algorithm: str, mode: str, more: dict[str, Any], tmp_path: Path
) -> None:
    env = SingleEnv("navigation", action_mode=mode, **FLAT, **SHORT)
    model = learned(algorithm, "MlpPolicy", env, **more)
    policy = export(model, tmp_path, SMALL)
    assert not (tmp_path / "agent" / "requirements.txt").exists()
    for observation in play_env(env, seed=1).observations:
        same_choice(model, policy, observation, observation)


def test_a_dict_of_numbers_needs_no_more_than_numpy(tmp_path: Path) -> None:
    env = SingleEnv("navigation", action_mode="multidiscrete", **(FLAT | {"flat": False}), **SHORT)
    model = learned("PPO", "MultiInputPolicy", env, n_steps=32)
    policy = export(model, tmp_path, SMALL)
    assert not (tmp_path / "agent" / "requirements.txt").exists()
    played = play_env(env, seed=1)
    told = observed(tmp_path, describe(env.config), played)
    for ours, theirs in zip(told, played.observations, strict=True):
        same_choice(model, policy, ours, theirs)


def test_pictures_run_on_onnx_with_a_stack_of_them(tmp_path: Path) -> None:
    """Through a real server: what the agent stacks is what the trainer's own wrapper stacks."""
    pytest.importorskip("onnx")
    pytest.importorskip("onnxruntime")
    from stable_baselines3.common.vec_env import DummyVecEnv, VecFrameStack

    env = SingleEnv("navigation", action_mode="multidiscrete", **CAMERA, **SHORT)
    envs = VecFrameStack(DummyVecEnv([lambda: env]), 2)
    model = learned("PPO", "MultiInputPolicy", envs, n_steps=32)
    policy = export(model, tmp_path, PICTURES)
    assert (tmp_path / "agent" / "requirements.txt").read_text() == "onnxruntime>=1.20\n"
    played = play_env(env, seed=1)
    stack = {"count": 2, "axis": "last", "padding": "zero"}
    told = observed(tmp_path, {**describe(env.config), "stack": stack}, played)
    envs.seed(1)
    stacked: Any = envs.reset()
    for ours, choice in zip(told, played.choices, strict=True):
        for name, values in ours.items():
            np.testing.assert_array_equal(values, stacked[name][0])
        same_choice(model, policy, ours, {name: values[0] for name, values in stacked.items()})
        stacked, *_ = envs.step(np.array([choice]))


def test_the_page_makes_a_submission_of_the_model_that_its_code_trains(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    page = DOCS / "training.md"
    code = blocks(page, "python")[0]
    assert "20_000" in code
    exec(code.replace("20_000", "1_000").replace("range(5)", "range(1)"), {})  # noqa: S102
    (line,) = [line for text in blocks(page, "console") for line in text.splitlines() if " init " in line]
    run_line(line, tmp_path)
    run_line("wildscav check navigator --sandbox process", tmp_path)


def test_the_tutorial_goes_from_training_to_a_board(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its commands train, in small, show a match, check, evaluate, and hand in to a season."""
    monkeypatch.setenv("WILDSCAV_CONFIG_DIR", str(tmp_path / "settings"))
    monkeypatch.setenv("WILDSCAV_PASSWORD", "a long password")  # a person would be asked for it
    monkeypatch.setenv("WILDSCAV_SANDBOX", "process")
    match = "[tracks.navigation]\nmaps = 1\nmatch = { time_limit = 5 }\n"
    (tmp_path / "short.toml").write_text(f'name = "short"\nmap = {{ size = 60, houses = 1 }}\n{match}')
    port = free_ports()
    small = {
        "train": ("--steps", "2048", "--episodes", "4", "--option", "random_maps=2"),
        "play": ("--time-limit", "5"),
        "evaluate": ("--suite", "short.toml"),
        "login": ("--name", "ada"),
    }
    lines = [line for text in blocks(DOCS / "tutorial-policy.md", "console") for line in text.splitlines()]
    demo = lines.index("wildscav season demo")
    for line in lines[:demo]:
        name = line.split()[1]
        if name != "watch":
            run_line(line, tmp_path, *small.get(name, ()))
            continue
        record = tmp_path / line.split()[2]
        with running("watch", record, "--no-browser", until=r"(http://\S+)") as (link, _):
            assert "data-match" in httpx.get(link, trust_env=False).text

    # In place of the demo, whose matches are longer and more.
    serve = ("season", "serve", make_season(tmp_path / "season", current=True).folder, "--port", port)
    with running(*serve, until=r"(http://\S+)") as (address, process):
        wait_for(address)
        for line in lines[demo + 1 :]:
            said = run_line(
                line.replace("http://127.0.0.1:8000", address), tmp_path, *small.get(line.split()[1], ())
            )
        assert "navigation" in said
        for _ in range(PATIENCE):
            boards = json.loads(run_line(f"{lines[-1]} --json", tmp_path))["boards"]
            rows = [row for board in boards if board["track"] == "navigation" for row in board["rows"]]
            if any(row["name"] == "runner" and row["rank"] for row in rows):
                break
            time.sleep(0.5)
        else:
            raise AssertionError(rows)
        process.send_signal(signal.SIGINT)
        process.wait(60)


def test_a_file_that_is_no_model_is_refused(tmp_path: Path) -> None:
    arguments = ["--from-policy", str(tmp_path / "model.zip"), "--track", "navigation"]
    (tmp_path / "model.zip").write_bytes(b"no zip")
    done = CliRunner().invoke(app, ["init", str(tmp_path / "agent"), *arguments])
    assert "is not a model of Stable-Baselines3" in str(done.exception)
    assert not (tmp_path / "agent").exists()
