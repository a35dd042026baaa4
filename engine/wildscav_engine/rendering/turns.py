"""Which images each of several threads renders: those that it is the first to come to."""

from wildscav_engine.compilation.kernel import inlined_kernel
from wildscav_engine.parallel.turns import Turns

TAKEN_ALREADY = -1


@inlined_kernel
def item_at(turns: Turns, turn: int) -> int:
    """Return the image of a turn, which the thread must then render, or TAKEN_ALREADY: see ``items_of``."""
    if turns.order.shape[0] == 0:
        return turn
    item = turns.order[turn]
    if turns.taken[item] != 0:
        return TAKEN_ALREADY
    turns.taken[item] = 1
    return int(item)
