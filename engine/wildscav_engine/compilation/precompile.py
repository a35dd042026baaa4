"""Compiling ahead: while the first map is made, another process compiles already what plays on it.

Numba compiles a kernel when it is first called, one after the other, on one processor core. With nothing
compiled that takes two minutes, of which another core can do half. Processes take turns at a kernel (see
``kernel``), so none is compiled twice: who comes second finds it kept on disk.
"""

import atexit
import functools
import importlib
import subprocess
import sys
from contextlib import suppress

from wildscav_engine.compilation.cache_folders import cache_folder
from wildscav_engine.compilation.kernel import config
from wildscav_engine.compilation.sources import PACKAGE
from wildscav_engine.parallel.threads import cores

# Functions that compile what takes longest, and the file whose kernels are compiled last of all.
COMPILERS = (
    "wildscav_engine.simulation.batch_kernels:compile_matches",
    "wildscav_engine.rendering.trace:depths_tracer",
)
LAST = PACKAGE / "simulation" / "batch_kernels.py"


@functools.cache
def compile_ahead() -> None:
    """Start a process that compiles what plays matches and makes depth maps, once, unless that is done.

    It ends with this process, if not before. Where none can be started, nothing is lost but time.
    """
    is_done = any(cache_folder(LAST).rglob("*.nbi"))
    if is_done or config.DISABLE_JIT or cores() < 2:
        return
    nothing = subprocess.DEVNULL
    with suppress(OSError):
        command = [sys.executable, "-m", __name__]
        atexit.register(_end, subprocess.Popen(command, stdin=nothing, stdout=nothing, stderr=nothing))


def _end(process: "subprocess.Popen[bytes]") -> None:
    process.kill()
    process.wait()


def main() -> None:
    """Compile everything."""
    for compiler in COMPILERS:
        module, function = compiler.split(":")
        getattr(importlib.import_module(module), function)()


if __name__ == "__main__":
    main()
