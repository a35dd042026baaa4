"""The weights of a run become a submission of its environment; PyTorch is not needed for it."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav.policy import Policy
from wildscav.policy.networks import Choose
from wildscav_engine.envs.batched import multi_agent_config
from wildscav_engine.envs.spaces.actions import action_mode
from wildscav_engine.envs.spaces.observation import observation_space
from wildscav_training.cli import train
from wildscav_training.learning.settings import preset_settings
from wildscav_training.learning.submission import policy_submission


def write_weights(path: Path, inputs: int, outputs: int) -> None:
    generator = np.random.default_rng(0)
    shapes = [(8, inputs), (outputs, 8)]
    arrays = {f"weight_{layer}": generator.normal(size=shape) for layer, shape in enumerate(shapes)}
    arrays |= {f"bias_{layer}": generator.normal(size=shape[0]) for layer, shape in enumerate(shapes)}
    np.savez(path, **arrays)  # type: ignore[arg-type]


@pytest.mark.parametrize("track", ["navigation", "gathering", "battle"])
def test_the_policy_of_a_run_becomes_a_submission(tmp_path: Path, track: str) -> None:
    _, options = preset_settings("tuned", track, {"level": "easy", "random_maps": 2})
    config = multi_agent_config(track, options)
    inputs, space = math.prod(observation_space(config).shape or ()), action_mode(config).space
    write_weights(tmp_path / "policy.npz", inputs, int(space.nvec.sum()))  # type: ignore[attr-defined]
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
    write_weights(tmp_path / "policy.npz", inputs=5, outputs=25)
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
