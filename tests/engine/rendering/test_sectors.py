"""A sector's camera knows where each of its rays is, so that no ray is left out that may hit something."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.rendering.tracing.frustum import MARGIN
from wildscav_engine.rendering.tracing.sectors import divide

elevations = st.floats(-80, 80)


@given(st.integers(1, 3600), st.integers(1, 128), elevations, elevations)
def test_every_ray_is_within_the_margins_of_its_column_and_row(
    azimuths: int, rings: int, one: float, other: float
) -> None:
    heights = np.linspace(max(one, other), min(one, other), rings)

    _, columns, optics = divide(azimuths, heights)

    places = np.arange(columns) - (columns - 1) / 2.0
    angles = places * 2.0 * np.pi / azimuths
    right = np.tan(angles)
    column = right * (optics.scale + optics.curve * right**2)
    assert (np.abs(column - places) <= optics.margin + MARGIN).all()
    assert (np.abs(right) < optics.half_width).all()
    above = np.tan(np.radians(heights))[:, None] / np.cos(angles)
    assert (np.abs(above) < optics.half_height).all()
    up, give = above * optics.scale_up, np.abs(above) * optics.spread
    row = np.arange(rings)[:, None] + 0.5
    assert (optics.level - (up + give) - optics.margin_up - MARGIN <= row).all()
    assert (row <= optics.level - (up - give) + optics.margin_up + MARGIN).all()


@given(st.integers(1, 3600))
def test_sectors_hold_every_column_once_but_for_the_last_ones(azimuths: int) -> None:
    number, columns, optics = divide(azimuths, np.array([0.0]))
    assert (number - 1) * columns < azimuths <= number * columns
    assert optics.half_width < math.tan(math.radians(60))


@given(st.integers(1, 3600))
def test_what_is_beside_a_sector_is_in_none_of_its_columns(azimuths: int) -> None:
    """The tangents of its sides belong beyond the first and the last column, larger ones farther out."""
    _, columns, optics = divide(azimuths, np.array([0.0]))
    right = np.linspace(0.0, optics.half_width + 0.01, 500)
    place = right * (optics.scale + optics.curve * right**2)
    assert (np.diff(place) > 0.0).all()
    assert place[-1] > columns / 2.0 + optics.margin


def test_a_default_lidar_is_hardly_enlarged() -> None:
    number, columns, optics = divide(360, np.linspace(15, -15, 16))
    assert (number, columns) == (10, 36)
    assert optics.margin < 0.01  # columns
    assert optics.margin_up == 0.0
    assert optics.spread / optics.scale_up == pytest.approx(0.036, abs=0.001)
