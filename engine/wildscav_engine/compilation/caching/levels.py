"""The levels of x86-64 for which a wheel brings machine code.

A level is a set of instructions that processors of a certain age have; compilers and Linux distributions know
them by these names. Kernels give the same bits at every level and on every processor.
"""

import functools
import os
from typing import Any

# What a processor needs for each level, by LLVM's names, best level first.
_LEVEL_3 = ("avx", "avx2", "bmi", "bmi2", "f16c", "fma", "lzcnt", "movbe", "xsave")
LEVELS = {
    "x86-64-v4": (*_LEVEL_3, "avx512bw", "avx512cd", "avx512dq", "avx512f", "avx512vl"),
    "x86-64-v3": _LEVEL_3,
}

# The variables with which Numba compiles for another processor. Whoever sets one gets no code of a level.
CHOICE = ("NUMBA_CPU_NAME", "NUMBA_CPU_FEATURES")


def processor_of(level: str) -> tuple[str, str]:
    """Return the name of a processor and its further features, in the order of ``CHOICE``."""
    return level, ""


@functools.cache
def levels() -> tuple[str, ...]:
    """Return the levels whose machine code this process may run, best first."""
    from llvmlite import binding

    if any(name in os.environ for name in CHOICE):
        return ()
    llvm: Any = binding
    features = llvm.get_host_cpu_features()
    return tuple(level for level, needed in LEVELS.items() if all(map(features.get, needed)))
