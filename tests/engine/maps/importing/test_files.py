"""Files that are damaged or of the wrong type are refused; exported files come back the same."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.engine.maps.importing.import_files import corners_of, cuboid, heights_of, refusal

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.base import BaseError
from wildscav_engine.maps.export.files import export_map
from wildscav_engine.maps.importing import import_height_map, import_mesh
from wildscav_engine.specs.map_spec import MapConfig

Image = pytest.importorskip("PIL.Image")
trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")


CUBE = """\
# a cube of quads
mtllib none.mtl
o House
v 0 0 0
v 2 0 0
v 2 0 2
v 0 0 2
v 0 3 0 1.0
v 2 3 0
v 2 3 2
v 0 3 2
vn 0 1 0
g cellar
usemtl Stone floor
f 1//1 2//1 3//1 \\
  4//1
f -4 -1 -2 -3
f 1 5 6 2
f 2 6 7 3
f 3 7 8 4
f 4 8 5 1
"""


def test_an_obj_of_polygons_is_read(tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(CUBE)
    [solid] = import_mesh(path, centered=False).base.solids

    assert solid.kind is Kind.FLOOR  # only the material gives the kind
    assert corners_of(solid) == [0, 0, -2, 2, 3, 0]
    assert len(solid.planes) == 6


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("v 2 0 0", "v 2 0", "line 5: a vertex has three numbers"),
        ("v 2 0 0", "v 2 x 0", "line 5: could not convert"),
        ("v 2 0 0", "v 2 nan 0", "not all vertices of 'cellar' are finite"),
        ("f 1 5 6 2", "f 1 5", "line 18: a face has at least three corners"),
        ("f 1 5 6 2", "f 1 5 6 9", "line 18: there is no vertex 9"),
        ("f 1 5 6 2", "f 1 5 6 0", "line 18: there is no vertex 0"),
        ("f 1 5 6 2", "f 1 5 6 -9", "line 18: there is no vertex -9"),
        ("f ", "# ", "there are no triangles in it"),
    ],
)
def test_a_wrong_line_of_an_obj_is_named(old: str, new: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / "a.obj"
    path.write_text(CUBE.replace(old, new))
    with pytest.raises(BaseError, match=said):
        import_mesh(path)


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.obj", b"\xff\xfe\x00", "it is no text"),
        ("a.glb", b"", "it is no GLB file, or damaged"),
        ("a.glb", b"glTF" + bytes(40), "it is no GLB file, or damaged"),
        ("a.stl", b"solid", "a mesh is a file named .glb or .obj"),
        ("a.obj", None, "cannot be read: No such file"),
        ("a.png", None, "cannot be read: No such file"),
        ("a.png", b"hello", "it is no PNG picture"),
    ],
)
def test_what_is_no_map_is_refused(name: str, content: bytes | None, said: str, tmp_path: Path) -> None:
    path = tmp_path / name
    if content is not None:
        path.write_bytes(content)
    with pytest.raises(BaseError, match=said):
        import_height_map(path, 40, 0.0, 1.0) if name == "a.png" else import_mesh(path)


@pytest.fixture(scope="module")
def whole_glb() -> bytes:
    scene = trimesh.Scene()
    scene.add_geometry(cuboid((0, 0, 0), (1, 1, 1)), node_name="wall")
    content = scene.export(file_type="glb")
    assert isinstance(content, bytes)
    return content


@given(data=st.data())
def test_a_damaged_glb_is_refused_in_one_line_or_read(
    whole_glb: bytes, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.glb"
    raw = bytearray(whole_glb)
    raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(raw)
    assert "\n" not in refusal(lambda: import_mesh(path))


def test_a_file_cannot_have_others_read(tmp_path: Path, whole_glb: bytes) -> None:
    gltf = trimesh.load_scene(io.BytesIO(whole_glb), file_type="glb").export(file_type="gltf")
    path = tmp_path / "a.glb"
    path.write_bytes(gltf["model.gltf"])
    with pytest.raises(BaseError, match="no GLB file, or damaged"):
        import_mesh(path)


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=2, water=0.1), 3)


@pytest.mark.parametrize("name", ["map.glb", "map.obj"])
def test_an_exported_map_comes_back_the_same(name: str, country: GameMap, tmp_path: Path) -> None:
    export_map(country, tmp_path)
    imported = import_mesh(tmp_path / name)
    world, base = country.world, imported.base

    # Corners are compared, because a solid may have faces that only touch it, which its mesh lacks.
    planes = np.split(world.faces, world.solid_start[1:-1])
    corners = [polyhedron(of_solid)[0] for of_solid in planes]
    before = np.array(
        [
            (kind, *one.min(axis=0), *one.max(axis=0))
            for kind, one in zip(world.solid_kind, corners, strict=True)
        ]
    )
    after = np.array([(solid.kind, *solid.low, *solid.high) for solid in base.solids])

    assert imported.notes == ()
    assert base.size == 60
    assert base.water_level == pytest.approx(world.water.max(), abs=1e-4)
    assert heights_of(imported) == pytest.approx(world.heights, abs=1e-4)
    assert after[np.argsort(after[:, 0], kind="stable")] == pytest.approx(
        before[np.argsort(before[:, 0], kind="stable")], abs=1e-4
    )
