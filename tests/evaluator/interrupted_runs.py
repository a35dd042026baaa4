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
from wildscav_evaluator.output.journal import Entry
from wildscav_evaluator.output.layout import MATCHES, RESULTS_FILE
from wildscav_evaluator.output.results import Results

PROGRAM = str(Path(sys.executable).parent / "wildscav")


class Sitting:
    """One run of an evaluation's command."""

    def __init__(self, out: Path, *arguments: object) -> None:
        self.out = out
        command = [PROGRAM, "evaluate", *map(str, arguments), f"--out={out}", f"--db={out / 'wildscav.db'}"]
        environment = {**os.environ, "COLUMNS": "80"}
        self.printed = out.with_name(f"{out.name}.printed")
        with self.printed.open("wb") as file:
            self.process = subprocess.Popen(command, stdout=file, stderr=subprocess.DEVNULL, env=environment)

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
        """Kill it as soon as so many matches are in its journal, and the folder is there."""
        self.kill_when(lambda: (self.out / MATCHES).exists() and len(journal(self.out)) >= matches)

    def kill_when(self, condition: Callable[[], bool]) -> None:
        """Kill it as soon as something is the case."""
        deadline = time.monotonic() + 120.0
        while not condition():
            assert self.process.poll() is None, "it came to its end"
            assert time.monotonic() < deadline, "it got nowhere"
            time.sleep(0.01)
        self._kill()

    def _kill(self) -> None:
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


def journal(out: Path) -> dict[str, tuple[int, int]]:
    """When each match of the journal was entered, and when its record was written, ns."""
    entries = {path.stem: path.stat().st_mtime_ns for path in (out / MATCHES).glob("[!.]*.json")}
    return {stem: (at, (out / "records" / f"{stem}.wsr").stat().st_mtime_ns) for stem, at in entries.items()}


def check_whole(out: Path) -> None:
    """Whatever is there under its name is whole."""
    for path in (out / "records").glob("[!.]*"):
        read_record(path)
    for path in (out / MATCHES).glob("[!.]*"):
        Entry.model_validate_json(path.read_bytes())
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
