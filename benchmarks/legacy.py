"""Actions a second of the original's client, unmodified, beside those with an engine that does nothing."""

import shlex
import socket
import statistics
import subprocess
import sys
import tempfile
import venv
from pathlib import Path

import typer
from report import Figure, JsonFile, publish

from wildscav.legacy.install import PROGRAM, install_engine, install_maps, missing_maps
from wildscav.server.warm import warm
from wildscav_engine.kernel import cache_root

HERE = Path(__file__).parent
PACKAGES = (
    *("inspirai-fps==0.0.3", "numpy<2", "protobuf==3.20.*"),
    *("grpcio", "trimesh", "Pillow", "rich"),
)
MODES = {"navigation": (0, 1, 2000), "gathering": (1, 1, 300), "battle": (2, 10, 50)}  # mode, agents, steps
REPEATS = 3
NEEDED_RATES = {"navigation": "; needed: 1,000"}
NEEDED = 0.6  # of the rate with an engine that does nothing


def client_environment(folder: Path) -> Path:
    """Return the interpreter of an environment with the client, which is made if it is not there."""
    python = folder / "bin" / "python"
    if not (folder / "done").exists():
        venv.create(folder, with_pip=True, clear=True)
        subprocess.run([python, "-I", "-m", "pip", "install", "--quiet", *PACKAGES], check=True)
        (folder / "done").touch()
    return python


def idle_engine(folder: Path) -> Path:
    """Write the engine that does nothing into a folder, and return the folder."""
    folder.mkdir()
    command = shlex.join([sys.executable, str(HERE / "legacy_idle.py")])
    (folder / PROGRAM).write_text(f'#!/bin/sh\nexec {command} "$@"\n')
    (folder / PROGRAM).chmod(0o755)
    return folder


def rates(python: Path, folder: Path, engine: Path) -> list[float]:
    """Return actions a second in each mode: calls of ``make_action``, each after ``get_state_all``."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        port = one.getsockname()[1]
    modes = [",".join(map(str, mode)) for mode in MODES.values()]
    arguments = [python, HERE / "legacy_player.py", folder, engine, port, *modes]
    done = subprocess.run(
        [str(argument) for argument in arguments], check=True, capture_output=True, text=True
    )
    lines = (line.partition("rate ") for line in done.stdout.splitlines())
    return [float(value) for start, name, value in lines if name and not start]


def main(json: JsonFile = None) -> None:
    """Measure the drop-in for the original's engine."""
    python = client_environment(cache_root().parent / "inspirai-fps-0.0.3")
    warm(())
    figures = []
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ours, idle = install_engine(folder / "engine").parent, idle_engine(folder / "idle")
        list(install_maps(missing_maps([1], folder / "maps"), folder / "maps", 1))
        # Taken in turns, so that both see the same machine.
        runs = [[rates(python, folder, engine) for engine in (ours, idle)] for _ in range(REPEATS)]
        for number, (title, mode) in enumerate(MODES.items()):
            pairs = [(with_ours[number], with_idle[number]) for with_ours, with_idle in runs]
            real, empty = (statistics.median(column) for column in zip(*pairs, strict=True))
            who = f"{mode[1]} agent{'s' if mode[1] > 1 else ''}"
            figures += [
                Figure(title, real, "actions/s", f"{who}{NEEDED_RATES.get(title, '')}"),
                Figure(f"{title}, an engine that does nothing", empty, "actions/s", who),
                Figure(f"{title} over that", real / empty, "", f"median of {REPEATS}; needed: {NEEDED}"),
            ]
    publish("The original's client", figures, json)


if __name__ == "__main__":
    typer.run(main)
