"""The common part of all imports: their result, and limiting the depth of lakes."""

from typing import NamedTuple

import numpy as np

from wildscav_engine.maps.base import NAME_LIMIT, Base, BaseError, check_base
from wildscav_engine.maps.ground.terrain import DEEPEST_WATER

NOTEWORTHY = 0.01  # m; lake beds raised by less, as by rounding, are not reported


class Imported(NamedTuple):
    """A base, and notes on what was changed or left out."""

    base: Base
    notes: tuple[str, ...]  # one line each


def finish(base: Base, notes: list[str]) -> Imported:
    """Limit the depth of a base's lakes and check the base.

    Raises:
        BaseError: No map can be made on it.
    """
    base = base._replace(name="".join(filter(str.isprintable, base.name))[:NAME_LIMIT])
    ground = np.zeros(1) if base.heights is None else base.heights
    if ground.max() <= base.water_level:
        raise BaseError(
            f"the water level is {base.water_level:g} m, but the highest ground is at {ground.max():g} m"
        )
    if base.heights is not None:
        depth = float(base.water_level - base.heights.min())
        base = base._replace(heights=np.maximum(base.heights, base.water_level - DEEPEST_WATER))
        if depth > DEEPEST_WATER + NOTEWORTHY:
            notes = [
                *notes,
                f"lake beds up to {depth:.1f} m deep are raised to {DEEPEST_WATER} m: agents wade, not swim",
            ]
    check_base(base)
    return Imported(base, tuple(notes))
