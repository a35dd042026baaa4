"""Whose turn comes first: in every frame, all orders of the seats are equally likely.

So of any seats that want the same thing, however many they are, each comes first equally often.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import LOW_32, SHIFT_32, Stream, Word, philox
from wildscav_engine.compilation.kernel import kernel


@kernel
def draw_turns(seed: Word, frame: int, order: NDArray[np.int32]) -> None:
    """Write the seats in the order of a frame, which depends on nothing else.

    Durstenfeld, "Algorithm 235: Random permutation", 1964. A choice of n takes 32 random bits, so that no
    order of A seats is likelier than another by a share of more than A² / 2³².

    Args:
        seed: Of the match.
        frame: Which one.
        order: (A,) written.
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
