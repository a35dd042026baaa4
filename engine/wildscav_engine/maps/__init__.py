"""Maps: generated from a config and a seed, or loaded by number."""

from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.catalogue import load_map, map_spec
from wildscav_engine.maps.errors import MapError
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap
from wildscav_engine.maps.generate import generate_map
from wildscav_engine.maps.settlements.houses import House, Room

__all__ = [
    "GENERATOR_VERSION",
    "GameMap",
    "House",
    "MapError",
    "Room",
    "generate_map",
    "load_map",
    "map_of",
    "map_spec",
]
