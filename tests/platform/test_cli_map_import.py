"""``wildscav map import``: what it prints, keeps and refuses."""

from pathlib import Path

import numpy as np
import pytest
import typer
from rich.console import Console
from typer.testing import CliRunner

from wildscav.cli.map_import import import_map
from wildscav.errors import UserError
from wildscav_engine.maps.base import load_base
from wildscav_engine.spec import MapConfig

Image = pytest.importorskip("PIL.Image")
trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")

app = typer.Typer()
app.command()(import_map)


@pytest.fixture(autouse=True)
def maps(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of bases."""
    monkeypatch.setenv("WILDSCAV_MAPS", str(tmp_path / "maps"))
    return tmp_path / "maps"


@pytest.fixture
def hills(tmp_path: Path) -> Path:
    path = tmp_path / "hills.png"
    Image.fromarray((np.arange(256) * 256).astype(np.uint16).reshape(16, 16)).save(path)
    return path


@pytest.fixture
def house(tmp_path: Path) -> Path:
    scene = trimesh.Scene()
    for name in ("wall.1", "wall.2", "roof"):
        scene.add_geometry(trimesh.creation.box(extents=(5, 2, 5)), node_name=name)
    leaf = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    scene.add_geometry(leaf, node_name="le\x1b[2Jaf")
    path = tmp_path / "house.glb"
    path.write_bytes(scene.export(file_type="glb"))
    return path


def run(monkeypatch: pytest.MonkeyPatch, *arguments: object) -> list[str]:
    """What the command prints; whatever it refuses is raised."""
    console = Console(width=60, force_terminal=False, record=True)
    monkeypatch.setattr("wildscav.console.console", console)
    done = CliRunner().invoke(app, list(map(str, arguments)), catch_exceptions=False)
    assert done.exit_code == 0
    return console.export_text().splitlines()


def config_in(lines: list[str]) -> MapConfig:
    """The config that the last lines show."""
    import tomllib

    return MapConfig.model_validate(tomllib.loads("\n".join(lines[-2:])))


def test_a_height_map_can_be_used_by_what_is_printed(
    hills: Path, maps: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lines = run(monkeypatch, hills, "--size", 80, "--lowest", -2, "--highest", 9, "--water", 0)
    config = config_in(lines)

    assert config.size == 80
    assert lines[0].startswith(f"{maps / str(config.base)}.wsb: ")
    assert lines[1] == "hills: 80 × 80 m, ground from -1.2 to 9.0 m, water at 0.0 m, 0 parts"
    assert config.base is not None
    assert load_base(config.base).size == 80


def test_a_mesh_can_be_used_by_what_is_printed(house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = run(monkeypatch, house, "--name", "my house", "--size", 60)
    config = config_in(lines)

    assert lines[1] == "my house: 60 × 60 m, flat ground, no water, 3 parts (2 wall, 1 roof)"
    assert lines[2] == "note: left out, because flat: 'le\\x1b[2Jaf'"
    assert config.base is not None
    assert len(load_base(config.base).solids) == 3


@pytest.mark.parametrize(
    ("file", "options", "code", "said"),
    [
        ("hills.png", ["--size", 80], 2, "a height map needs --size and --highest"),
        ("hills.png", ["--highest", 80], 2, "a height map needs --size and --highest"),
        ("hills.png", ["--size", 80, "--highest", 8, "--in-place"], 2, "cannot be left --in-place"),
        ("hills.png", ["--size", 81, "--highest", 8], 1, "size is 81, must be an even number"),
        ("house.glb", ["--highest", 8], 2, "--lowest and --highest are for height maps"),
        ("house.glb", ["--size", 7], 1, "house.glb: size is 7"),
        ("none.glb", [], 1, "none.glb: cannot be read: No such file or directory"),
        ("notes.txt", [], 1, "a mesh is a file named .glb or .obj"),
    ],
)
def test_what_cannot_be_imported_is_one_clear_line(
    file: str,
    options: list[object],
    code: int,
    said: str,
    hills: Path,
    house: Path,
    maps: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    with pytest.raises(UserError) as caught:
        run(monkeypatch, hills.with_name(file), *options)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == code
    assert not maps.exists()
