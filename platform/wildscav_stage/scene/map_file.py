"""The file of a map for a browser: its ground, water and solids, with the colours and the light of cameras.

``packed`` in ``arrays.py`` tells its form. Lengths are whole centimetres: x grows to the east, y up, and z to
the north. Colours are red, green and blue, 0-255, before light falls on them. The header has

- ``format`` and ``version``;
- ``size`` of the map and ``cell`` of its ground, and its south-western ``corner`` (x, z);
- ``topologies``: the triangles of the surfaces that solids have, as corners of a solid, three by three,
  wound as in ``Mesh``;
- ``light``: see ``LIGHT``;
- ``chunks``: how many parts the solids come in, each those of a square of the map;
- ``parts``: the (P, 8) corners (x, y, z) of the parts of a ``body`` and of a ``box``, which stand at the
  origin and face north, numbered by the bits (along, up, across); ``box_colors``, of the parts of a box.

Its arrays are

- ``heights`` (R + 1, C + 1) of the corners of the cells of ground, row after row northwards, and their
  ``ground`` colours (R + 1, C + 1, 3); the diagonal of a cell runs from south-west to north-east;
- ``water`` (W, 3): row, column and level of each wet cell;
- of each chunk, from ``solids 0`` on: ``solids`` (S, 5): kind (see ``KINDS``), topology, and the first
  corner's x, y and z; ``colors`` (S, 3); and the ``corners`` (V, 3) of one solid after the other, less the
  first of their solid.

They come in this order, the chunks in the middle of the map first, so that a map is seen while it arrives.
"""

from hashlib import blake2b
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import CELL, Kind, World
from wildscav_engine.maps.export.mesh import water_cells
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap
from wildscav_engine.rendering.palette import SKYLIGHT, SUN, SUNLIGHT, of_solids
from wildscav_engine.rendering.shading.ground import ground_appearance
from wildscav_engine.rendering.shading.light.ambient_light import OPEN, ROOFED, SIDE_LIGHT
from wildscav_engine.rendering.shading.light.sunlight import DIRECT
from wildscav_engine.rendering.shading.sky import BELOW, CLOUD, HORIZON, SUN_COLOR, ZENITH
from wildscav_engine.rendering.shading.surfaces import CEILING
from wildscav_engine.rendering.shading.water import DEEP
from wildscav_engine.sensors.optics.object_parts import BODY_PARTS, CRATE_COLORS, CRATE_PARTS
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_stage.scene.arrays import packed

MAP_VERSION: Final = 2  # of the file; it moves when the file of the same map changes in any way
CENTIMETRES = 100  # in a metre
CHUNK = 25_000  # cm along a side of the square whose solids are a chunk
KINDS = {kind.name.lower(): int(kind) for kind in Kind}
# The light of cameras: the direction towards the sun, the light of sun and sky on a surface of colour 1 (see
# ``palette.shaded``), the share of the sun's that they use, ambient light as in ``ambient_light.py``, and the
# colours of the sky, of ceilings, and of deep water.
LIGHT: Final[dict[str, Any]] = {
    "sun": (SUN / np.linalg.norm(SUN)).round(4).tolist(),
    "sunlight": SUNLIGHT.tolist(),
    "skylight": SKYLIGHT.tolist(),
    "direct": DIRECT,
    "open": OPEN,
    "roofed": ROOFED,
    "side": SIDE_LIGHT,
    "zenith": ZENITH,
    "horizon": HORIZON,
    "below": BELOW,
    "disc": SUN_COLOR,
    "cloud": CLOUD,
    "ceiling": CEILING,
    "deep": DEEP,
}


def centimetres(metres: Any) -> NDArray[np.int32]:
    """Return lengths or coordinates in m as whole centimetres."""
    return np.asarray(np.rint(np.asarray(metres) * CENTIMETRES), np.int32)


def map_key(spec: MapSpec) -> str:
    """Return a name of a map's file that no other file has, for whoever keeps it."""
    told = f"{MAP_VERSION} {GENERATOR_VERSION} {spec.model_dump_json()}"
    return blake2b(told.encode(), digest_size=8).hexdigest()


def map_file(game_map: GameMap) -> bytes:
    """Return the compressed file of a map."""
    world = game_map.world
    solids = _solids(game_map)
    chunks = _chunks(solids.table, centimetres(world.corner))
    fields: dict[str, Any] = {
        "format": "wildscav-map",
        "version": MAP_VERSION,
        "size": int(centimetres(CELL * (world.heights.shape[1] - 1))),
        "cell": int(centimetres(CELL)),
        "corner": centimetres(world.corner).tolist(),
        "kinds": KINDS,
        "topologies": solids.topologies,
        "light": LIGHT,
        "chunks": len(chunks),
        "parts": {
            "body": centimetres(BODY_PARTS.corners).tolist(),
            "box": centimetres(CRATE_PARTS.corners).tolist(),
        },
        "box_colors": CRATE_COLORS.tolist(),
    }
    ground = ground_appearance(world).color
    arrays: dict[str, NDArray[Any]] = {
        "heights": centimetres(world.heights)[..., None],
        "ground": np.rint(ground).astype(np.uint8),
        "water": _water(world),
    }
    for number, members in enumerate(chunks):
        arrays[f"solids {number}"] = solids.table[members]
        arrays[f"colors {number}"] = solids.colors[members]
        arrays[f"corners {number}"] = np.concatenate([solids.corners[solid] for solid in members.tolist()])
    return packed(fields, arrays)


def _water(world: World) -> NDArray[np.int32]:
    """Return row, column and level of the cells that are partly wet, (W, 3)."""
    rows, columns = water_cells(world)
    return np.stack([rows, columns, centimetres(world.water[rows, columns])], axis=-1).astype(np.int32)


class _Solids(NamedTuple):
    """All solids of a map, as they are in its file."""

    topologies: list[list[int]]
    table: NDArray[np.int32]  # (S, 5)
    colors: NDArray[np.uint8]  # (S, 3)
    corners: list[NDArray[np.int32]]  # S times (corners of the solid, 3)


def _solids(game_map: GameMap) -> _Solids:
    world = game_map.world
    numbers: dict[bytes, int] = {}
    colors = np.rint(np.minimum(of_solids(world.solid_kind, game_map.solid_house), 255.0)).astype(np.uint8)
    solids = _Solids([], np.zeros((len(colors), 5), np.int32), colors, [])
    for solid, kind in enumerate(world.solid_kind.tolist()):
        planes = world.faces[world.solid_start[solid] : world.solid_start[solid + 1]]
        corners, triangles = polyhedron(planes)
        number = numbers.setdefault(triangles.tobytes(), len(numbers))
        if number == len(solids.topologies):
            solids.topologies.append(triangles.ravel().tolist())
        whole = centimetres(corners)
        solids.table[solid] = (kind, number, *whole[0])
        solids.corners.append(whole - whole[0])
    return solids


def _chunks(table: NDArray[np.int32], corner: NDArray[np.int32]) -> list[NDArray[np.int64]]:
    """Return the numbers of the solids of each chunk, those in the middle of the map first."""
    squares, chunk_of = np.unique((table[:, [2, 4]] - corner) // CHUNK, axis=0, return_inverse=True)
    away = ((corner + (squares.astype(np.int64) + 0.5) * CHUNK) ** 2).sum(axis=1)
    order = np.argsort(away, kind="stable")
    return [np.flatnonzero(chunk_of == chunk) for chunk in order.tolist()]
