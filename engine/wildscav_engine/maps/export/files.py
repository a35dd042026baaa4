"""Exporting a map to files for other programs: triangle meshes, the valid locations, and a description.

The game's frame is left-handed: x east, y up, z north. OBJ and GLB are right-handed with y up, so in the
mesh files z is mirrored: x east, y up, z south. So maps look as they do in the game, triangles run
counter-clockwise seen from outside, and importing a file gives the same map again. The locations are in the
game's own frame.
"""

import json
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.world import CELL, Kind, World
from wildscav_engine.maps.export.mesh import Mesh, solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.maps.game_map import GENERATOR_VERSION, GameMap
from wildscav_engine.maps.picture.paint import water_nearby
from wildscav_engine.rendering.palette import DRY_GRASS, GRASS, WATER, of_solids, of_terrain
from wildscav_engine.storage.files import write_whole

if TYPE_CHECKING:
    import trimesh

MIRROR = np.array([1.0, 1.0, -1.0])
DRYNESS = 0.4  # of the grass, 0-1
FILES = ("map.obj", "map.mtl", "map.glb", "locations.json", "map.json")


class Part(NamedTuple):
    """All surfaces of one kind, in the frame of the files: V vertices, T triangles."""

    kind: Kind
    vertices: NDArray[np.float64]  # (V, 3) m
    triangles: NDArray[np.int64]  # (T, 3)
    colors: NDArray[np.uint8]  # (V, 4) red, green, blue, opacity
    color: tuple[int, int, int, int]  # average colour

    @property
    def name(self) -> str:
        """The name of its object and its material."""
        return self.kind.name.lower()


def export_map(game_map: GameMap, folder: Path) -> list[Path]:
    """Write a map into a folder, which is created if necessary; existing files are replaced.

    Args:
        game_map: The map.
        folder: The folder for ``FILES``.

    Returns:
        The paths of the files.

    Raises:
        OSError: A file cannot be written.
    """
    parts = list(parts_of(game_map))
    contents: list[bytes] = [
        *obj_of(parts),
        glb_of(parts),
        json.dumps(locations_of(game_map)).encode(),
        json.dumps(description_of(game_map), indent=2).encode(),
    ]
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / name for name in FILES]
    for path, content in zip(paths, contents, strict=True):
        write_whole(path, content)
    return paths


def parts_of(game_map: GameMap) -> Iterator[Part]:
    """Yield the terrain, the water and all solids of each kind on the map."""
    world = game_map.world
    yield _part(
        Kind.TERRAIN, terrain_mesh(world), _terrain_colors(world), _opaque(GRASS * 0.6 + DRY_GRASS * 0.4)
    )
    water = water_mesh(world)
    if len(water.triangles):
        yield _part(Kind.WATER, water, np.tile(WATER[:3], (len(water.vertices), 1)), WATER)
    colors = of_solids(world.solid_kind, game_map.solid_house)
    for kind in Kind:
        chosen = np.nonzero(world.solid_kind == kind)[0]
        if len(chosen):
            mesh = solids_mesh(world, chosen)
            owner = np.zeros(len(mesh.vertices), np.int64)
            owner[mesh.triangles] = mesh.solids[:, None]
            yield _part(kind, mesh, colors[owner], _opaque(colors[chosen].mean(axis=0)))


def _part(kind: Kind, mesh: Mesh, colors: NDArray[Any], color: tuple[int, int, int, int]) -> Part:
    rgba = np.full((len(colors), 4), color[3], np.uint8)
    rgba[:, :3] = np.clip(colors, 0, 255)
    # Mirroring reverses the winding, so the order of vertices is reversed, too.
    triangles = mesh.triangles[:, ::-1].astype(np.int64)
    return Part(kind, mesh.vertices * MIRROR, triangles, rgba, color)


def _opaque(color: NDArray[np.float64]) -> tuple[int, int, int, int]:
    red, green, blue = (round(float(part)) for part in color)
    return min(red, 255), min(green, 255), min(blue, 255), 255


def _terrain_colors(world: World) -> NDArray[np.float64]:
    """Return (V, 3) colours of the cell corners."""
    slope_north, slope_east = np.gradient(world.heights, CELL)
    up = 1.0 / np.sqrt(1.0 + slope_north * slope_north + slope_east * slope_east)
    # The water near a corner is that of the cell to its north-east, or of the outermost one.
    water = np.pad(water_nearby(world), ((0, 1), (0, 1)), mode="edge")
    dryness = np.full(world.heights.size, DRYNESS)
    return of_terrain((world.heights - water).ravel(), up.ravel(), dryness)


def glb_of(parts: list[Part]) -> bytes:
    """Return a binary glTF file: a node and a mesh for each part, with vertex colours."""
    import trimesh

    scene = trimesh.Scene()
    for part in parts:
        look = {"visual": _material(part)} if part.color[3] < 255 else {"vertex_colors": part.colors}
        mesh = trimesh.Trimesh(part.vertices, part.triangles, process=False, **look)
        scene.add_geometry(mesh, node_name=part.name, geom_name=part.name)
    # Without normals, viewers use flat shading, as the game does.
    return bytes(trimesh.exchange.gltf.export_glb(scene, include_normals=False))


def _material(part: Part) -> "trimesh.visual.TextureVisuals":
    from trimesh.visual import TextureVisuals
    from trimesh.visual.material import PBRMaterial

    see_through = PBRMaterial(
        name=part.name, baseColorFactor=part.color, alphaMode="BLEND", metallicFactor=0.0, doubleSided=True
    )
    return TextureVisuals(material=see_through)


def obj_of(parts: list[Part]) -> tuple[bytes, bytes]:
    """Return an OBJ file and its materials: an object and a material for each part."""
    mesh, library = BytesIO(), []
    mesh.write(b"# x east, y up, z south; metres\nmtllib map.mtl\n")
    first = 1
    for part in parts:
        mesh.write(f"o {part.name}\nusemtl {part.name}\n".encode())
        np.savetxt(mesh, part.vertices, "v %.5f %.5f %.5f")
        np.savetxt(mesh, part.triangles + first, "f %d %d %d")
        first += len(part.vertices)
        red, green, blue, opacity = (f"{channel / 255:.4f}" for channel in part.color)
        library.append(f"newmtl {part.name}\nKd {red} {green} {blue}\nd {opacity}\n")
    return mesh.getvalue(), "".join(library).encode()


def locations_of(game_map: GameMap) -> dict[str, list[list[float]]]:
    """Return the valid locations, [x, y, z] in m to the millimetre."""
    return {
        name: np.round(places, 3).tolist()
        for name, places in (("indoor", game_map.indoor), ("outdoor", game_map.outdoor))
    }


def description_of(game_map: GameMap) -> dict[str, Any]:
    """Return the map's spec, digest and houses."""
    told = ("center", "size", "yaw", "ground", "storeys", "storey_height")
    houses = [{name: getattr(house, name) for name in told} for house in game_map.houses]
    return {
        "spec": game_map.spec.model_dump(mode="json"),
        "digest": game_map.digest,
        "generator_version": GENERATOR_VERSION,
        "frame": {"locations": "x east, y up, z north; m", "meshes": "x east, y up, z south; m"},
        "houses": houses,
    }
