"""What becomes of a worker that ends, hangs or talks nonsense: it is started again, and the log says why."""

import asyncio
import os
import signal
import sys
from pathlib import Path
from typing import Any

import pytest

from wildscav.errors import UserError
from wildscav_server.workers import supervisor
from wildscav_server.workers.supervisor import WorkerSupervisor
from wildscav_server.workers.worker import WorkerConfig

READY = "input(); print('{\"seats\": []}', flush=True); input()"


class Notes:
    """A log that can be read."""

    def __init__(self) -> None:
        self.lines: list[tuple[str, dict[str, Any]]] = []

    def warning(self, event: str, **about: Any) -> None:
        self.lines.append((event, about))

    info = warning


class Interpreter:
    """Stands for the Python that workers are run by: a script that a test can exchange."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self._path, self._real = folder / "python", sys.executable
        monkeypatch.setattr(supervisor.sys, "executable", str(self._path))

    def runs(self, code: str) -> None:
        fresh = self._path.with_name("fresh")
        fresh.write_text(f"#!{self._real}\n{code}\n")
        fresh.chmod(0o755)
        fresh.replace(self._path)

    def is_gone(self) -> None:
        self._path.unlink()


def started(notes: Notes) -> WorkerSupervisor:
    return WorkerSupervisor(WorkerConfig(seats=[], arena="unix:/nowhere", number=1), notes)


@pytest.mark.parametrize(
    ("code", "why"),
    [
        ("input(); print('good morning')", "it answered 'good morning'"),
        ("input(); print(dict(tables=3))", "it answered .*tables"),
        ("input(); print('[1, 2]')", "it answered '.1, 2.'"),
        ("import sys; sys.exit(7)", "it ended with 7"),
        ("import time; time.sleep(100)", "did not start within 0.5 s"),
    ],
    ids=["no json", "nearly json", "other json", "ends", "silent"],
)
def test_a_worker_that_does_not_start_says_why(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, code: str, why: str
) -> None:
    Interpreter(tmp_path, monkeypatch).runs(code)
    monkeypatch.setattr(supervisor, "START_TIMEOUT", 0.5 if "within" in why else 60.0)

    async def start() -> None:
        worker = started(Notes())
        with pytest.raises(UserError, match=why):
            await worker.start()
        assert worker._process is not None
        assert worker._process.returncode is not None  # nothing is left running

    asyncio.run(start())


def test_a_worker_that_cannot_be_started_again_is_tried_until_it_can(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(supervisor, "RESTART_DELAY", 0.01)
    notes, interpreter = Notes(), Interpreter(tmp_path, monkeypatch)

    async def wait_for(event: str, text: str) -> None:
        while not any(name == event and text in str(about) for name, about in notes.lines):  # noqa: ASYNC110
            await asyncio.sleep(0.01)

    async def play() -> None:
        interpreter.runs(READY)
        worker = started(notes)
        await worker.start()
        assert worker._process is not None
        interpreter.is_gone()
        os.kill(worker._process.pid, signal.SIGKILL)
        await wait_for("worker_did_not_start", "No such file")
        interpreter.runs("input(); print('nonsense')")
        await wait_for("worker_did_not_start", "nonsense")
        interpreter.runs(READY)
        while worker.generation == 1:  # noqa: ASYNC110
            await asyncio.sleep(0.01)
        await worker.stop()

    asyncio.run(play())
