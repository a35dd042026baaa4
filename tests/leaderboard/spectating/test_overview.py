"""The picture of a map from above, and where its pixels lie."""

from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from wildscav.errors import UserError
from wildscav_engine.maps import map_of
from wildscav_engine.record import read_record
from wildscav_leaderboard.spectating.overview import Placement, overview, overview_of_file, placement
from wildscav_leaderboard.spectating.trails import trails_of_file

Records = Callable[[str], Path]


def pixel(shown: Placement, x: float, z: float) -> tuple[float, float]:
    """Return the column and the row of a place in m."""
    return (x - shown.west) / shown.metres_per_pixel, (shown.north - z) / shown.metres_per_pixel


def test_the_picture_covers_exactly_the_map(record_of_track: Records) -> None:
    path = record_of_track("battle")
    shown = placement(map_of(read_record(path).spec.map))
    extent = trails_of_file(path).map

    assert pixel(shown, extent.west / 10, extent.north / 10) == (0.0, 0.0)
    corner = ((extent.west + extent.width) / 10, (extent.north - extent.height) / 10)
    assert pixel(shown, *corner) == pytest.approx((shown.width, shown.height))


def test_a_house_is_where_it_stands(record_of_track: Records) -> None:
    game_map = map_of(read_record(record_of_track("battle")).spec.map)
    shown = placement(game_map, 300)
    house = game_map.houses[0]
    column, row = pixel(shown, house.pose.x, house.pose.z)

    pixels = np.asarray(Image.open(BytesIO(overview(game_map, 300))).convert("RGB")).astype(int)

    around = pixels[round(row) - 2 : round(row) + 2, round(column) - 2 : round(column) + 2]
    red, green, _ = around.reshape(-1, 3).mean(axis=0)
    assert red > green + 20  # a roof; the ground is green


@pytest.mark.slow
def test_the_picture_is_small_and_of_the_size_that_it_says(record_of_track: Records) -> None:
    path = record_of_track("navigation")
    content = overview_of_file(path)
    shown = placement(map_of(read_record(path).spec.map))

    assert Image.open(BytesIO(content)).size == (shown.width, shown.height)
    assert Image.open(BytesIO(content)).format == "WEBP"
    assert len(content) < 600_000


def test_a_record_that_is_missing_is_one_clear_error(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"none\.wsr"):
        overview_of_file(tmp_path / "none.wsr")
