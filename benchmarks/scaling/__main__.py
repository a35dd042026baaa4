"""How cost grows with work: six curves, of which any can be measured by name.

    python -m benchmarks.scaling [agents] [maps] [matches] [results] [spectators] [nodes] [--most N]

Each curve takes the place of its last one in ``benchmarks/results/scaling.json``, of which
``docs/images/scaling.py`` makes the picture in docs/performance.md. The nodes of a cluster are simulated.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import typer
from benchmarks.report import machine
from benchmarks.scaling.engine import HOUSES, agents, map_size
from benchmarks.scaling.matches import matches
from benchmarks.scaling.nodes import nodes
from benchmarks.scaling.season import SIZES, results
from benchmarks.scaling.spectators import spectators
from rich.console import Console
from rich.progress import track

RESULTS = Path(__file__).parents[1] / "results" / "scaling.json"
CONSOLE = Console(stderr=True)


class Curve(NamedTuple):
    """How something grows."""

    measure: Callable[[int], dict[str, float]]  # at one size
    sizes: Sequence[int]


CURVES = {
    "agents": Curve(agents, (10, 30, 100, 300, 1000)),
    "maps": Curve(map_size, tuple(HOUSES)),
    "matches": Curve(matches, (1, 2, 4, 8, 16, 32, 64)),
    "results": Curve(results, tuple(SIZES)),
    "spectators": Curve(spectators, (1, 5, 20, 50, 100, 200, 500)),
    "nodes": Curve(nodes, tuple(2**power for power in range(9))),
}


def main(
    names: Annotated[
        list[str] | None, typer.Argument(help=f"Curves: {', '.join(CURVES)}. All if none.")
    ] = None,
    most: Annotated[int, typer.Option(help="Leave out sizes above this.")] = 1_000_000,
    file: Annotated[Path, typer.Option("--json", help="File for the curves.")] = RESULTS,
) -> None:
    """Measure curves, and write them beside those that were measured before."""
    if unknown := set(names or ()) - set(CURVES):
        raise typer.BadParameter(f"{', '.join(sorted(unknown))}: there are {', '.join(CURVES)}")
    for name in names or CURVES:
        curve = CURVES[name]
        sizes = [size for size in curve.sizes if size <= most]
        points: list[dict[str, float]] = []
        for size in track(sizes, name, console=CONSOLE, transient=True):
            points.append({"size": size} | curve.measure(size))
            print(name + ": " + ", ".join(f"{what} {value:.4g}" for what, value in points[-1].items()))
            _write(file, name, points)


def _write(file: Path, name: str, points: Sequence[dict[str, float]]) -> None:
    """Write a curve as far as it is measured, so that what breaks a large size loses nothing."""
    written = json.loads(file.read_text("utf-8")) if file.exists() else {}
    written[name] = {"machine": machine(), "points": points}
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps(written, indent=1) + "\n", "utf-8")


if __name__ == "__main__":
    typer.run(main)
