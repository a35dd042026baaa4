"""Rays are processed in whole groups, which contain all that were asked for and none of another image."""

from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.rendering.tracing.frustum import Rectangle
from wildscav_engine.rendering.tracing.hit_buffer import (
    allocate_image,
    hit_buffer_in,
    start_in_row,
    whole_vectors,
)

SIDES = st.integers(1, 40)


@given(SIDES, SIDES, st.sampled_from([4, 8]), st.data())
def test_groups_of_rays_contain_the_pixels_of_a_row(
    width: int, height: int, at_once: int, data: st.DataObject
) -> None:
    left, row = data.draw(st.integers(0, width - 1)), data.draw(st.integers(0, height - 1))
    pixels = Rectangle(left, data.draw(st.integers(left + 1, width)), row, row + 1)
    image = allocate_image(height, width, 0.5, at_once)
    buffer = hit_buffer_in(width, image)

    count = whole_vectors(buffer, pixels.right - pixels.left)
    start = start_in_row(buffer, pixels, row, count)

    assert 0 <= start <= row * width + pixels.left
    assert row * width + pixels.right <= start + count <= width * height
    assert count <= image.strips.shape[1]
    assert count % at_once == 0 or count == width * height
