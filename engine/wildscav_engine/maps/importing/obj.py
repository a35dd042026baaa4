"""Reading Wavefront OBJ: the vertices and faces of its objects and groups.

Trimesh reads OBJ as well, but it drops the names of materials whose file is missing, and renumbers vertices;
both are needed here to distinguish parts.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.maps.base import BaseError


class Names(NamedTuple):
    """The material, object and group of some faces; empty if the file names none."""

    material: str = ""
    object: str = ""
    group: str = ""


def read_obj(text: str) -> tuple[NDArray[np.float64], dict[Names, NDArray[np.int64]]]:
    """Return all vertices, (V, 3), and the triangles, (T, 3), of each object, group and material.

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
