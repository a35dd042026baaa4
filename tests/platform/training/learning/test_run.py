"""A run of `wildscav train`: it reaches what its page promises, and its submission plays the same actions."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.end_to_end.pages import json_documents, names
from tests.platform.training.learning.common import OPTIONS, small
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.policy import Policy
from wildscav_training.learning.settings import TrainingSettings

torch = pytest.importorskip("torch")
pytest.importorskip("tensorboardX")

from wildscav_training.learning import run  # noqa: E402
from wildscav_training.learning.checkpoints import RunFolder  # noqa: E402
from wildscav_training.learning.ppo import PPO  # noqa: E402

pytestmark = [pytest.mark.slow, pytest.mark.long]  # PyTorch is installed for the slow tests alone


class InterruptionError(Exception):
    """Somebody pressed Ctrl-C."""


def weights(folder: Path) -> list[list[float]]:
    with np.load(folder / "policy.npz") as arrays:
        return [arrays[name].reshape(-1).tolist() for name in arrays.files]


def test_an_interrupted_run_ends_as_one_in_one_sitting(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(run, "EVERY", 0.0)
    settings = small(steps=512, curriculum=(1.0,))
    whole = run.train(settings, tmp_path / "whole", lambda _: None, resume=False, episodes=4)

    def interrupt(figures: Any) -> None:
        if figures.get("steps") == 192:  # before the checkpoint of this iteration
            raise InterruptionError

    with pytest.raises(InterruptionError):
        run.train(settings, tmp_path / "parts", interrupt, resume=False, episodes=4)
    parts = run.train(settings, tmp_path / "parts", lambda _: None, resume=True, episodes=4)

    assert weights(tmp_path / "parts") == weights(tmp_path / "whole")
    assert parts.scores == whole.scores
    lines = [json.loads(line) for line in (tmp_path / "parts" / "figures.jsonl").read_text().splitlines()]
    assert [line["steps"] for line in lines] == list(range(64, 513, 64))
    assert list((tmp_path / "parts" / "tensorboard").iterdir())


def test_weights_are_written_whole_or_not_at_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(file: Any, **_: Any) -> None:
        file.write(b"half")
        raise OSError(28, "No space left on device")

    (tmp_path / "policy.npz").write_bytes(b"those of before")
    monkeypatch.setattr(np, "savez", fail)
    with pytest.raises(OSError, match="No space left on device"):
        run._save_layers(tmp_path / "policy.npz", torch.nn.Sequential(torch.nn.Linear(2, 1)))
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [
        ("policy.npz", b"those of before")
    ]


def train(*arguments: object) -> Any:
    given = [
        part for name in ("map", "time_limit") for part in ("--option", f"{name}={json.dumps(OPTIONS[name])}")
    ]
    sizes = ["matches=4", "rollout=16", "minibatch=16", "epochs=1", "layers=[8]"]
    changes = [part for size in sizes for part in ("--set", size)]
    shared = ["train", "--steps", "64", "--episodes", "2", *given, *changes]
    return CliRunner().invoke(app, [*shared, *map(str, arguments)])


def test_the_submission_does_what_the_trained_policy_does(tmp_path: Path) -> None:
    done = train("--out", tmp_path / "out", "--submission", tmp_path / "agent", "--seeds", 2, "--json")
    assert done.exit_code == 0, (done.output, done.exception)
    document = json.loads(done.stdout)
    assert [one["seed"] for one in document["runs"]] == [0, 1]
    assert [one["steps"] for one in document["runs"]] == [64, 64]
    assert {(score["split"], score["choose"]) for score in document["runs"][0]["scores"]} == {
        (split, choose) for split in ("train", "test") for choose in ("sampled", "deterministic")
    }
    assert "CPU s" in done.stderr
    assert "seed 1: learned; measuring 4 × 2 matches\n" in done.stderr

    folder = tmp_path / "out" / "seed-0"
    settings = json.loads((folder / "settings.json").read_text())
    assert settings.pop("algorithm") == "ppo"
    settings["hyperparameters"] = small().hyperparameters
    learner = PPO(TrainingSettings(**{**settings, "curriculum": ()}))
    learner.restore(RunFolder(folder).load()["learner"])
    agent = Policy(tmp_path / "agent")
    generator = np.random.default_rng(0)
    for _ in range(100):
        row = generator.normal(size=learner.policy[0].in_features).astype(np.float32)
        with torch.no_grad():
            scores = learner.policy(torch.from_numpy(row)[None])
        outputs = agent.network(row)
        assert outputs == pytest.approx(scores[0].numpy(), abs=1e-5)
        assert learner.choices.best(scores)[0].tolist() == agent.chooser(outputs * 1e6, generator).tolist()
    assert sum(path.stat().st_size for path in (tmp_path / "agent").iterdir()) < 2_000_000


def test_the_submission_is_there_before_a_run_is_measured_and_again_after_it_continued(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: Any) -> None:
        assert Policy(tmp_path / "agent")
        raise InterruptionError

    given = ("--out", tmp_path / "out", "--submission", tmp_path / "agent")
    with monkeypatch.context() as patch:
        patch.setattr(run, "evaluate", interrupt)
        assert isinstance(train(*given).exception, InterruptionError)
    done = train(*given, "--resume")
    assert done.exit_code == 0, (done.output, done.exception)
    assert "seed 0: continues from step 64\n" in done.stderr
    assert train(*given, "--resume", "--seed", 1).exception.exit_code == 2, "it is of another run"


def test_seeds_at_once_end_as_seeds_one_after_the_other(tmp_path: Path) -> None:
    assert train("--out", tmp_path / "one", "--seeds", 2).exit_code == 0
    done = train("--out", tmp_path / "other", "--seeds", 2, "--workers", 2, "--json")
    assert done.exit_code == 0, (done.output, done.exception)
    assert [one["seed"] for one in json.loads(done.stdout)["runs"]] == [0, 1]
    for seed in ("seed-0", "seed-1"):
        assert weights(tmp_path / "one" / seed) == weights(tmp_path / "other" / seed)
    assert weights(tmp_path / "one" / "seed-0") != weights(tmp_path / "one" / "seed-1")


def test_what_is_wrong_in_one_of_several_processes_is_said_in_one_line(tmp_path: Path) -> None:
    (tmp_path / "out" / "seed-1").mkdir(parents=True)
    (tmp_path / "out" / "seed-1" / "notes.txt").touch()
    done = train("--out", tmp_path / "out", "--seeds", 2, "--workers", 2, "--resume")
    assert done.exception.exit_code == 2
    assert str(done.exception).endswith("holds no run: settings.json is missing")


LEARNED = 0.9  # share of targets reached; random actions reach 0.03 of them
LONGEST = 180.0  # s of one processor


def test_the_first_command_of_the_page_learns_to_navigate_in_three_minutes_of_one_core(
    tmp_path: Path,
) -> None:
    options = ("--out", str(tmp_path / "easy"), "--episodes", "40", "--json")
    done = CliRunner().invoke(app, ["train", "--level", "easy", *options])

    assert done.exit_code == 0, (done.output, done.exception)
    document = json.loads(done.stdout)
    assert names(document) == json_documents()["train"]
    (result,) = document["runs"]
    reached = {(score["split"], score["choose"]): score["metrics"]["success"] for score in result["scores"]}
    assert reached["train", "sampled"] >= LEARNED
    assert reached["test", "sampled"] >= LEARNED, "it has learned the maps of training, and not to navigate"
    assert result["cpu_seconds"] <= LONGEST
    figures = (tmp_path / "easy" / "seed-0" / "figures.jsonl").read_text().splitlines()
    successes = [json.loads(line).get("success", 0.0) for line in figures]
    assert successes[-1] >= LEARNED
