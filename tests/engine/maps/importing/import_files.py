"""Files to import, and the errors about them."""

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from wildscav_engine.geometry.world import Solid
from wildscav_engine.maps.base import BaseError
from wildscav_engine.maps.export.mesh import Mesh
from wildscav_engine.maps.importing import Imported, import_height_map

Image = pytest.importorskip("PIL.Image")
trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")

FLAT_GROUND = np.zeros((31, 31))


def picture(path: Path, grey: NDArray[np.generic], **options: object) -> Path:
    Image.fromarray(grey).save(path, format="PNG", **options)
    return path


def height_map(path: Path, grey: NDArray[np.generic], size: int = 40, **options: float) -> Imported:
    return import_height_map(picture(path, grey), size, 0.0, 10.0, **options)


def heights_of(imported: Imported) -> NDArray[np.float64]:
    assert imported.base.heights is not None
    return imported.base.heights


def refusal(action: object) -> str:
    """Return the message with which an action is refused; other errors pass through."""
    try:
        action()  # type: ignore[operator]
    except BaseError as error:
        return str(error)
    return ""


def glb(path: Path, **parts: object) -> Path:
    """Write named meshes, given in the frame of the file."""
    scene = trimesh.Scene()
    for name, mesh in parts.items():
        scene.add_geometry(mesh, node_name=name, geom_name=name)
    path.write_bytes(scene.export(file_type="glb"))
    return path


def cuboid(low: tuple[float, float, float], high: tuple[float, float, float]) -> object:
    return trimesh.creation.box(bounds=[low, high])


def in_file(mesh: Mesh) -> object:
    """Return one of our meshes as it is exported: z mirrored."""
    return trimesh.Trimesh(mesh.vertices * [1, 1, -1], mesh.triangles[:, ::-1], process=False)


def corners_of(solid: Solid) -> list[float]:
    return [round(float(number), 4) for number in (*solid.low, *solid.high)]
