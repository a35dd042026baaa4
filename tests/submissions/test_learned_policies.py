"""The learned policies: small, and those of `wildscav train` come from the command that their page tells."""

import json
import shlex
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.policy import Policy
from wildscav_training.cli import train
from wildscav_training.learning.settings import TrainingSettings

SUBMISSIONS = Path(__file__).parents[2] / "submissions"
TRAINED = ("learned-navigator", "learned-scavenger", "learned-commando")
TO_WALK = 9 + 2 + 7 + 5 + 2
TO_FIGHT = 9 + 2 + 21 + 13 + 2 + 2 + 2 + 2  # with finer turns and looks; jump, pick up, shoot and reload
CHOICES = {
    "learned-navigator": TO_WALK,
    "learned-scavenger": TO_WALK + 2,
    "learned-commando": TO_FIGHT,
    "cloned-navigator": TO_WALK,
}
LARGEST = 2_000_000  # bytes


def command(folder: Path) -> list[str]:
    """The command of the README, without ``wildscav``."""
    lines = folder.joinpath("README.md").read_text("utf-8").replace("\\\n", " ").splitlines()
    (found,) = [line for line in lines if line.strip().startswith("wildscav train")]
    return shlex.split(found)[1:]


@pytest.mark.parametrize("name", TRAINED)
def test_the_command_of_its_page_is_the_one_that_trained_it(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    runs: list[TrainingSettings] = []

    class Seen(Exception):  # noqa: N818 - it ends the command where training would begin
        pass

    def see(settings: list[TrainingSettings], *_: object, **__: Mapping[str, Any]) -> None:
        runs.extend(settings)
        raise Seen

    (tmp_path / "submissions").symlink_to(SUBMISSIONS)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(train, "_train_all", see)
    ended = CliRunner().invoke(app, command(SUBMISSIONS / name))

    assert isinstance(ended.exception, Seen), ended.output
    assert [run.as_json() for run in runs] == [
        json.loads((SUBMISSIONS / name / "training.json").read_text("utf-8"))
    ]


@pytest.mark.parametrize(("name", "choices"), CHOICES.items())
def test_it_is_small_and_turns_what_it_sees_into_scores_of_all_choices(name: str, choices: int) -> None:
    folder = SUBMISSIONS / name
    assert sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) < LARGEST
    policy = Policy(folder)
    with np.load(folder / "network.npz") as arrays:
        inputs = arrays["weight_0"].shape[1]
    scores = policy.network(np.zeros(inputs, np.float32))
    assert scores.shape == (choices,), "walk, speed, turn, look and jump; to gather, pick up too"
    assert np.ptp(scores) > 0.1, "it prefers some choices"
