"""Maps: made from a config and a seed."""
