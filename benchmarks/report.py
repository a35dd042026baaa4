"""The output of every benchmark: figures as a table, and as JSON with a description of the machine."""

import json
import os
import platform
from collections.abc import Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, NamedTuple

import typer
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
