"""`wildscav evaluate` in a process of its own, to be killed."""

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

from wildscav_engine.record import read_record
from wildscav_evaluator.ledger.entries import Entry, MatchEnded
from wildscav_evaluator.output.layout import LEDGER_FILE, RESULTS_FILE
from wildscav_evaluator.output.results import Results

PROGRAM = str(Path(sys.executable).parent / "wildscav")


class Sitting:
    """One run of an evaluation's command, or of another one that plays matches."""

    def __init__(self, out: Path, *arguments: object, verb: str = "evaluate") -> None:
        self.out = out
        command = [PROGRAM, verb, *map(str, arguments), f"--out={out}"]
        environment = {**os.environ, "COLUMNS": "80"}
        self.printed = out.with_name(f"{out.name}.printed")
        self._errors = out.with_name(f"{out.name}.errors")
        with self.printed.open("wb") as file, self._errors.open("wb") as errors:
            self.process = subprocess.Popen(command, stdout=file, stderr=errors, env=environment)

    @property
    def errors(self) -> str:
        """What it printed to stderr so far."""
        return self._errors.read_text()

    def await_begin(self) -> None:
        """Wait until it has imported all that it needs, and prints something: nothing is written before."""
        while self.printed.stat().st_size == 0 and self.process.poll() is None:
            time.sleep(0.01)

    def kill_after(self, seconds: float) -> bool:
        """Kill it a time after it has begun; return whether it was still running."""
        self.await_begin()
        try:
            self.process.wait(seconds)
        except subprocess.TimeoutExpired:
            self._kill()
            return True
        return False

    def kill_at(self, matches: int) -> None:
        """Kill it as soon as so many matches are in its ledger, and the folder is there."""
        self.await_matches(matches)
        self._kill()

    def kill_when(self, condition: Callable[[], bool]) -> None:
        """Kill it as soon as something is the case."""
        self._await(condition)
        self._kill()

    def await_matches(self, matches: int) -> None:
        """Wait until so many matches are in its ledger."""
        self._await(lambda: self.out.exists() and len(entered(self.out)) >= matches)

    def _await(self, condition: Callable[[], bool]) -> None:
        deadline = time.monotonic() + 300.0
        while not condition():
            assert self.process.poll() is None, "it came to its end"
            assert time.monotonic() < deadline, "it got nowhere"
            time.sleep(0.01)

    def interrupt(self) -> None:
        """Press Ctrl-C."""
        self.process.send_signal(signal.SIGINT)

    def _kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


def entered(out: Path) -> dict[str, tuple[str, int]]:
    """When each match of the ledger was entered, and when its record was written, ns."""
    path = out / LEDGER_FILE
    lines = path.read_bytes().splitlines(keepends=True) if path.exists() else []
    entries = [Entry.model_validate_json(line) for line in lines if line.endswith(b"\n")]
    return {
        one.fact.match: (one.at, (out / str(one.fact.row.record)).stat().st_mtime_ns)
        for one in entries
        if isinstance(one.fact, MatchEnded) and one.fact.record is not None
    }


def check_whole(out: Path) -> None:
    """Whatever is there under its name is whole."""
    for path in (out / "records").glob("[!.]*"):
        read_record(path)
    for stem in entered(out):
        read_record(out / "records" / f"{stem}.wsr")
    if (out / RESULTS_FILE).exists():
        Results.model_validate_json((out / RESULTS_FILE).read_bytes())


def without_timings(out: Path) -> dict[str, object]:
    """The results that may not differ from run to run."""
    content: dict[str, object] = json.loads((out / RESULTS_FILE).read_text())
    del content["timings"]
    return content


def files(out: Path, folder: str) -> dict[str, bytes]:
    """The content of every file of a folder."""
    return {path.name: path.read_bytes() for path in (out / folder).iterdir()}


def contents(out: Path) -> dict[str, bytes]:
    """The contents of all files by their paths in a folder."""
    return {
        str(path.relative_to(out)): path.read_bytes() for path in sorted(out.rglob("*.*")) if path.is_file()
    }
