"""RLlib behind `wildscav train`: the same run folder, checkpoints and submissions."""

import importlib.util
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.platform.training.learning.common import small

from wildscav.policy import Policy
from wildscav.policy.networks import Choose
from wildscav_training.learning.algorithms import ALGORITHMS, RLLIB

torch = pytest.importorskip("torch")
if importlib.util.find_spec("ray") is None:  # imported, it would read its variables before they are set
    pytest.skip("Ray is missing", allow_module_level=True)
# PyTorch is installed for the slow tests alone.
pytestmark = [pytest.mark.slow, pytest.mark.filterwarnings("ignore")]

from wildscav_training.learning import run  # noqa: E402
from wildscav_training.learning.run import learning  # noqa: E402
from wildscav_training.learning.submission import policy_submission  # noqa: E402


class InterruptionError(Exception):
    """Somebody pressed Ctrl-C."""


@pytest.mark.parametrize("algorithm", [name for name, one in ALGORITHMS.items() if one.library == RLLIB])
def test_an_interrupted_run_continues_to_a_submission_that_plays_its_policy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, algorithm: str
) -> None:
    monkeypatch.setattr(run, "EVERY", 0.0)
    settings = small(steps=256, algorithm=algorithm, curriculum=(1.0,))
    folder = tmp_path / "run"

    def interrupt(figures: Any) -> None:
        if figures["steps"] >= 128:
            raise InterruptionError

    with pytest.raises(InterruptionError):
        run.train(settings, folder, interrupt, resume=False, episodes=2)
    result = run.train(settings, folder, lambda _: None, resume=True, episodes=2)
    assert result.steps >= 256
    assert len(result.scores) == 4
    lines = [json.loads(line) for line in (folder / "figures.jsonl").read_text().splitlines()]
    steps = [line["steps"] for line in lines]
    assert steps == sorted(set(steps)), "the steps after the checkpoint are there once"
    assert {"policy_loss", "entropy", "cpu_seconds"} <= lines[-1].keys()

    agent = tmp_path / "agent"
    agent.mkdir()
    for name, content in policy_submission(folder, settings, "runner", Choose.SAMPLED).items():
        (agent / name).write_bytes(content)
    played = Policy(agent)
    state = torch.load(folder / "checkpoint.pt", weights_only=True)["learner"]
    with learning(settings) as learner:
        learner.restore(state)
        assert learner.steps == result.steps
        module = learner._learner().module["default_policy"]  # type: ignore[attr-defined]
        rows = np.random.default_rng(0).normal(size=(8, learner.policy[0].in_features)).astype(np.float32)
        with torch.no_grad():
            scores = module.forward_inference({"obs": torch.from_numpy(rows)})["action_dist_inputs"].numpy()
    for row, expected in zip(rows, scores, strict=True):
        assert played.network(row) == pytest.approx(expected, abs=1e-5)
