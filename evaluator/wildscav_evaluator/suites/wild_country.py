"""The matches of the suite ``wild`` in country that must be seen to be crossed."""

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.maps.pools import LEVELS
from wildscav_engine.specs.map_spec import MapConfig

TIME_LIMIT = 120.0  # s, four times what the longest ways take at full speed


def expert_map(_: Dice) -> MapConfig:
    """Return the config of maps at level expert: few ways lead through them, and targets are hidden."""
    return LEVELS["expert"]
