"""What benchmarks share: measuring in turns, and figures as a table and as JSON."""

import json
import os
import platform
import resource
import socket
import time
from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import numpy as np
import typer
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

PACKAGES = ("wildscav", "numpy", "numba", "grpcio", "protobuf")
JsonFile = Annotated[
    Path | None, typer.Option("--json", help="File for the figures and a description of the machine.")
]


class Figure(NamedTuple):
    """One measured number."""

    name: str
    value: float
    unit: str
    note: str = ""


def many(step: Callable[[int], object], steps: int) -> Callable[[], None]:
    """Return what does some numbered steps."""

    def work() -> None:
        for number in range(steps):
            step(number)

    return work


def in_turns(
    works: Sequence[Callable[[], object]],
    rounds: int,
    clock: Callable[[], float] = time.perf_counter,
    before: Callable[[], object] = lambda: None,
) -> NDArray[np.float64]:
    """Return (rounds, works) s that works take, in turns: all see the same load. One more round warms up.

    What is done ``before`` each of them is not counted.
    """
    taken = np.empty((rounds + 1, len(works)))
    for row in taken:
        for place, work in enumerate(works):
            before()
            started = clock()
            work()
            row[place] = clock() - started
    return taken[1:]


def ratio(name: str, ratios: NDArray[np.float64]) -> Figure:
    """Return the median of ratios, with their range."""
    spread = f"median of {len(ratios)}, {ratios.min():.2f} to {ratios.max():.2f}"
    return Figure(name, float(np.median(ratios)), "×", spread)


def time_of_children() -> float:
    """Return the processor time of the processes that were started here and have ended, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def processor_time(process: int) -> float:
    """Return the processor time that a process has used, s."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def children_of(process: int, program: bytes = b"spawn_main") -> list[int]:
    """Return the processes that a process started with a program in Python, such as the web server."""
    found = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    return [int(one) for one in found if program in Path(f"/proc/{one}/cmdline").read_bytes()]


def free_port() -> int:
    """Return a port of this machine that nothing listens at."""
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return int(found.getsockname()[1])


def publish(title: str, figures: Sequence[Figure], json_file: Path | None) -> None:
    """Print figures as a table; write them as JSON if a file is named."""
    table = Table("figure", "value", "unit", "", title=title)
    table.columns[1].justify = "right"
    for figure in figures:
        table.add_row(figure.name, readable(figure.value), figure.unit, figure.note)
    console = Console()
    console.print(table)
    about = machine()
    console.print(f"{about['processor']}, {about['cores']} cores, load {about['load']:.1f}", style="dim")
    if json_file is not None:
        content = {"title": title, "machine": about, "figures": [figure._asdict() for figure in figures]}
        json_file.write_text(json.dumps(content, indent=2) + "\n", "utf-8")


def readable(value: float) -> str:
    """Return a number with at least three digits and separated thousands."""
    digits = 0 if abs(value) >= 100 else 1 if abs(value) >= 10 else 2
    return f"{value:,.{digits}f}"


def machine() -> dict[str, Any]:
    """Describe the machine and the software that a measurement was made on."""
    return {
        "processor": _processor(),
        "cores": len(os.sched_getaffinity(0)),
        "memory_gb": round(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES") / 1e9, 1),
        "system": f"{platform.system()} {platform.release()}",
        "python": platform.python_version(),
        "packages": {name: version(name) for name in PACKAGES},
        "load": os.getloadavg()[0],
    }


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text("utf-8").splitlines()
    except OSError:
        return platform.processor()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()
