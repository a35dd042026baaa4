"""Which Node.js builds the viewer: the system's if it is new enough, else one in .venv."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).parents[2] / ".ci" / "npm"
NODE = shutil.which("node")


def program(path: Path, text: str) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(0o755)


@pytest.mark.skipif(NODE is None, reason="needs Node.js")
@pytest.mark.parametrize(
    ("version", "used"),
    [
        *(("18.20.0", "own"), ("20.18.3", "own"), ("20.19.0", "system"), ("21.7.0", "own")),
        *(("22.11.0", "own"), ("22.12.0", "system"), ("24.1.0", "system")),
    ],
)
def test_the_systems_is_used_if_vite_takes_it(tmp_path: Path, version: str, used: str) -> None:
    told = f"Object.defineProperty(process, 'versions', {{value: {{node: '{version}'}}}});"
    program(tmp_path / "system" / "node", f'exec {NODE} -e "{told} $2"')
    program(tmp_path / "system" / "npm", "echo system $*")
    program(tmp_path / ".venv" / "node" / "bin" / "npm", "echo own $*")
    (tmp_path / "platform" / "wildscav_stage" / "viewer").mkdir(parents=True)
    (tmp_path / ".ci").mkdir()
    script = shutil.copy(SCRIPT, tmp_path / ".ci" / "npm")

    path = f"{tmp_path / 'system'}:{os.environ['PATH']}"
    done = subprocess.run([script, "ci"], env={"PATH": path}, capture_output=True, text=True)

    assert (done.stdout, done.stderr) == (f"{used} ci\n", "")
