"""Pictures of a seat of words: where things are in them, and their marks."""

import io

import numpy as np
import pytest
from PIL import Image
from tests.platform.language.flat_world import OPEN
from tests.platform.wildscav.skills.observations import enemy, match_info, seen

from wildscav import SupplyBox
from wildscav_language.pictures import pixel_of
from wildscav_language.seat import Seat

GREY = np.full((270, 480, 3), 128, np.uint8)


@pytest.mark.parametrize(
    ("yaw", "pitch", "pixel"),
    [
        (0.0, 0.0, (240.0, 135.0)),  # 10 m north at the height of the eyes: the middle
        (45.0, 0.0, None),  # the left edge of a view of 90 degrees, and just beyond
        (44.0, 0.0, (8.2, 135.0)),
        (0.0, 10.0, (240.0, 92.7)),  # who looks down sees it above the middle
        (180.0, 0.0, None),  # behind
    ],
)
def test_where_a_point_is_in_a_picture(yaw: float, pitch: float, pixel: tuple[float, float] | None) -> None:
    found = pixel_of((0.0, 1.5, 10.0), seen(yaw=yaw + 0.001, pitch=pitch), 480, 270)

    assert found == (None if pixel is None else pytest.approx(pixel, abs=0.1))


def picture(*, marks: bool) -> Image.Image:
    """Return what a seat sees of a box and an enemy ahead."""
    seat = Seat()
    seat.begin(match_info())
    told = {"supply_boxes": (SupplyBox(7, (1.0, 0.0, 6.0), 3),), "agents": (enemy((-2.0, 0.0, 8.0)),)}
    seat.leave()
    seat.answer(seen(tensors={"lidar": OPEN, "camera": GREY}, **told))
    file = seat.picture(marks=marks)
    assert len(file) < 2**20
    return Image.open(io.BytesIO(file))


def test_marks_are_drawn_on_demand() -> None:
    assert (np.asarray(picture(marks=False)) == GREY).all()

    marked = np.asarray(picture(marks=True)) != GREY

    assert marked[:, :240].any()  # the enemy is to the left
    assert marked[:, 240:].any()


def test_a_seat_without_a_camera_has_no_picture() -> None:
    seat = Seat()
    seat.begin(match_info())
    seat.leave()
    seat.answer(seen(tensors={"lidar": OPEN}))

    with pytest.raises(ValueError, match="no camera"):
        seat.picture()
