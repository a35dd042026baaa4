"""Maps: made from a config and a seed."""

from wildscav_engine.maps.game_map import GameMap, House
from wildscav_engine.maps.generate import MapError, generate_map, map_of

__all__ = ["GameMap", "House", "MapError", "generate_map", "map_of"]
