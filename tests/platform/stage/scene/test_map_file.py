"""The file of a map holds exactly the surface on which the game is played."""

from typing import Any, NamedTuple

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.platform.stage.scene.packed_files import unpacked
from tests.recorded_matches import SMALL_MAP

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import map_of
from wildscav_engine.maps.export.mesh import solids_mesh, terrain_mesh, water_mesh
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.palette import SUN, of_solids
from wildscav_engine.rendering.shading.ground import ground_appearance
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_stage.scene.map_file import MAP_VERSION, map_file, map_key

HALF = 0.5001  # cm, of rounding
SPECS = {
    "small": SMALL_MAP,
    "lakes and woods": MapSpec(config=MapConfig(size=100, houses=3, water=0.3, vegetation=0.6), seed=2),
    "bare": MapSpec(config=MapConfig(size=40, houses=0, water=0.0, vegetation=0.0), seed=3),
}


class File(NamedTuple):
    """A map and its file."""

    game_map: GameMap
    fields: dict[str, Any]
    arrays: dict[str, NDArray[Any]]


@pytest.fixture(scope="module", params=SPECS)
def file(request: pytest.FixtureRequest) -> File:
    game_map = map_of(SPECS[request.param])
    return File(game_map, *unpacked(map_file(game_map)))


def test_it_says_what_it_is_and_where_it_lies(file: File) -> None:
    fields, world = file.fields, file.game_map.world
    assert (fields["format"], fields["version"]) == ("wildscav-map", MAP_VERSION)
    assert fields["size"] == 200 * world.water.shape[0] == -2 * fields["corner"][0]
    assert fields["corner"] == [round(100 * value) for value in world.corner]
    np.testing.assert_allclose(fields["light"]["sun"], SUN / np.linalg.norm(SUN), atol=1e-4)


def test_every_map_has_a_key_and_so_has_every_version(monkeypatch: pytest.MonkeyPatch) -> None:
    keys = {map_key(spec) for spec in SPECS.values()}
    for name in ("MAP_VERSION", "GENERATOR_VERSION"):
        with monkeypatch.context() as changed:
            changed.setattr(f"wildscav_stage.scene.map_file.{name}", 99)
            keys |= {map_key(SMALL_MAP)}
    assert len(keys) == len(SPECS) + 2


def test_the_ground_is_the_engines(file: File) -> None:
    world, fields, heights = file.game_map.world, file.fields, file.arrays["heights"][..., 0]
    row, column = np.indices(heights.shape)
    x, z = (
        first + fields["cell"] * step for first, step in zip(fields["corner"], (column, row), strict=True)
    )
    mine = np.stack([x, heights, z], axis=-1).reshape(-1, 3)

    np.testing.assert_allclose(mine, 100 * terrain_mesh(world).vertices, atol=HALF)
    np.testing.assert_allclose(file.arrays["ground"], ground_appearance(world).color, atol=HALF)


def test_the_water_is_the_engines(file: File) -> None:
    cells = water_mesh(file.game_map.world).vertices.reshape(-1, 4, 3)[:, 0]
    rows, columns, levels = file.arrays["water"].T
    west, south = file.fields["corner"]
    mine = np.stack([west + 200 * columns, levels, south + 200 * rows], axis=-1)

    np.testing.assert_allclose(mine.reshape(-1, 3), 100 * cells, atol=HALF)


def test_the_solids_have_the_engines_corners_triangles_and_colours(file: File) -> None:
    game_map, arrays = file.game_map, file.arrays
    topologies = [np.array(each).reshape(-1, 3) for each in file.fields["topologies"]]
    sizes = [int(triangles.max()) + 1 for triangles in topologies]
    chunks = range(file.fields["chunks"])
    solids, colors, offsets = (
        np.concatenate([np.zeros((0, width), int), *(arrays[f"{name} {chunk}"] for chunk in chunks)])
        for name, width in {"solids": 5, "colors": 3, "corners": 3}.items()
    )
    topology = solids[:, 1].tolist()
    counts = [sizes[number] for number in topology]
    firsts = np.cumsum([0, *counts[:-1]], dtype=int) if counts else np.zeros(0, int)
    corners = offsets + np.repeat(solids[:, 2:], counts, axis=0)
    triangles = [topologies[number] + first for number, first in zip(topology, firsts.tolist(), strict=True)]
    mesh = solids_mesh(game_map.world)

    assert corners.shape == mesh.vertices.shape
    np.testing.assert_allclose(corners, 100.0 * mesh.vertices.astype(float), atol=HALF + 0.01)  # float32
    np.testing.assert_array_equal(np.concatenate([np.zeros((0, 3), int), *triangles]), mesh.triangles)
    kinds = game_map.world.solid_kind
    np.testing.assert_array_equal(solids[:, 0], kinds)
    assert file.fields["kinds"] == {kind.name.lower(): kind for kind in Kind}
    np.testing.assert_allclose(colors, np.minimum(of_solids(kinds, game_map.solid_house), 255), atol=HALF)


def test_solids_come_in_squares_of_the_map_from_the_middle_outwards() -> None:
    config = MapConfig(size=600, houses=1, water=0.0, vegetation=0.03)
    fields, arrays = unpacked(map_file(map_of(MapSpec(config=config, seed=2))))
    squares = []
    for chunk in range(fields["chunks"]):
        places = (arrays[f"solids {chunk}"][:, [2, 4]] + 30_000) // 25_000
        (square,) = {(x, z) for x, z in places.tolist()}
        squares.append(square)
    assert squares[0] == (1, 1)
    assert sorted(squares) == [(x, z) for x in range(3) for z in range(3)]


@pytest.mark.slow
def test_the_file_of_a_large_map_is_half_a_megabyte() -> None:
    spec = MapSpec(config=MapConfig(size=500, houses=30), seed=1)
    assert 200_000 < len(map_file(map_of(spec))) < 600_000
