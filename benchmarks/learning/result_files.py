"""Folders of results for the benchmarks of learning: a file for each run, written when the run has ended."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

from rich.console import Console

CONSOLE = Console(stderr=True)


def add(path: Path, measure: Callable[[], Any]) -> None:
    """Measure and write a result, unless it is there."""
    if not path.exists():
        CONSOLE.print(path.stem)
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(json.dumps(measure()) + "\n", "utf-8")


def results_in(folder: Path, pattern: str = "*.json") -> list[Any]:
    """Return the results of a folder, by the names of their files."""
    return [json.loads(path.read_text("utf-8")) for path in sorted(folder.glob(pattern))]


def numbers(text: str) -> list[int]:
    """Return integers that are separated by commas."""
    return [int(part) for part in text.split(",") if part.strip()]
