"""The named parts of a mesh file, in the frame of the game.

GLB and OBJ are right-handed with y up; the game is left-handed: x east, y up, z north. So z is mirrored, as
it is when maps are exported.
"""

import io
import logging
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps.base import BaseError
from wildscav_engine.storage.files import read_limited

MIRROR = np.array([1.0, 1.0, -1.0])  # from a file's frame to the game's, and back
FILE_LIMIT = 64 << 20  # bytes
FARTHEST = 1e6  # m from the origin, of any vertex


# Without this handler, trimesh's warnings would be printed; problems that matter are raised or noted here.
logging.getLogger("trimesh").addHandler(logging.NullHandler())


class Part(NamedTuple):
    """An object, group or node of a file, in the frame of the game: V vertices, T triangles."""

    name: str
    words: str  # its material, its mesh or object, and last its own name; they give its kind
    vertices: NDArray[np.float64]  # (V, 3) m
    triangles: NDArray[np.int64]  # (T, 3) vertices


def read_parts(path: Path) -> list[Part]:
    """Return the parts of a GLB or OBJ file that have triangles.

    Raises:
        BaseError: The file is missing, of another type, too large or damaged.
    """
    readers = {".glb": _read_glb, ".obj": _read_obj}
    reader = readers.get(path.suffix.lower())
    if reader is None:
        raise BaseError(f"a mesh is a file named {' or '.join(readers)}, a height map one named .png")
    try:
        data = read_limited(path, FILE_LIMIT)
    except OSError as error:
        raise BaseError(f"cannot be read: {error.strerror}") from None
    parts = [part for part in reader(data) if len(part.triangles)]
    if not parts:
        raise BaseError("there are no triangles in it")
    for part in parts:
        if part.triangles.min() < 0 or part.triangles.max() >= len(part.vertices):
            raise BaseError(f"{part.name!r} has triangles of vertices that it does not have")
        if not np.isfinite(part.vertices).all():
            raise BaseError(f"not all vertices of {part.name!r} are finite")
        if np.abs(part.vertices).max() > FARTHEST:
            raise BaseError(f"{part.name!r} reaches more than {FARTHEST:.0f} m away; the unit must be metres")
    return parts


def _read_obj(data: bytes) -> list[Part]:
    try:
        text = data.decode()
    except UnicodeDecodeError:
        raise BaseError("it is no text, so no OBJ file") from None
    vertices, groups = read_obj(text)
    parts = []
    for names, triangles in groups.items():
        name = names.group or names.object or names.material or "part"
        used, renumbered = np.unique(triangles, return_inverse=True)
        parts.append(Part(name, " ".join(names), vertices[used] * MIRROR, renumbered.reshape(-1, 3)))
    return parts


def _read_glb(data: bytes) -> list[Part]:
    import trimesh

    try:
        # Without a resolver, a file cannot make other files be read.
        scene = trimesh.load_scene(io.BytesIO(data), file_type="glb", process=False)
        # Sorted, because their order is not that of the file.
        return [_node(scene, name) for name in sorted(scene.graph.nodes_geometry)]
    except MemoryError:
        raise
    except Exception as error:  # noqa: BLE001 - damaged files make the reader raise any exception
        told = isinstance(error, ValueError | KeyError | IndexError) and " ".join(str(error).split())
        reason = told or "its contents do not fit together"
        raise BaseError(f"it is no GLB file, or damaged: {reason}") from None


def _node(scene: object, name: str) -> Part:
    """Return one node of a scene in world coordinates; a node that is no mesh has no triangles."""
    turn, key = scene.graph[name]  # type: ignore[attr-defined]
    mesh = scene.geometry[key]  # type: ignore[attr-defined]
    if not hasattr(mesh, "faces"):
        return Part(name, "", np.zeros((0, 3)), np.zeros((0, 3), np.int64))
    vertices = np.asarray(mesh.vertices, np.float64) @ turn[:3, :3].T + turn[:3, 3]
    material = getattr(getattr(mesh.visual, "material", None), "name", None)
    triangles = np.asarray(mesh.faces, np.int64).reshape(-1, 3)
    return Part(str(name), f"{material or ''} {key} {name}", vertices * MIRROR, triangles)


class Names(NamedTuple):
    """The material, object and group of some faces; empty if the file names none."""

    material: str = ""
    object: str = ""
    group: str = ""


def read_obj(text: str) -> tuple[NDArray[np.float64], dict[Names, NDArray[np.int64]]]:
    """Return all vertices, (V, 3), and the triangles, (T, 3), of each object, group and material.

    Trimesh reads OBJ as well, but it drops the names of materials whose file is missing, and renumbers
    vertices; both are needed here to distinguish parts.

    Faces with more than three corners are split into fans. Lines that do not define shapes are skipped.

    Raises:
        BaseError: A line is invalid.
    """
    vertices: list[list[float]] = []
    groups: dict[Names, list[int]] = {}
    names = Names()
    begun = ""  # the beginning of a line that continues on the next one
    for number, line in enumerate(text.splitlines(), start=1):
        if line.endswith("\\"):
            begun += line[:-1] + " "
            continue
        word, _, rest = (begun + line).strip().partition(" ")
        begun = ""
        try:
            if word == "v":
                vertices.append(_vertex(rest))
            elif word == "f":
                groups.setdefault(names, []).extend(_fan(rest, len(vertices)))
            elif word == "o":
                names = Names(names.material, rest.strip())
            elif word == "g":
                names = names._replace(group=rest.strip())
            elif word == "usemtl":
                names = names._replace(material=rest.strip())
        except ValueError as error:
            raise BaseError(f"line {number}: {error}") from None
    triangles = {names: np.array(corners, np.int64).reshape(-1, 3) for names, corners in groups.items()}
    return np.array(vertices, np.float64).reshape(-1, 3), triangles


def _vertex(text: str) -> list[float]:
    numbers = [float(word) for word in text.split()[:3]]
    if len(numbers) < 3:
        raise ValueError("a vertex has three numbers")
    return numbers


def _fan(text: str, vertices: int) -> list[int]:
    """Return the corners of the triangles of a face, counted from 0."""
    corners = []
    for word in text.split():
        index = int(word.partition("/")[0])
        corner = index - 1 if index > 0 else vertices + index
        if index == 0 or not 0 <= corner < vertices:
            raise ValueError(f"there is no vertex {index}")
        corners.append(corner)
    if len(corners) < 3:
        raise ValueError("a face has at least three corners")
    return [corner for pair in pairwise(corners[1:]) for corner in (corners[0], *pair)]
