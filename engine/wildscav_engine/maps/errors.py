"""What can be wrong with a map."""


class MapError(ValueError):
    """No map can be made from a config and a seed; the message names the field and what is possible."""
