"""Pictures become ground; files that are no height maps are refused."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.engine.maps.importing.import_files import height_map, heights_of, picture, refusal

from wildscav_engine.maps.base import BaseError
from wildscav_engine.maps.importing import import_height_map

Image = pytest.importorskip("PIL.Image")
trimesh = pytest.importorskip("trimesh")
pytest.importorskip("scipy")


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


@pytest.mark.parametrize("pixels", [2, 20, 21, 22, 64, 301])
def test_a_plane_stays_a_plane_however_many_pixels_it_has(pixels: int, tmp_path: Path) -> None:
    west_to_east = np.round(np.linspace(0, 65535, pixels)).astype(np.uint16)
    heights = heights_of(height_map(tmp_path / "a.png", np.tile(west_to_east, (pixels, 1))))

    # At the edges, only half of the pixels around a point exist.
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
