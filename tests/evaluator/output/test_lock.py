"""The lock of an output folder."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav_evaluator.output.lock import LOCK, locked

# An evaluation that is killed while a worker of its own still has something to do for a second.
KILLED = """
import multiprocessing, os, sys, time
from pathlib import Path
from wildscav_evaluator.output.lock import locked

def work(lock, ready):
    ready.set()
    time.sleep(1.0)

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    ready = context.Event()
    with locked(Path(sys.argv[1])) as lock:
        context.Process(target=work, args=(lock, ready)).start()
        ready.wait()
        os.kill(os.getpid(), 9)
"""


def test_a_folder_is_free_once_the_workers_of_a_killed_evaluation_are_gone(tmp_path: Path) -> None:
    program, folder = tmp_path / "killed.py", tmp_path / "out"
    folder.mkdir()
    program.write_text(KILLED)
    subprocess.run([sys.executable, program, folder], stderr=subprocess.DEVNULL)

    began = time.monotonic()
    with locked(folder):
        waited = time.monotonic() - began

    assert waited > 0.3
    assert not (folder / LOCK).exists()


def test_whoever_comes_while_an_evaluation_runs_is_told_without_a_wait(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    waits: list[float] = []
    monkeypatch.setattr("wildscav_evaluator.output.lock.time.sleep", waits.append)

    with locked(tmp_path), pytest.raises(UserError, match="another evaluation is writing"), locked(tmp_path):
        pass

    assert not waits

    with locked(tmp_path):
        assert (tmp_path / LOCK).exists()
