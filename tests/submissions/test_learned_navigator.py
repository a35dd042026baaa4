"""The learned navigator: small, and trained by the one command that its page tells."""

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from typer.testing import CliRunner

from wildscav.cli import train
from wildscav.cli.main import app
from wildscav.policy import Policy
from wildscav.training.settings import TrainingSettings

FOLDER = Path(__file__).parents[2] / "submissions" / "learned-navigator"
LARGEST = 2_000_000  # bytes


def command() -> list[str]:
    """The command of the README, without ``wildscav``."""
    lines = FOLDER.joinpath("README.md").read_text("utf-8").replace("\\\n", " ").splitlines()
    (found,) = [line for line in lines if line.strip().startswith("wildscav train")]
    return shlex.split(found)[1:]


def test_the_command_of_its_page_is_the_one_that_trained_it(tmp_path: Path, monkeypatch: Any) -> None:
    runs: list[TrainingSettings] = []

    class Seen(Exception):  # noqa: N818 - it ends the command where training would begin
        pass

    def see(settings: list[TrainingSettings], *_: object, **__: Mapping[str, Any]) -> None:
        runs.extend(settings)
        raise Seen

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(train, "_train_all", see)
    ended = CliRunner().invoke(app, command())

    assert isinstance(ended.exception, Seen), ended.output
    assert [run.as_json() for run in runs] == [json.loads((FOLDER / "training.json").read_text("utf-8"))]


def test_it_is_small_and_turns_what_it_sees_into_scores_of_all_choices() -> None:
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) < LARGEST
    policy = Policy(FOLDER)
    with np.load(FOLDER / "network.npz") as arrays:
        inputs = arrays["weight_0"].shape[1]
    scores = policy.network(np.zeros(inputs, np.float32))
    assert scores.shape == (9 + 2 + 7 + 5 + 2,), "walk, speed, turn, look and jump"
    assert np.ptp(scores) > 0.1, "it prefers some choices"
