"""Runs that start from the weights of another policy."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.training.learning.common import small
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.errors import UserError
from wildscav_training.learning.start import read_start

OTHER = "must have the same observations, actions and layers"


def layers(path: Path, *widths: int) -> Path:
    """A file of layers with these widths, from the first one's inputs to the last one's outputs."""
    arrays: dict[str, Any] = {}
    for layer, (before, after) in enumerate(pairwise(widths)):
        arrays[f"weight_{layer}"] = np.full((after, before), 0.25, np.float32)
        arrays[f"bias_{layer}"] = np.arange(after, dtype=np.float32)
    np.savez(path, **arrays)
    return path


def test_a_run_from_other_weights_is_another_run(tmp_path: Path) -> None:
    one, other = layers(tmp_path / "one.npz", 4, 2), layers(tmp_path / "other.npz", 4, 3)
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
def test_the_policy_starts_from_the_weights_and_the_value_learns_first(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    from wildscav_training.learning.ppo import PPO, VALUE_FIRST

    settings = small(steps=64 * (VALUE_FIRST + 1))
    inputs = PPO(settings).policy[0].in_features
    outputs = sum(PPO(settings).choices.sizes)
    start = read_start(layers(tmp_path / "policy.npz", inputs, 8, outputs))
    learner = PPO(replace(settings, start=start))

    def weights(network: Any) -> list[float]:
        return list(network[0].weight.reshape(-1).tolist())

    first_value = weights(learner.value)
    assert weights(learner.policy) == [0.25] * (8 * inputs)
    for _ in range(VALUE_FIRST):
        learner.iterate()
    assert weights(learner.policy) == [0.25] * (8 * inputs)
    assert weights(learner.value) != first_value
    learner.iterate()
    assert weights(learner.policy) != [0.25] * (8 * inputs)

    wrong = read_start(layers(tmp_path / "wrong.npz", inputs, 9, outputs))
    with pytest.raises(UserError, match=OTHER):
        PPO(replace(settings, start=wrong))


def test_a_learner_that_is_gone_is_told_of_in_one_line() -> None:
    done = CliRunner().invoke(app, ("train", "--algorithm", "a2c"))
    assert isinstance(done.exception, UserError)
    assert str(done.exception).startswith("--algorithm a2c is gone: `wildscav train` learns by PPO")
