"""Stable-Baselines3 behind `wildscav train`: the same run folder, and checkpoints bit for bit."""

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from tests.platform.training.learning.common import small

from wildscav.policy.networks import Choose
from wildscav_training.learning.settings import TrainingSettings

torch = pytest.importorskip("torch")
pytest.importorskip("stable_baselines3")
# PyTorch is installed for the slow tests alone; the library warns of sizes that do not divide.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

from wildscav_training.learning import run  # noqa: E402
from wildscav_training.learning.checkpoints import RunFolder  # noqa: E402
from wildscav_training.learning.stable_learner import StableLearner  # noqa: E402
from wildscav_training.learning.submission import policy_submission  # noqa: E402


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(threads)


def trained(settings: TrainingSettings, iterations: int, state: Any = None) -> StableLearner:
    learner = StableLearner(settings)
    if state is not None:
        learner.restore(state)
    for _ in range(iterations):
        figures = learner.iterate()
    assert all(math.isfinite(figure) for figure in figures.values())
    assert {"policy_loss", "value_loss", "entropy", "stage"} <= figures.keys()
    return learner


def weights(learner: StableLearner) -> list[list[float]]:
    return [tensor.reshape(-1).tolist() for tensor in learner.model.policy.parameters()]


@pytest.mark.parametrize("algorithm", ["sb3-ppo", "a2c"])
@pytest.mark.parametrize(
    ("track", "more"),
    [("navigation", {"curriculum": (1.0,)}), ("gathering", {"agents": 2, "teams": (0, 0), "anneal": False})],
)
def test_a_run_continues_from_its_checkpoint_bit_for_bit(
    tmp_path: Path, algorithm: str, track: str, more: dict[str, Any]
) -> None:
    settings = small(track, steps=6400, algorithm=algorithm, **more)
    whole = trained(settings, 6)
    first = trained(settings, 3)
    RunFolder(tmp_path).save(first.state())
    then = trained(settings, 3, RunFolder(tmp_path).load())
    assert weights(then) == weights(whole) != weights(first)
    assert then.steps == whole.steps == 6 * 64 * (2 if track == "gathering" else 1)


@pytest.mark.parametrize("algorithm", ["sb3-ppo", "a2c"])
def test_a_run_ends_with_scores_and_a_policy_for_a_submission(tmp_path: Path, algorithm: str) -> None:
    settings = small(steps=128, algorithm=algorithm)
    result = run.train(settings, tmp_path / "run", lambda _: None, resume=False, episodes=2)
    assert (result.steps, len(result.scores)) == (128, 4)
    lines = (tmp_path / "run" / "figures.jsonl").read_text().splitlines()
    assert [json.loads(line)["steps"] for line in lines] == [64, 128]
    assert list((tmp_path / "run" / "tensorboard").iterdir())
    files = policy_submission(tmp_path / "run", settings, "runner", Choose.SAMPLED)
    assert {"agent.py", "policy.json", "network.npz"} <= files.keys()
    again = run.train(settings, tmp_path / "run", lambda _: None, resume=True, episodes=2)
    assert again.scores == result.scores


def test_the_policy_that_is_measured_is_the_one_that_acts() -> None:
    learner = trained(small(algorithm="a2c"), 1)
    rows = torch.randn(16, learner.policy[0].in_features)
    with torch.no_grad():
        scores = learner.policy(rows).split(learner.env.action_space.nvec.tolist(), -1)
        acted, _ = learner.model.predict(rows.numpy(), deterministic=True)
    assert torch.stack([part.argmax(-1) for part in scores], -1).tolist() == acted.tolist()
