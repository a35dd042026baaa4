"""``wildscav map import``: what it prints, keeps and refuses."""

import json
import struct
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import typer
from tests.unlimited import call_here
from typer.testing import CliRunner

from wildscav.errors import UserError
from wildscav.terminal.console import PlainConsole
from wildscav_engine.maps.base import load_base
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_inspect.map import import_map

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
def here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Import in this process."""
    monkeypatch.setattr("wildscav.system.limited_process.call_limited", call_here)


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
    console = PlainConsole(width=60, force_terminal=False, record=True)
    monkeypatch.setattr("wildscav.terminal.console.console", console)
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


@pytest.mark.usefixtures("here")
def test_a_mesh_can_be_used_by_what_is_printed(house: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    lines = run(monkeypatch, house, "--name", "my house", "--size", 60)
    config = config_in(lines)

    assert lines[1] == "my house: 60 × 60 m, flat ground, no water, 3 parts (2 wall, 1 roof)"
    assert lines[2] == "note: left out, because flat: 'le\\x1b[2Jaf'"
    assert config.base is not None
    assert len(load_base(config.base).solids) == 3


@pytest.mark.usefixtures("here")
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


def huge_accessor(path: Path) -> Path:
    """A GLB of some 400 bytes that asks for 9 GiB of vertices."""
    content = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": "wall"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "accessors": [{"componentType": 5126, "count": 800_000_000, "type": "VEC3"}],
    }
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4s4I", b"glTF", 2, 20 + len(text), len(text), 0x4E4F534A)
    path.with_suffix(".glb").write_bytes(head + text)
    return path.with_suffix(".glb")


def huge_picture(path: Path) -> Path:
    """A PNG whose pixels take 600 MB, packed into some hundred kB."""
    side, rows = 17_000, zlib.compressobj(9)
    data = b"".join(rows.compress(bytes(1 + 2 * side)) for _ in range(side)) + rows.flush()
    return picture(path.with_suffix(".png"), side, data)


def picture(path: Path, side: int, data: bytes) -> Path:
    """A square PNG of 16 bits a pixel."""
    chunks = (b"IHDR", struct.pack(">2I5B", side, side, 16, 0, 0, 0, 0)), (b"IDAT", data), (b"IEND", b"")
    content = b"".join(
        struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))
        for kind, body in chunks
    )
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + content)
    return path


@pytest.mark.slow
@pytest.mark.parametrize("make", [huge_accessor, huge_picture])
def test_a_file_that_would_eat_memory_is_refused_in_a_line(
    make: Callable[[Path], Path], tmp_path: Path, maps: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = make(tmp_path / "map")
    assert path.stat().st_size < 1_000_000
    heights = ("--size", 100, "--highest", 10) if path.suffix == ".png" else ()
    with pytest.raises(UserError) as caught:
        run(monkeypatch, path, *heights)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)
    assert not maps.exists() or not list(maps.iterdir())


@pytest.mark.slow
def test_the_largest_picture_that_is_allowed_can_be_brought_in(
    tmp_path: Path, maps: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    side, rows = 8192, zlib.compressobj(1)
    data = b"".join(rows.compress(b"\0" + struct.pack(">H", 8 * row) * side) for row in range(side))
    path = picture(tmp_path / "largest.png", side, data + rows.flush())

    lines = run(monkeypatch, path, "--size", 2000, "--highest", 100)

    assert lines[1] == "largest: 2000 × 2000 m, ground from 0.0 to 100.0 m, no water, 0 parts"
    assert config_in(lines).size == 2000
