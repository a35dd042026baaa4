# ruff: noqa: INP001 - a script, not part of a package
"""Make scaling.png, the curves in docs/performance.md, from the results in benchmarks/results.

python docs/images/scaling.py
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

from matplotlib import pyplot as plt
from matplotlib.ticker import FuncFormatter, NullFormatter

PICTURE = Path(__file__).with_name("scaling.png")
RESULTS = Path(__file__).parents[2] / "benchmarks" / "results" / "scaling.json"
COLUMNS = 3
NUMBERS = FuncFormatter(lambda value, _: f"{value:,.10g}")


class Panel(NamedTuple):
    """How one curve is drawn."""

    name: str  # in the results
    size: str  # what grows
    unit: str
    lines: dict[str, tuple[str, float]]  # names of the figures: how they are called, and times what
    limit: str  # what is written under the curve
    level: float | None = None  # of the limit, in the unit
    across: float | None = None  # where the limit is on the axis of sizes


def panels(curves: dict[str, Any]) -> tuple[Panel, ...]:
    """Return the panels; limits that were measured are those of the largest size."""
    last = {name: curve["points"][-1] for name, curve in curves.items()}
    cores = curves["matches"]["machine"]["cores"]
    most = 1000 / last["spectators"]["server_milliseconds"]
    return (
        Panel(
            "agents",
            "agents in a battle on 1 km²",
            "µs for an agent's step, one core",
            {"microseconds": ("step", 1)},
            f"limit: memory bandwidth, {last['agents']['kilobytes'] / 1000:.0f} kB an agent",
            last["agents"]["memory_microseconds"],
        ),
        Panel(
            "maps",
            "side of the map, m",
            "s, or GB",
            {"seconds": ("time, one core, s", 1), "megabytes": ("peak memory, GB", 1e-3)},
            "limit: one core a map; memory, 1 GB",
        ),
        Panel(
            "matches",
            f"matches on a server with {cores} cores",
            "steps/s",
            {"steps_a_second": ("together", 1), "of_the_slowest": ("the slowest match", 1)},
            "limit: one event loop a core",
            cores * 1e6 / last["matches"]["server_microseconds"],
        ),
        Panel(
            "results",
            "results in a season",
            "ms of one core",
            {
                "boards_of_ladder": ("boards after a ladder's match", 1000),
                "boards_of_suite": ("boards after a suite's match", 1000),
                "stored": ("storing a result", 1000),
                "board_page": ("page of a board", 1000),
                "match_page": ("page of a match", 1000),
            },
            "limit: one writer, boards every 2 s",
            2000,
        ),
        Panel(
            "spectators",
            "spectators of a live match",
            "ms",
            {"delay": ("until a move is told", 1000), "delay_95": ("95 % within", 1000)},
            f"limit: one process, {most:.0f} spectators",
            across=most,
        ),
        Panel(
            "nodes",
            "nodes of 16 cores, simulated",
            "matches/s",
            {
                "quick_agents": ("agents as quick as homing", 1),
                "thinking_agents": ("agents that think 10 ms", 1),
            },
            "limit: one command",
            1 / 0.0099,
        ),
    )


def draw(axes: Any, panel: Panel, points: list[dict[str, float]]) -> None:
    """Draw one curve, with its limit as a dashed line."""
    sizes = [point["size"] for point in points]
    for name, (label, factor) in panel.lines.items():
        values = [factor * point[name] for point in points]
        axes.loglog(sizes, values, marker="o", markersize=3, linewidth=1.4, label=label)
    if panel.level is not None:
        axes.axhline(panel.level, color="0.4", linestyle="--", linewidth=1)
    if panel.across is not None:
        axes.axvline(panel.across, color="0.4", linestyle="--", linewidth=1)
    axes.set_title(panel.limit, fontsize=9, color="0.3", loc="left")
    axes.set_xlabel(panel.size)
    axes.set_ylabel(panel.unit)
    low, high = axes.get_ylim()
    room = (high / low) ** (0.11 * len(panel.lines) + 0.02)  # for the legend
    axes.set_ylim(low / 1.5, 1.5 * high * room)
    axes.tick_params(labelsize=8)
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter(NUMBERS)
        axis.set_minor_formatter(NullFormatter())
    axes.grid(alpha=0.25)
    if len(panel.lines) > 1:
        axes.legend(loc="upper left", fontsize=7.5, framealpha=0.9, edgecolor="none")


def main() -> None:
    """Draw all curves."""
    curves = json.loads(RESULTS.read_text("utf-8"))
    drawn = panels(curves)
    figure, grid = plt.subplots(len(drawn) // COLUMNS, COLUMNS, figsize=(10.8, 6.6), layout="constrained")
    for axes, panel in zip(grid.flat, drawn, strict=True):
        draw(axes, panel, curves[panel.name]["points"])
    figure.savefig(PICTURE, dpi=110)


if __name__ == "__main__":
    main()
