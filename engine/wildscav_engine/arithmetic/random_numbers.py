"""Counter-based random numbers without state: Philox4x32-10, keyed by the purpose of each number.

Salmon, Moraes, Dror & Shaw, "Parallel Random Numbers: As Easy as 1, 2, 3", SC 2011. The key is the seed;
the counter is (stream, frame, agent, draw). So a draw depends neither on the number of draws made elsewhere
nor on the order of agents, threads or batches.
"""

import math
import warnings
from enum import IntEnum
from typing import Any

import numpy as np

from wildscav_engine.arithmetic.elementary_functions import cosine, logarithm
from wildscav_engine.compilation.kernel import kernel

MULTIPLIER_0, MULTIPLIER_1 = np.uint64(0xD2511F53), np.uint64(0xCD9E8D57)
WEYL_0, WEYL_1 = np.uint64(0x9E3779B9), np.uint64(0xBB67AE85)
LOW_32, SHIFT_32 = np.uint64(0xFFFFFFFF), np.uint64(32)
SHIFT_11 = np.uint64(11)
TO_UNIT = 2.0**-53

Word = np.uint64 | int  # 64 bits; in kernels always np.uint64


class Stream(IntEnum):
    """The purpose of a random number. Values are never reused, because old records depend on them."""

    TERRAIN = 1
    HOUSES = 2
    VEGETATION = 3
    LOCATIONS = 4
    STARTS = 10
    TARGET = 11
    SUPPLY_PLACE = 12
    SUPPLY_QUANTITY = 13
    RESPAWN = 14
    ROBOT = 15
    AGENT_SEED = 16
    WAVE_CENTER = 17
    TURNS = 18
    BOX_SERIAL = 19
    SUITE = 20
    CATALOGUE = 21
    ZONE = 22
    MAP_POOL = 23
    HOT_SPOT = 24
    SPREAD = 25
    COUNTRY = 30
    HIDING = 31


@kernel
def philox(seed: Word, stream: int, frame: int, agent: int, draw: int) -> tuple[Word, Word]:
    """Return 128 random bits as two unsigned 64-bit words. Only the low 32 bits of each counter are used."""
    key = np.uint64(seed)
    k0, k1 = key & LOW_32, key >> SHIFT_32
    c0, c1 = np.uint64(stream) & LOW_32, np.uint64(frame) & LOW_32
    c2, c3 = np.uint64(agent) & LOW_32, np.uint64(draw) & LOW_32
    for _ in range(10):
        product_0, product_1 = MULTIPLIER_0 * c0, MULTIPLIER_1 * c2
        c0, c1, c2, c3 = (
            (product_1 >> SHIFT_32) ^ c1 ^ k0,
            product_1 & LOW_32,
            (product_0 >> SHIFT_32) ^ c3 ^ k1,
            product_0 & LOW_32,
        )
        k0, k1 = (k0 + WEYL_0) & LOW_32, (k1 + WEYL_1) & LOW_32
    return (c0 << SHIFT_32) | c1, (c2 << SHIFT_32) | c3


@kernel
def to_unit(word: Word) -> float:
    """Return 64 random bits as a random number in [0, 1)."""
    return np.float64(np.uint64(word) >> SHIFT_11) * TO_UNIT


@kernel
def uniform(seed: Word, stream: int, frame: int, agent: int, draw: int) -> float:
    """Return a random number in [0, 1)."""
    return to_unit(philox(seed, stream, frame, agent, draw)[0])


@kernel
def uniform_in(low: float, high: float, seed: Word, stream: int, frame: int, agent: int, draw: int) -> float:
    """Return a random number in [low, high)."""
    return low + (high - low) * uniform(seed, stream, frame, agent, draw)


@kernel
def integer_in(low: int, high: int, seed: Word, stream: int, frame: int, agent: int, draw: int) -> int:
    """Return a random integer from low to high, both included."""
    span = high - low + 1
    return low + min(span - 1, int(uniform(seed, stream, frame, agent, draw) * span))


@kernel
def normal(seed: Word, stream: int, frame: int, agent: int, draw: int) -> float:
    """Return a standard normal random number (Box & Muller 1958)."""
    first, second = philox(seed, stream, frame, agent, draw)
    radius_draw = (np.float64(np.uint64(first) >> SHIFT_11) + 1.0) * TO_UNIT
    angle = np.float64(np.uint64(second) >> SHIFT_11) * TO_UNIT * 360.0
    return math.sqrt(-2.0 * logarithm(radius_draw)) * cosine(angle)


class RandomStream:
    """A sequence of draws from one stream, for code that runs once (maps, set-up), not every frame."""

    def __init__(self, seed: int, stream: Stream, agent: int = 0) -> None:
        self._seed, self._stream, self._agent = np.uint64(seed), int(stream), agent
        self._draws = 0

    def uniform(self, low: float = 0.0, high: float = 1.0) -> float:
        """Return a random number in [low, high)."""
        self._draws += 1
        return float(uniform_in(low, high, self._seed, self._stream, 0, self._agent, self._draws))

    def integer(self, low: int, high: int) -> int:
        """Return a random integer from low to high, both included."""
        self._draws += 1
        return int(integer_in(low, high, self._seed, self._stream, 0, self._agent, self._draws))

    def word(self) -> int:
        """Return 64 random bits as an integer, to seed something else."""
        self._draws += 1
        return int(philox(self._seed, self._stream, 0, self._agent, self._draws)[0])


def __getattr__(name: str) -> Any:
    """Return a name by its old spelling, for one release."""
    if name != "Dice":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    warnings.warn("Dice is called RandomStream now", DeprecationWarning, stacklevel=2)
    return RandomStream
