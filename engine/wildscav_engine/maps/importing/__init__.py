"""Importing height maps and triangle meshes as bases of maps. Needs the extra ``maps``."""

from wildscav_engine.maps.base import Imported
from wildscav_engine.maps.importing.height_map import import_height_map
from wildscav_engine.maps.importing.mesh import import_mesh

__all__ = ["Imported", "import_height_map", "import_mesh"]
