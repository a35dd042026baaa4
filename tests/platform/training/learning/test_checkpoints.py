"""The folder of a run: nobody's files are overwritten, and a run goes on only with its own settings."""

import json
from pathlib import Path

import pytest
from tests.platform.training.learning.common import small

from wildscav.errors import UserError
from wildscav_training.learning.checkpoints import FIGURES, SETTINGS, RunFolder


def test_a_new_folder_holds_the_settings(tmp_path: Path) -> None:
    RunFolder(tmp_path / "a" / "b").begin(small(), resume=False)
    assert json.loads((tmp_path / "a" / "b" / SETTINGS).read_text())["steps"] == 256
    RunFolder(tmp_path / "a" / "b").begin(small(), resume=True)


def test_a_folder_in_use_is_refused(tmp_path: Path) -> None:
    RunFolder(tmp_path).begin(small(), resume=False)
    with pytest.raises(UserError, match=r"is not an empty folder: name another with --out, or .* --resume"):
        RunFolder(tmp_path).begin(small(), resume=False)


def test_a_file_is_no_folder(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(UserError, match="is not an empty folder"):
        RunFolder(tmp_path / "file").begin(small(), resume=False)


@pytest.mark.parametrize(
    ("now", "says"),
    [
        (small(seed=1), "seed is 0 there and 1 here"),
        (small(steps=512), "steps is 256 there and 512 here"),
        (small(entropy=0.5), "hyperparameters.entropy is 0.003 there and 0.5 here"),
        (small(level="hard"), 'options.level is null there and "hard" here'),
        (small(curriculum=(2.0,)), "curriculum is [] there and [2.0] here"),
    ],
    ids=["seed", "steps", "hyperparameter", "option", "curriculum"],
)
def test_a_run_is_not_continued_with_other_settings(tmp_path: Path, now: object, says: str) -> None:
    RunFolder(tmp_path).begin(small(), resume=False)
    with pytest.raises(UserError) as caught:
        RunFolder(tmp_path).begin(now, resume=True)  # type: ignore[arg-type]
    assert says in str(caught.value)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "holds no run: settings.json is missing"),
        ("{", "is not valid JSON"),
        ("3", "must hold a JSON object"),
    ],
)
def test_a_folder_of_something_else_is_not_continued(tmp_path: Path, content: str | None, says: str) -> None:
    (tmp_path / "notes.txt").touch()
    if content is not None:
        (tmp_path / SETTINGS).write_text(content)
    with pytest.raises(UserError, match=says):
        RunFolder(tmp_path).begin(small(), resume=True)


def test_figures_after_the_checkpoint_are_forgotten(tmp_path: Path) -> None:
    folder = RunFolder(tmp_path)
    folder.begin(small(), resume=False)
    for steps in (64, 128, 192):
        folder.append_figures({"steps": steps})
    with (tmp_path / FIGURES).open("a") as file:
        file.write('{"steps": 2')  # written in part
    folder.forget_figures_after(128)
    assert [json.loads(line)["steps"] for line in (tmp_path / FIGURES).read_text().splitlines()] == [64, 128]


@pytest.mark.slow
def test_a_damaged_checkpoint_is_said(tmp_path: Path) -> None:
    pytest.importorskip("torch")
    folder = RunFolder(tmp_path)
    folder.begin(small(), resume=False)
    (tmp_path / "checkpoint.pt").write_bytes(b"nothing of the kind")
    assert folder.has_checkpoint
    with pytest.raises(UserError, match="is not a checkpoint, or is damaged"):
        folder.load()
