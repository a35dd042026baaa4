"""Ctrl-C in ``wildscav train``."""

from pathlib import Path

import pytest
from tests.commands import run_command

from wildscav_training.cli import train


def test_an_interrupted_training_says_how_to_continue(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(train, "_train_all", interrupt)
    done = run_command("train", "--out", "out", cwd=tmp_path)
    assert done.returncode == 130
    assert done.stderr == "wildscav: interrupted: out keeps what is done; continue with --resume\n"
