"""Meshes become ground and solids; other files are refused."""

from pathlib import Path

import numpy as np
import pytest
from tests.builders import box
from tests.engine.maps.importing.import_files import FLAT_GROUND, corners_of, cuboid, glb, heights_of, in_file

from wildscav_engine.geometry.world import Kind, build_world
from wildscav_engine.maps.base import BaseError
from wildscav_engine.maps.export.mesh import solids_mesh
from wildscav_engine.maps.importing import import_mesh

Image = pytest.importorskip("PIL.Image")
trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")


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


def test_more_parts_than_a_map_holds_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_engine.maps.importing.mesh.MAX_SOLIDS", 2)
    many = trimesh.util.concatenate([cuboid((2 * n, 0, 0), (2 * n + 1, 1, 1)) for n in range(3)])
    with pytest.raises(BaseError, match="it has more than 2 parts"):
        import_mesh(glb(tmp_path / "a.glb", many=many))
