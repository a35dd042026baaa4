"""A map in the client's format: ``NNN.obj`` with its triangles, and ``NNN.json`` with its valid locations.

The mesh is the surface that stops motion, shots and sight, in the coordinates of the client's raycaster: the
engine's with x negated. It does not contain water, which stops nothing.
"""

import json
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.maps.export.mesh import Mesh

MIRROR = np.array([-1.0, 1.0, 1.0], np.float32)


def write_map(map_id: int, folder: Path) -> None:
    """Write both files of a map, each atomically, and the mesh last.

    Raises:
        MapError: There is no such map.
        OSError: A file cannot be written.
    """
    from wildscav_engine.maps import load_map
    from wildscav_engine.maps.export.files import locations_of
    from wildscav_engine.storage.files import write_whole

    game_map = load_map(map_id)
    obj, places = paths_of(map_id, folder)
    write_whole(places, json.dumps(locations_of(game_map)).encode())
    write_whole(obj, header_of(map_id) + obj_of(game_map))


def is_written(map_id: int, folder: Path) -> bool:
    """Return whether a folder has both files of a map, made by this version of the generator."""
    obj, places = paths_of(map_id, folder)
    if not (obj.is_file() and places.is_file()):
        return False
    with obj.open("rb") as file:
        return file.readline() == header_of(map_id)


def paths_of(map_id: int, folder: Path) -> tuple[Path, Path]:
    """Return the paths of a map's mesh and locations."""
    return folder / f"{map_id:03}.obj", folder / f"{map_id:03}.json"


def header_of(map_id: int) -> bytes:
    """Return the first line of a mesh, which identifies the map and the generator's version."""
    from wildscav_engine.maps import GENERATOR_VERSION

    return f"# Wildscav map {map_id:03}, generator {GENERATOR_VERSION}: x west, y up, z north; m\n".encode()


def obj_of(game_map: "GameMap") -> bytes:
    """Return the mesh of a map as an OBJ file."""
    from wildscav_engine.maps.export.mesh import solids_mesh, terrain_mesh

    text = BytesIO()
    first = 1
    for mesh in (terrain_mesh(game_map.world), solids_mesh(game_map.world)):
        _write(mesh, first, text)
        first += len(mesh.vertices)
    return text.getvalue()


def _write(mesh: "Mesh", first: int, text: BytesIO) -> None:
    """Write a mirrored mesh, numbered from ``first``; reversing each triangle keeps its outer side."""
    np.savetxt(text, mesh.vertices * MIRROR, "v %.3f %.3f %.3f")
    np.savetxt(text, mesh.triangles[:, ::-1] + first, "f %d %d %d")
