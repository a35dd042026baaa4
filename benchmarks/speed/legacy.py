"""Actions a second of the unmodified original client, with our engine and with one that does nothing."""

import shlex
import statistics
import subprocess
import sys
import tempfile
import venv
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from benchmarks.report import Figure, JsonFile, free_port, publish

from wildscav_engine.compilation.caching.cache_folders import cache_root
from wildscav_legacy.install import PROGRAM, install_engine, install_maps, missing_maps
from wildscav_server.hosting.precompile import precompile

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
    """Return the Python of a virtual environment with the client, which is created if it does not exist."""
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


def rates(python: Path, folder: Path, engine: Path, titles: Sequence[str]) -> list[float]:
    """Return the actions a second in some modes: calls of ``make_action``, each after ``get_state_all``."""
    port = free_port()
    modes = [",".join(map(str, MODES[title])) for title in titles]
    arguments = [python, HERE / "legacy_player.py", folder, engine, port, *modes]
    done = subprocess.run(
        [str(argument) for argument in arguments], check=True, capture_output=True, text=True
    )
    lines = (line.partition("rate ") for line in done.stdout.splitlines())
    return [float(value) for start, name, value in lines if name and not start]


def figures_of(title: str, pairs: Sequence[tuple[float, float]]) -> list[Figure]:
    """Return the figures of a mode from its rates with our engine and with the one that does nothing."""
    real, idle = (statistics.median(column) for column in zip(*pairs, strict=True))
    agents = MODES[title][1]
    who = f"{agents} agent{'s' if agents > 1 else ''}"
    return [
        Figure(title, real, "actions/s", f"{who}{NEEDED_RATES.get(title, '')}"),
        Figure(f"{title}, an engine that does nothing", idle, "actions/s", who),
        Figure(f"{title} over that", real / idle, "", f"median of {len(pairs)}; needed: {NEEDED}"),
    ]


def main(
    json: JsonFile = None,
    mode: Annotated[list[str] | None, typer.Option(help=f"Of {', '.join(MODES)}; all by default.")] = None,
    rounds: Annotated[int, typer.Option(min=1, help="Rounds; each takes 10 to 15 s a mode.")] = REPEATS,
) -> None:
    """Measure the drop-in for the original's engine."""
    titles = mode or list(MODES)
    if unknown := set(titles) - set(MODES):
        raise typer.BadParameter(f"{', '.join(unknown)}: must be of {', '.join(MODES)}")
    python = client_environment(cache_root().parent / "inspirai-fps-0.0.3")
    precompile(())
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        ours, idle = install_engine(folder / "engine").parent, idle_engine(folder / "idle")
        list(install_maps(missing_maps([1], folder / "maps"), folder / "maps", 1))
        # Measured in turns, so that both see the same load of the machine.
        runs = [[rates(python, folder, engine, titles) for engine in (ours, idle)] for _ in range(rounds)]
    figures = []
    for number, title in enumerate(titles):
        pairs = [(with_ours[number], with_idle[number]) for with_ours, with_idle in runs]
        figures += figures_of(title, pairs)
    publish("The original's client", figures, json)


if __name__ == "__main__":
    typer.run(main)
