"""The names of the levels, for options that take one."""


def level_names() -> tuple[str, ...]:
    """Return the names of all levels, from the easiest to the hardest."""
    from wildscav_engine.maps.levels import LEVELS

    return tuple(LEVELS)
