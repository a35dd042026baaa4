"""The order in which seats act within a frame: a random permutation, with all orders equally likely.

Of any number of seats that want the same box, each is therefore first equally often.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import LOW_32, SHIFT_32, Stream, Word, philox
from wildscav_engine.compilation.kernel import kernel


@kernel
def draw_turns(seed: Word, frame: int, order: NDArray[np.int32]) -> None:
    """Write (A,) the order of the seats in a frame, which depends only on the seed and the frame.

    Durstenfeld, "Algorithm 235: Random permutation", 1964. A choice among n takes 32 random bits, so the
    probabilities of the orders of A seats differ by a relative amount of at most A² / 2³².
    """
    seats = order.shape[0]
    for seat in range(seats):
        order[seat] = seat
    one: Word = np.uint64(0)
    two: Word = np.uint64(0)
    for drawn in range(seats - 1):
        # Four choices share one call, which gives 128 bits.
        if drawn % 4 == 0:
            one, two = philox(seed, Stream.TURNS, frame, 0, drawn // 4)
        elif drawn % 4 == 2:
            one = two
        bits = np.uint64(one) & LOW_32 if drawn % 2 == 0 else np.uint64(one) >> SHIFT_32
        last = seats - 1 - drawn
        chosen = np.int64((bits * np.uint64(last + 1)) >> SHIFT_32)
        seat = order[last]
        order[last] = order[chosen]
        order[chosen] = seat
