"""Runs that start from the weights of another policy, and the submissions that their weights become."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.helpers.policy_matches import write_layers
from tests.platform.training.learning.common import small
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.errors import UserError
from wildscav.policy import Policy
from wildscav.policy.networks import Choose
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.spaces.actions import action_mode
from wildscav_engine.envs.spaces.observation import observation_space
from wildscav_training.cli import train
from wildscav_training.learning.settings import preset_settings
from wildscav_training.learning.start import read_start
from wildscav_training.learning.submission import policy_submission

OTHER = "must have the same observations, actions and layers"


def test_a_run_from_other_weights_is_another_run(tmp_path: Path) -> None:
    one, other = write_layers(tmp_path / "one.npz", 4, 2), write_layers(tmp_path / "other.npz", 4, 3)
    starts = [None, read_start(one), read_start(other)]
    runs = [str(replace(small(), start=start).as_json()) for start in starts]
    assert len(set(runs)) == 3
    moved = one.rename(tmp_path / "elsewhere.npz")
    assert str(replace(small(), start=read_start(moved)).as_json()) == runs[1], "wherever the file lies"


def test_what_is_no_file_of_weights_is_said(tmp_path: Path) -> None:
    (tmp_path / "words.npz").write_text("weights", "utf-8")
    for name, says in (("none.npz", "No such file"), ("words.npz", "holds no layers")):
        with pytest.raises(UserError, match=says) as caught:
            read_start(tmp_path / name)
        assert str(caught.value).startswith("--start-from: ")


@pytest.mark.slow
@pytest.mark.parametrize(("rollouts", "of_value"), [(40, 10), (7, 1)])
def test_the_policy_starts_from_the_weights_and_the_value_learns_first(
    tmp_path: Path, rollouts: int, of_value: int
) -> None:
    pytest.importorskip("torch")
    from wildscav_training.learning.ppo import PPO

    settings = small(steps=64 * rollouts)
    inputs = PPO(settings).policy[0].in_features
    outputs = sum(PPO(settings).choices.sizes)
    start = read_start(write_layers(tmp_path / "policy.npz", inputs, 8, outputs, value=0.25))
    learner = PPO(replace(settings, start=start))

    def weights(network: Any) -> list[float]:
        return list(network[0].weight.reshape(-1).tolist())

    first_value = weights(learner.value)
    assert weights(learner.policy) == [0.25] * (8 * inputs)
    for _ in range(of_value):
        learner.iterate()
    assert weights(learner.policy) == [0.25] * (8 * inputs)
    assert weights(learner.value) != first_value
    learner.iterate()
    assert weights(learner.policy) != [0.25] * (8 * inputs)

    wrong = read_start(write_layers(tmp_path / "wrong.npz", inputs, 9, outputs))
    with pytest.raises(UserError, match=OTHER):
        PPO(replace(settings, start=wrong))


def test_a_learner_that_is_gone_is_told_of_in_one_line() -> None:
    done = CliRunner().invoke(app, ("train", "--algorithm", "a2c"))
    assert isinstance(done.exception, UserError)
    assert str(done.exception).startswith("--algorithm a2c is gone: `wildscav train` learns by PPO")


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
def test_the_policy_of_a_run_becomes_a_submission(tmp_path: Path, track: str) -> None:
    _, options = preset_settings("tuned", track, {"level": "easy", "random_maps": 2})
    config = multi_agent_config(track, options)
    inputs, space = math.prod(observation_space(config).shape or ()), action_mode(config).space
    write_layers(tmp_path / "policy.npz", inputs, 8, int(space.nvec.sum()))  # type: ignore[attr-defined]
    settings = small(track)
    object.__setattr__(settings, "options", options)

    files = policy_submission(tmp_path, settings, "runner", Choose.SAMPLED)

    folder = tmp_path / "agent"
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    policy = Policy(folder)
    assert policy.network(np.zeros(inputs, np.float32)).shape == (int(space.nvec.sum()),)  # type: ignore[attr-defined]
    assert f'tracks = ["{track}"]' in files["submission.toml"].decode()
    assert json.loads(files["training.json"])["hyperparameters"]["layers"] == [8]


def test_weights_of_another_environment_are_said(tmp_path: Path) -> None:
    write_layers(tmp_path / "policy.npz", 5, 8, 25)
    with pytest.raises(UserError, match="takes 5 numbers"):
        policy_submission(tmp_path, small(), "runner", Choose.SAMPLED)


def test_the_figures_of_an_iteration_are_one_line() -> None:
    figures: dict[str, Any] = {
        "steps": 4096,
        "cpu_seconds": 1.4,
        "stage": 1.0,
        "return": 0.5,
        "success": 0.25,
    }
    assert train._shown(figures) == ("4,096 steps, 1 CPU s, return 0.50, success in training 0.25, stage 2")
    assert train._shown({"steps": 1, "cpu_seconds": 0.0, "stage": 0.0}) == "1 steps, 0 CPU s"
