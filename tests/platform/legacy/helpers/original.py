"""The original's client, from PyPI, in an environment of its own."""

import fcntl
import json
import os
import shutil
import subprocess
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from tests.ports import free_ports

from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_legacy.install import install_engine, write_map

PACKAGES = (
    "inspirai-fps==0.0.3",
    *("numpy<2", "protobuf==3.20.*", "grpcio", "trimesh", "Pillow", "rich"),
)
SCRIPTS = Path(__file__).parents[1] / "scripts"


def environment() -> Path:
    """Return the interpreter of the client's environment, which is made once and kept."""
    folder = cache_root().parent / "inspirai-fps-0.0.3"
    done = folder / "done"
    folder.parent.mkdir(parents=True, exist_ok=True)
    with folder.with_name(f"{folder.name}.lock").open("w") as lock:  # tests run in several processes
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not done.exists():
            _make(folder)
            done.touch()
    return folder / "bin" / "python"


def _make(folder: Path) -> None:
    shutil.rmtree(folder, ignore_errors=True)
    venv.create(folder, with_pip=True)
    python = folder / "bin" / "python"
    pip = [python, "-I", "-m", "pip", "--disable-pip-version-check", "install", "--quiet", *PACKAGES]
    made = subprocess.run(pip, capture_output=True, text=True)
    if made.returncode != 0:
        pytest.skip(f"the original's client cannot be installed: {made.stderr.strip().splitlines()[-1]}")


def play(script: str, folder: Path, *arguments: object) -> Any:
    """Run a script of the client in an installed folder, and return what it writes down."""
    written = folder / f"{script}.json"
    given = [argument if isinstance(argument, str | Path) else json.dumps(argument) for argument in arguments]
    run([SCRIPTS / f"{script}.py", folder, str(free_ports()), *given, written], folder)
    return json.loads(written.read_text())


def run(arguments: Sequence[str | Path], folder: Path, timeout: float = 120.0) -> str:
    """Run the client's Python in a folder, and return what it prints."""
    done = subprocess.run(
        [environment(), *arguments],
        cwd=folder,
        # Whatever the client's own code is found by is nothing to the engine.
        env={**os.environ, "PYTHONPATH": str(folder / "logs")},
        capture_output=True,
        text=True,
        timeout=timeout,
    )
    assert done.returncode == 0, f"{done.stderr}\n{logs(folder)}"
    return done.stdout


def logs(folder: Path) -> str:
    """Return all that the engine said."""
    return "\n".join(path.read_text() for path in sorted((folder / "logs").glob("*.log")))


def install(folder: Path, *maps: int) -> None:
    """Make a folder that the client can be pointed at, as ``wildscav-legacy install`` does."""
    install_engine(folder / "engine")
    (folder / "maps").mkdir()
    for map_id in maps:
        write_map(map_id, folder / "maps")
