"""What is brought in: pictures become ground, meshes become ground and solids, the rest is refused."""

import io
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import box

from wildscav_engine.geometry.polyhedra import polyhedron
from wildscav_engine.geometry.world import Kind, Solid, build_world
from wildscav_engine.maps import GameMap, generate_map
from wildscav_engine.maps.base import Base, BaseError
from wildscav_engine.maps.export import export_map
from wildscav_engine.maps.importing import Imported, import_height_map, import_mesh
from wildscav_engine.maps.mesh import Mesh, solids_mesh, terrain_mesh
from wildscav_engine.spec import MapConfig

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


@pytest.mark.parametrize("kind", [np.uint8, np.uint16])
def test_black_is_lowest_white_is_highest_and_the_upper_edge_is_north(kind: type, tmp_path: Path) -> None:
    grey = np.zeros((21, 21), kind)
    grey[0] = np.iinfo(kind).max
    imported = height_map(tmp_path / "a.png", grey)

    heights = heights_of(imported)
    assert heights.shape == (21, 21)
    assert (heights[20] == 10.0).all()  # the last row is the northernmost
    assert (heights[:20] == 0.0).all()
    assert (imported.base.name, imported.base.size, imported.base.water_level) == ("a", 40, -np.inf)
    assert imported.notes == ()


def test_few_pixels_are_joined_by_straight_slopes(tmp_path: Path) -> None:
    heights = heights_of(height_map(tmp_path / "a.png", np.array([[0, 255], [0, 255]], np.uint8)))

    assert heights == pytest.approx(np.tile(np.linspace(0.0, 10.0, 21), (21, 1)))


@pytest.mark.parametrize("pixels", [2, 20, 21, 22, 64, 301])
def test_a_plane_stays_a_plane_however_many_pixels_it_has(pixels: int, tmp_path: Path) -> None:
    west_to_east = np.round(np.linspace(0, 65535, pixels)).astype(np.uint16)
    heights = heights_of(height_map(tmp_path / "a.png", np.tile(west_to_east, (pixels, 1))))

    # At the edges only half of the pixels around a point are there.
    inside = heights[:, 1:-1]
    assert inside == pytest.approx(np.tile(np.linspace(0.0, 10.0, 21)[1:-1], (21, 1)), abs=0.001)
    assert heights[0, 0] == pytest.approx(0.0, abs=0.2)


def test_many_pixels_are_averaged_and_not_skipped(tmp_path: Path) -> None:
    stripes = np.tile(np.array([0, 255], np.uint8), (400, 200))
    heights = heights_of(height_map(tmp_path / "a.png", stripes))

    assert heights == pytest.approx(5.0, abs=0.5)


def test_lakes_are_shallow_enough_to_wade_through(tmp_path: Path) -> None:
    imported = height_map(tmp_path / "a.png", np.array([[0, 65535]] * 2, np.uint16), water_level=4.0)

    assert heights_of(imported).min() == pytest.approx(2.8)
    assert imported.notes == ("lake beds up to 4.0 m deep are raised to 1.2 m: agents wade, not swim",)


def test_a_coarse_picture_says_so(tmp_path: Path) -> None:
    path = picture(tmp_path / "a.png", np.array([[0, 255]] * 2, np.uint8))
    imported = import_height_map(path, 40, 0.0, 51.0)

    assert imported.notes[0].startswith("two shades of grey are 0.20 m apart")


@pytest.mark.parametrize(
    ("grey", "options", "said"),
    [
        (np.zeros((4, 5), np.uint8), {}, "it is 5 × 4 pixels; a map is square"),
        (np.zeros((1, 1), np.uint8), {}, "it is 1 × 1 pixels"),
        (np.zeros((4, 4, 3), np.uint8), {}, "its pixels are RGB, must be grey"),
        (np.zeros((4, 4), np.bool_), {}, "its pixels are 1, must be grey"),
        (np.zeros((4, 4), np.uint8), {"size": 41}, "size is 41, must be an even number"),
        (np.zeros((4, 4), np.uint8), {"size": 4000}, "size is 4000, must be an even number"),
        (np.zeros((4, 4), np.uint8), {"water_level": 0.0}, "the highest ground is at 0 m"),
        (np.zeros((4, 4), np.uint8), {"water_level": np.nan}, "the water level is nan"),
    ],
)
def test_a_picture_that_is_no_height_map_is_refused(
    grey: NDArray[np.generic], options: dict[str, float], said: str, tmp_path: Path
) -> None:
    with pytest.raises(BaseError, match=said):
        height_map(tmp_path / "a.png", grey, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize(("lowest", "highest"), [(1.0, 0.0), (np.nan, 0.0), (-2000.0, 0.0), (0.0, np.inf)])
def test_heights_that_no_map_has_are_refused(lowest: float, highest: float, tmp_path: Path) -> None:
    path = picture(tmp_path / "a.png", np.zeros((4, 4), np.uint8))
    with pytest.raises(BaseError, match="the heights run from"):
        import_height_map(path, 40, lowest, highest)


def test_a_picture_of_endless_pixels_is_refused_unread(tmp_path: Path) -> None:
    path = picture(tmp_path / "a.png", np.zeros((4, 4), np.uint8))
    raw = bytearray(path.read_bytes())
    for pixels in (20_000, 10**9):
        raw[16:24] = pixels.to_bytes(4) * 2
        raw[29:33] = __import__("zlib").crc32(raw[12:29]).to_bytes(4)
        path.write_bytes(raw)
        with pytest.raises(BaseError):
            import_height_map(path, 40, 0.0, 1.0)


@pytest.fixture(scope="module")
def whole_picture(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    grey = (np.arange(400) * 160).astype(np.uint16).reshape(20, 20)
    return picture(tmp_path_factory.mktemp("whole") / "a.png", grey).read_bytes()


@given(data=st.data())
def test_a_damaged_picture_is_refused_in_one_line_or_read(
    whole_picture: bytes, data: st.DataObject, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.png"
    raw = bytearray(whole_picture[: data.draw(st.integers(0, len(whole_picture)))])
    if raw:
        raw[data.draw(st.integers(0, len(raw) - 1))] ^= data.draw(st.integers(1, 255))
    path.write_bytes(raw)
    assert "\n" not in refusal(lambda: import_height_map(path, 40, 0.0, 1.0))


def refusal(action: object) -> str:
    """What an action is refused with, if it is; other errors pass through."""
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
    """One of our meshes as it is exported: z mirrored."""
    return trimesh.Trimesh(mesh.vertices * [1, 1, -1], mesh.triangles[:, ::-1], process=False)


def corners_of(solid: Solid) -> list[float]:
    return [round(float(number), 4) for number in (*solid.low, *solid.high)]


def test_a_box_of_a_file_stands_in_the_mirrored_place(tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", wall=cuboid((2, 0, 5), (4, 3, 6)))
    base = import_mesh(path, size=40, centered=False).base

    [solid] = base.solids
    assert solid.kind is Kind.WALL
    assert corners_of(solid) == [2, 0, -6, 4, 3, -5]  # south of the middle
    assert len(solid.planes) == 6
    assert (base.heights, base.size, base.name, base.water_level) == (None, 40, "a", -np.inf)


def test_a_mesh_is_centred_on_the_smallest_map_that_holds_it(tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", a=cuboid((100, 0, 0), (110, 3, 1)), b=cuboid((150, 2, 0), (163, 3, 5)))
    base = import_mesh(path).base

    assert base.size == 64
    assert corners_of(base.solids[1])[0::3] == [18.5, 31.5]
    assert import_mesh(path, size=100).base.size == 100
    assert import_mesh(path, centered=False).base.size == 326


def test_our_own_export_comes_back_in_the_same_place(tmp_path: Path) -> None:
    east, north = np.meshgrid(np.arange(31), np.arange(31))
    heights = 0.1 * east + 0.01 * north * north - 1.0
    solids = [
        box((-20, 0, 3), (-15, 4, 9)),
        box((-15, 0, 3), (-10, 4, 9), Kind.FLOOR),  # touches the first
        box((25, 1, 20), (33, 2, 24), Kind.ROOF),  # reaches beyond the border
    ]
    world = build_world((-30.0, -30.0), heights, np.full((30, 30), -np.inf), solids, np.zeros((0, 3)))
    parts = {
        f"{solid.kind.name.lower()}_{n}": in_file(solids_mesh(world, [n])) for n, solid in enumerate(solids)
    }
    path = glb(tmp_path / "a.glb", terrain=in_file(terrain_mesh(world)), **parts)
    base = import_mesh(path).base

    assert base.size == 60
    assert heights_of(Imported(base, ())) == pytest.approx(heights, abs=1e-5)
    assert {(one.kind, *corners_of(one)) for one in base.solids} == {
        (one.kind, *corners_of(one)) for one in solids
    }


@pytest.mark.parametrize("suffix", ["glb", "obj"])
def test_solids_of_one_kind_in_one_mesh_stay_apart(suffix: str, tmp_path: Path) -> None:
    solids = [box((i, 0, 0), (i + 1, 2, 1)) for i in range(12)]  # each touches the next
    world = build_world((-30.0, -30.0), FLAT_GROUND, np.full((30, 30), -np.inf), solids, np.zeros((0, 3)))
    path = tmp_path / f"a.{suffix}"
    in_file(solids_mesh(world)).export(path)  # type: ignore[attr-defined]

    assert [corners_of(one) for one in import_mesh(path, centered=False).base.solids] == [
        corners_of(one) for one in solids
    ]


def test_faces_with_vertices_of_their_own_are_one_solid(tmp_path: Path) -> None:
    mesh = cuboid((0, 0, 0), (1, 2, 3))
    mesh.unmerge_vertices()  # type: ignore[attr-defined]
    assert len(mesh.vertices) == 36  # type: ignore[attr-defined]

    assert len(import_mesh(glb(tmp_path / "a.glb", a=mesh)).base.solids) == 1


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("Stairs.001", Kind.STAIR),
        ("rockBig", Kind.ROCK),
        ("ground floor", Kind.FLOOR),
        ("BUSHES_2", Kind.BUSH),
        ("Cube.017", Kind.WALL),
        ("wallpaper", Kind.WALL),
        ("tree_trunk", Kind.TRUNK),
        ("garden_furniture", Kind.FURNITURE),
    ],
)
def test_the_name_says_what_a_part_is(name: str, kind: Kind, tmp_path: Path) -> None:
    path = glb(tmp_path / "a.glb", **{name: cuboid((0, 0, 0), (1, 1, 1))})
    assert import_mesh(path).base.solids[0].kind is kind


def test_the_material_says_what_a_part_is_that_has_no_telling_name(tmp_path: Path) -> None:
    mesh = cuboid((0, 0, 0), (1, 1, 1))
    material = trimesh.visual.material.PBRMaterial(name="Roof tiles")
    mesh.visual = trimesh.visual.TextureVisuals(material=material)  # type: ignore[attr-defined]
    path = glb(tmp_path / "a.glb", Cube=mesh, Wall=mesh)
    assert {solid.kind for solid in import_mesh(path).base.solids} == {Kind.ROOF, Kind.WALL}


def test_a_node_stands_where_the_scene_puts_it(tmp_path: Path) -> None:
    scene = trimesh.Scene()
    mesh = trimesh.creation.box(extents=(2, 2, 4))
    turn = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0))
    scene.add_geometry(mesh, node_name="one", transform=trimesh.transformations.translation_matrix((9, 1, 9)))
    scene.add_geometry(mesh, node_name="two", transform=turn)
    path = tmp_path / "a.glb"
    path.write_bytes(scene.export(file_type="glb"))

    found = [corners_of(one) for one in import_mesh(path, centered=False).base.solids]
    assert sorted(found) == [[-2, -1, -1, 2, 1, 1], [8, 0, -11, 10, 2, -7]]


def test_water_gives_the_level_of_the_lakes(tmp_path: Path) -> None:
    ground = trimesh.Trimesh(
        [[-25, -1, -25], [25, -1, -25], [25, 5, 25], [-25, 5, 25]], [[0, 1, 2], [0, 2, 3]]
    )
    lake = trimesh.Trimesh([[-5, 0, -5], [5, 0, -5], [5, 0, 5]], [[0, 1, 2]])
    path = glb(tmp_path / "a.glb", ground=ground, water=lake)

    assert import_mesh(path).base.water_level == 0.0
    assert import_mesh(path, water_level=1.0).base.water_level == 1.0
    assert import_mesh(path).base.solids == ()
    assert heights_of(import_mesh(path))[0, 0] == pytest.approx(5.0)  # +z of the file is south
    assert import_mesh(path).notes == ()


def test_ground_that_does_not_cover_the_map_is_continued_and_noted(tmp_path: Path) -> None:
    ground = trimesh.Trimesh([[-30, 1, -30], [30, 1, -30], [30, 1, 30]], [[0, 1, 2]])
    imported = import_mesh(glb(tmp_path / "a.glb", terrain=ground))

    assert (heights_of(imported) == 1.0).all()
    assert imported.notes == ("the ground covers 52 % of the map; the rest is as high as what is next",)


def test_flat_parts_are_left_out_and_named(tmp_path: Path) -> None:
    leaf = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]], [[0, 1, 2], [1, 3, 2]])
    imported = import_mesh(glb(tmp_path / "a.glb", leaf=leaf, rock=cuboid((0, 0, 0), (1, 1, 1))))

    assert len(imported.base.solids) == 1
    assert imported.notes == ("left out, because flat: 'leaf'",)


def test_a_sharp_edge_keeps_nobody_at_a_distance(tmp_path: Path) -> None:
    # A wedge of a roof, 4 m above the ground at its sharp edge in the west.
    corners = [(0, 4, z) for z in (0, 5)] + [(6, y, z) for y in (4, 6) for z in (0, 5)]
    wedge = trimesh.convex.convex_hull(np.array(corners, float))
    [solid] = import_mesh(glb(tmp_path / "a.glb", roof=wedge), centered=False).base.solids
    world = build_world((-30.0, -30.0), FLAT_GROUND, np.full((30, 30), -np.inf), [solid], np.zeros((0, 3)))

    def is_free(x: float, y: float) -> bool:
        return bool((world.faces[:, :3] @ [x, y, -2.5] > world.faces[:, 3] + world.face_reach).any())

    assert is_free(-0.5, 3.5)
    assert not is_free(-0.4, 3.5)
    assert not is_free(3.0, 4.5)
    assert is_free(3.0, 2.2)


def l_shape() -> object:
    outline = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 4), (0, 4)]
    points = [(x, y, z) for y in (0, 2) for x, z in outline]
    caps = [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]
    sides = [t for i in range(6) for j in [(i + 1) % 6] for t in ((i, j + 6, j), (i, i + 6, j + 6))]
    upper = [(a + 6, c + 6, b + 6) for a, b, c in caps]
    return trimesh.Trimesh(points, [*caps, *upper, *sides], process=False)


def open_box() -> object:
    mesh = cuboid((0, 0, 0), (1, 1, 1))
    return trimesh.Trimesh(mesh.vertices, mesh.faces[:-2], process=False)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("parts", "options", "said"),
    [
        (
            {"house": l_shape},
            {},
            "'house' is not convex: it fills 6[0-9] % of its hull; split it into convex",
        ),
        ({"tub": open_box}, {}, "'tub' has an open surface"),
        ({"ball": lambda: trimesh.creation.icosphere(2)}, {}, "'ball' has more than 94 faces"),
        (
            {"a": lambda: cuboid((0, 0, 0), (100, 1, 1))},
            {"size": 60},
            "size is 60, but it needs a map of 100 m",
        ),
        ({"a": lambda: cuboid((0, 0, 0), (9e3, 1, 1))}, {}, "needs a map of 9000 m, 2000 are allowed"),
        ({"a": lambda: cuboid((0, 0, 0), (1, 9e3, 1))}, {}, "a part lies outside"),
        ({"a": lambda: cuboid((0, 0, 0), (1, 1, 1))}, {"size": 61}, "size is 61, must be an even"),
        ({"a": lambda: cuboid((0, 0, 0), (1, 1, 1))}, {"water_level": 1.0}, "highest ground is at 0 m"),
        (
            {
                "terrain": lambda: cuboid((-25, -1, -25), (25, 0, 25)),
                "hut": lambda: cuboid((40, 0, 0), (41, 1, 1)),
            },
            {},
            "'hut' lies outside the map of 50 m",
        ),
    ],
)
def test_a_mesh_that_no_map_can_hold_is_refused(
    parts: dict[str, object], options: dict[str, float], said: str, tmp_path: Path
) -> None:
    path = glb(tmp_path / "a.glb", **{name: make() for name, make in parts.items()})  # type: ignore[operator]
    with pytest.raises(BaseError, match=said) as caught:
        import_mesh(path, **options)  # type: ignore[arg-type]
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)


def test_more_parts_than_a_map_holds_are_refused(tmp_path: Path) -> None:
    vertices = np.array(cuboid((0, 0, 0), (1, 1, 1)).vertices)  # type: ignore[attr-defined]
    faces = np.array(cuboid((0, 0, 0), (1, 1, 1)).faces)  # type: ignore[attr-defined]
    count = 20_001
    many = trimesh.Trimesh(
        (vertices + np.arange(count)[:, None, None] * [0.01, 0, 0]).reshape(-1, 3),
        (faces + 8 * np.arange(count)[:, None, None]).reshape(-1, 3),
        process=False,
    )
    with pytest.raises(BaseError, match="it has more than 20000 parts"):
        import_mesh(glb(tmp_path / "a.glb", many=many))


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

    assert solid.kind is Kind.FLOOR  # only the material tells
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


def test_a_base_of_a_mesh_can_be_kept_and_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from wildscav_engine.maps.base import load_base, save_base

    monkeypatch.setenv("WILDSCAV_MAPS", str(tmp_path))
    rock = trimesh.creation.icosphere(1, radius=2.0)
    base: Base = import_mesh(glb(tmp_path / "a.glb", rock=rock)).base
    digest, _ = save_base(base)
    again = load_base(digest)

    assert len(again.solids[0].planes) == 80
    assert again.solids[0].planes.tobytes() == base.solids[0].planes.tobytes()


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, houses=2, water=0.1), 3)


@pytest.mark.parametrize("name", ["map.glb", "map.obj"])
def test_an_exported_map_comes_back_the_same(name: str, country: GameMap, tmp_path: Path) -> None:
    export_map(country, tmp_path)
    imported = import_mesh(tmp_path / name)
    world, base = country.world, imported.base

    # A solid may have faces that only touch it, which its mesh has not: so corners are compared.
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
