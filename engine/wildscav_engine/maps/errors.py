"""The error for maps that cannot be made."""


class MapError(ValueError):
    """No map can be made from a config and a seed; the message names the field and its possible values."""
