"""Compilation ahead of time: while the first map is generated, a second process compiles the simulation.

Numba compiles each kernel when it is first called, one after another, on one processor core. With nothing
compiled, that takes most of a minute, and a second core can do half of the work. A kernel is locked while it
is being compiled (see ``compiler.py``). A second process waits and then loads it from the cache on disk, so
no kernel is compiled twice.
"""

import atexit
import functools
import importlib
import subprocess
import sys
from contextlib import suppress

from wildscav_engine.compilation.caching.cache_folders import cache_folder, shipped_folder
from wildscav_engine.compilation.caching.sources import PACKAGE
from wildscav_engine.compilation.kernel import PLAIN
from wildscav_engine.parallel.threads import cores

# The functions that compile the most expensive kernels, and the file whose kernels are compiled last.
COMPILERS = (
    "wildscav_engine.simulation.batch_kernels:compile_matches",
    "wildscav_engine.rendering.trace:depths_tracer",
)
LAST = PACKAGE / "simulation" / "batch_kernels.py"


@functools.cache
def compile_ahead() -> None:
    """Start a process that compiles the kernels of matches and depth maps, once, unless they are compiled.

    It ends with this process at the latest. If it cannot be started, kernels are compiled on first use.
    """
    is_done = bool(shipped_folder(LAST)) or any(cache_folder(LAST).rglob("*.nbi"))
    if is_done or PLAIN or cores() < 2:
        return
    nothing = subprocess.DEVNULL
    with suppress(OSError):
        command = [sys.executable, "-m", __name__]
        atexit.register(_end, subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing))


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    process.wait()


def main() -> None:
    """Run all compile functions."""
    for compiler in COMPILERS:
        module, function = compiler.split(":")
        getattr(importlib.import_module(module), function)()


if __name__ == "__main__":
    main()
