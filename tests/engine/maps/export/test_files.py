"""Exported maps: other programs read back exactly the world that agents play in."""

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from numpy.typing import NDArray

from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import GENERATOR_VERSION, GameMap, generate_map
from wildscav_engine.maps.export.files import FILES, export_map
from wildscav_engine.maps.export.mesh import solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

SKY = 200.0  # m


@pytest.fixture(scope="module")
def game_map() -> GameMap:
    return generate_map(MapConfig(size=60, houses=2, water=0.1), 3)


@pytest.fixture(scope="module")
def folder(game_map: GameMap, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export") / "new"
    assert [path.name for path in export_map(game_map, folder)] == list(FILES)
    return folder


def read(path: Path) -> dict[str, trimesh.Trimesh]:
    scene = trimesh.load_scene(path, process=False, split_object=True, group_material=False)
    return {name: mesh for name, mesh in scene.geometry.items() if isinstance(mesh, trimesh.Trimesh)}


def names_of(game_map: GameMap) -> set[str]:
    return {"terrain", "water"} | {Kind(kind).name.lower() for kind in game_map.world.solid_kind}


def test_there_is_an_object_for_each_kind(game_map: GameMap, folder: Path) -> None:
    assert set(read(folder / "map.glb")) == names_of(game_map)
    text = (folder / "map.obj").read_text()
    assert {line[2:] for line in text.splitlines() if line.startswith("o ")} == names_of(game_map)
    materials = {line[7:] for line in (folder / "map.mtl").read_text().splitlines() if line[:6] == "newmtl"}
    assert materials == names_of(game_map)


@pytest.mark.parametrize("file", ["map.glb", "map.obj"])
def test_both_files_hold_every_triangle_in_its_place(game_map: GameMap, folder: Path, file: str) -> None:
    meshes = [part(game_map.world) for part in (terrain_mesh, water_mesh, solids_mesh)]
    parts = read(folder / file).values()
    assert sum(len(part.faces) for part in parts) == sum(len(mesh.triangles) for mesh in meshes)
    vertices = np.concatenate([mesh.vertices[mesh.triangles.ravel()] for mesh in meshes]) * [1, 1, -1]
    bounds = np.array([part.bounds for part in parts])
    assert bounds[:, 0].min(axis=0) == pytest.approx(vertices.min(axis=0), abs=1e-4)
    assert bounds[:, 1].max(axis=0) == pytest.approx(vertices.max(axis=0), abs=1e-4)


@pytest.mark.parametrize("file", ["map.glb", "map.obj"])
def test_solids_are_closed_and_face_outwards(game_map: GameMap, folder: Path, file: str) -> None:
    for name, part in read(folder / file).items():
        if len(part.faces) not in {
            len(terrain_mesh(game_map.world).triangles),
            len(water_mesh(game_map.world).triangles),
        }:
            assert part.is_watertight, name
            assert part.volume > 0, name
        else:
            assert (part.face_normals[:, 1] > 0).all(), name


def test_what_a_ray_meets_from_above_is_in_the_mesh(game_map: GameMap, folder: Path) -> None:
    parts = [part for name, part in read(folder / "map.glb").items() if name != "water"]
    triangles = np.concatenate([part.triangles for part in parts])
    generator = np.random.default_rng(7)
    for x, z in generator.uniform(-29, 29, (100, 2)):
        hit = raycast(game_map.world, x, SKY, z, 0.0, -1.0, 0.0, 2 * SKY)
        assert highest_over(triangles, x, -z) == pytest.approx(SKY - hit.distance, abs=1e-3)


def highest_over(triangles: NDArray[np.float64], x: float, z: float) -> float:
    """Return the greatest height of triangles, (T, 3, 3), over a point, by barycentric coordinates."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    area = (b[:, 0] - a[:, 0]) * (c[:, 2] - a[:, 2]) - (b[:, 2] - a[:, 2]) * (c[:, 0] - a[:, 0])
    a, b, c, area = (part[np.abs(area) > 1e-9] for part in (a, b, c, area))
    v = ((x - a[:, 0]) * (c[:, 2] - a[:, 2]) - (z - a[:, 2]) * (c[:, 0] - a[:, 0])) / area
    w = ((b[:, 0] - a[:, 0]) * (z - a[:, 2]) - (b[:, 2] - a[:, 2]) * (x - a[:, 0])) / area
    over = (v >= 0) & (w >= 0) & (v + w <= 1)
    heights = a[:, 1] + v * (b[:, 1] - a[:, 1]) + w * (c[:, 1] - a[:, 1])
    return float(heights[over].max())


def test_locations_and_spec_can_be_read_back(game_map: GameMap, folder: Path) -> None:
    locations = json.loads((folder / "locations.json").read_text())
    assert np.abs(np.array(locations["indoor"]) - game_map.indoor).max() <= 0.0005 + 1e-9
    assert np.abs(np.array(locations["outdoor"]) - game_map.outdoor).max() <= 0.0005 + 1e-9
    described = json.loads((folder / "map.json").read_text())
    assert MapSpec.model_validate(described["spec"]) == game_map.spec
    assert (described["digest"], described["generator_version"]) == (game_map.digest, GENERATOR_VERSION)
    assert len(described["houses"]) == 2


def test_nothing_is_written_where_nothing_can_be(game_map: GameMap, tmp_path: Path) -> None:
    (tmp_path / "taken").touch()
    with pytest.raises(OSError, match="taken"):
        export_map(game_map, tmp_path / "taken")
