"""Submissions written for a test, and the command line as its user runs it."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav_evaluator.submissions.submission import Submission, load_submission

HEAD = """
import os, signal, subprocess, sys, time
from wildscav import Action, Agent

class Player(Agent):
"""

MANIFEST = """
name = "{name}"
version = "1.0.0"
entry_point = "agent:Player"
tracks = {tracks}
"""


@pytest.fixture
def submit(tmp_path: Path) -> Callable[..., Submission]:
    """Write a submission whose agent has the given body of a class, or whose file has the given code."""

    def write(
        name: str, body: str = "", *, code: str | None = None, tracks: str = '["navigation"]'
    ) -> Submission:
        folder = tmp_path / "submissions" / name
        folder.mkdir(parents=True)
        (folder / "submission.toml").write_text(MANIFEST.format(name=name, tracks=tracks))
        (folder / "agent.py").write_text(HEAD + body if code is None else code)
        return load_submission(folder)

    return write


@pytest.fixture
def wildscav() -> Callable[..., "subprocess.CompletedProcess[str]"]:
    """Run the `wildscav` command in a process of its own."""

    def run(*arguments: object, **options: object) -> "subprocess.CompletedProcess[str]":
        command = [str(Path(sys.executable).parent / "wildscav"), *map(str, arguments)]
        environment = {**os.environ, "COLUMNS": "80"}
        return subprocess.run(  # type: ignore[call-overload, no-any-return]
            command, capture_output=True, text=True, env=environment, timeout=300, **options
        )

    return run
