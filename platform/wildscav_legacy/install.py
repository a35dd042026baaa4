"""Installation of the engine and the maps that scripts for the original's client use."""

import json
import shlex
import sys
from collections.abc import Iterator
from concurrent.futures import as_completed
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from wildscav.system.worker_pool import WorkerPool

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.maps.export.mesh import Mesh

PROGRAM = "fps.x86_64"
HOME = Path(__file__).parents[1]  # the folder that contains our packages
# A shell script that runs itself with Python, because the interpreter's path may be too long for a "#!" line.
LAUNCHER = """\
#!/bin/sh
''':'
exec {python} -I "$0" "$@"
'''
# The engine of Wildscav in place of the original game's. It runs in its own Python environment, independent
# of the client's PYTHONPATH.
import sys
from pathlib import Path

for root in {roots}:
    if root not in sys.path:
        sys.path.insert(0, root)

from wildscav_legacy.program import main

main(Path(__file__).parent, sys.argv[1:])
"""
MIRROR = np.array([-1.0, 1.0, 1.0], np.float32)


def install_engine(folder: Path) -> Path:
    """Write the program that the client starts into a folder, and return its path; OSError if that fails."""
    import wildscav_engine
    from wildscav_engine.storage.files import write_whole

    # The folders of this code, which may not be on the default path of its Python environment.
    roots = [str(HOME), str(Path(wildscav_engine.__path__[0]).parent)]
    text = LAUNCHER.format(python=shlex.quote(sys.executable), roots=roots)
    folder.mkdir(parents=True, exist_ok=True)
    program = folder / PROGRAM
    write_whole(program, text.encode())
    program.chmod(0o755)
    return program


def missing_maps(ids: list[int], folder: Path) -> list[int]:
    """Return the ids of maps that a folder lacks, or that another version of the generator made."""
    return [map_id for map_id in ids if not is_written(map_id, folder)]


def install_maps(ids: list[int], folder: Path, workers: int) -> Iterator[int]:
    """Write maps into a folder, several at a time.

    Yields:
        The id of each map once it is written.

    Raises:
        OSError: A file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    if not ids:
        return
    with WorkerPool(min(workers, len(ids))) as pool:
        jobs = {pool.submit(write_map, map_id, folder): map_id for map_id in ids}
        for job in as_completed(jobs):
            job.result()
            yield jobs[job]


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
    """Return the mesh of a map as an OBJ file.

    It is the surface that stops motion, shots and sight, in the coordinates of the client's raycaster: the
    engine's with x negated. It does not contain water, which stops nothing.
    """
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
