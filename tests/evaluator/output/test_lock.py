"""The lock of an output folder."""

import subprocess
import sys
from pathlib import Path
from time import sleep

import pytest

from wildscav.errors import UserError
from wildscav_evaluator.output.lock import LOCK, locked

# An evaluation that is killed while a worker of its own still has something to do, until a file appears.
KILLED = """
import multiprocessing, os, sys, time
from pathlib import Path
from wildscav_evaluator.output.lock import locked

def work(lock, ready):
    ready.set()
    while not Path(sys.argv[2]).exists():
        time.sleep(0.01)

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    ready = context.Event()
    with locked(Path(sys.argv[1])) as lock:
        context.Process(target=work, args=(lock, ready)).start()
        ready.wait()
        os.kill(os.getpid(), 9)
"""


def test_a_folder_is_free_once_the_workers_of_a_killed_evaluation_are_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    program, folder, done = tmp_path / "killed.py", tmp_path / "out", tmp_path / "done"
    folder.mkdir()
    program.write_text(KILLED)
    subprocess.run([sys.executable, program, folder, done], stderr=subprocess.DEVNULL)
    waits: list[float] = []

    def wait(seconds: float) -> None:
        waits.append(seconds)
        done.touch()  # the worker ends only once somebody waits for it
        sleep(seconds)

    monkeypatch.setattr("wildscav_evaluator.output.lock.time.sleep", wait)
    with locked(folder):
        assert waits
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
