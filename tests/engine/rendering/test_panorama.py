"""Each ray of a panorama hits what it hits when it is cast alone, in whichever sector it is."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.builders import box, flat_world, map_from

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.panorama import divide
from wildscav_engine.rendering.tracing.frustum import MARGIN
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import Lidar
from wildscav_engine.specs.map_spec import MapConfig

FAR = 40.0  # m
elevations = st.floats(-90, 90)
traced_elevations = st.floats(-80, 80)


@pytest.fixture(scope="module")
def country() -> GameMap:
    return generate_map(MapConfig(size=60, relief=1.5, houses=2, vegetation=0.8), 11)


def cast_alone(country: GameMap, eye: tuple[float, float, float], yaw: float, lidar: Lidar) -> np.ndarray:
    """Return how far all rays of a LIDAR go, cast one by one, where what juts out of the map is invisible."""
    distances = np.empty(lidar.shape)
    for ring, column in np.ndindex(*lidar.shape):
        azimuth, height = yaw + 360.0 * column / lidar.azimuths, lidar.elevations[ring]
        level = max(cosine(height), 1e-12)
        way = (sine(azimuth) * level, sine(height), cosine(azimuth) * level)
        hit = raycast(country.world, *eye, *way, FAR).distance
        is_on_map = hit < np.inf and np.abs(eye + hit * np.array(way))[[0, 2]].max() <= 30.0 + 1e-9
        distances[ring, column] = hit if is_on_map else FAR
    return distances


@given(
    where=st.sampled_from(["anywhere", "in the open", "in a house", "underground", "outside the map"]),
    place=st.integers(0, 10**6),
    anywhere=st.tuples(st.floats(-29, 29), st.floats(-29, 29)),
    aside=st.tuples(st.floats(-1, 1), st.floats(-1, 1)),
    up=st.floats(0.3, 9),
    yaw=st.one_of(st.floats(0, 360), st.sampled_from([-45.0, 90.0])),
    azimuths=st.integers(1, 400),
    channels=st.integers(1, 9),
    between=st.tuples(elevations, elevations),
)
def test_rays_hit_what_they_hit_alone(
    country: GameMap,
    where: str,
    place: int,
    anywhere: tuple[float, float],
    aside: tuple[float, float],
    up: float,
    yaw: float,
    azimuths: int,
    channels: int,
    between: tuple[float, float],
) -> None:
    places = country.indoor if where == "in a house" else country.outdoor
    x, y, z = places[place % len(places)] + (aside[0], 0.0, aside[1])
    if where == "anywhere":
        x, z = anywhere
        y = ground_at(country.world, x, z).height
    y += {"in a house": 1.5, "underground": -50.0}.get(where, up)
    eye = (x + 70.0 * (where == "outside the map"), y, z)
    lidar = Lidar(channels, azimuths, range=FAR, lowest=min(between), highest=max(between))

    found = lidar.render(country, [eye], [yaw], [0.0])[0]

    np.testing.assert_allclose(found, cast_alone(country, eye, yaw, lidar), rtol=0, atol=1e-5)


@pytest.mark.parametrize("azimuths", [1, 2, 7, 360, 3600])
def test_no_post_is_so_thin_that_the_ray_at_it_misses(azimuths: int) -> None:
    """Posts of 2 cm, far away, exactly in the way of each of some rays."""
    for column in np.unique(np.linspace(0, azimuths - 1, 12).astype(int)):
        turn = np.radians(360.0 * column / azimuths)
        x, z = 30.0 * np.sin(turn), 30.0 * np.cos(turn)
        country = map_from(flat_world(80, [box((x - 0.01, 0, z - 0.01), (x + 0.01, 5, z + 0.01))]))
        ring = Lidar(channels=1, azimuths=azimuths, lowest=0, highest=0).render(
            country, [(0.0, 1.5, 0.0)], [0.0], [0.0]
        )[0, 0]
        assert ring[column] == pytest.approx(30.0, abs=0.02)


def test_steep_rays_meet_what_moves_too() -> None:
    """A plate above and one below the eye; a third belongs to the viewer, who does not see it."""
    plates = [box((-1, up, -1), (1, up + 0.1, 1)) for up in (1.0, 5.0, 4.0)]
    lidar = Lidar(channels=3, azimuths=4, lowest=-90, highest=90, moving=True)
    country = map_from(flat_world(40))

    moving = gather_solids(plates, [-1, -1, 7])
    images = lidar.render(country, [(0, 3, 0)] * 2, [0, 0], [0, 0], moving=moving, viewers=[7, 3])

    assert images[0, 0] == pytest.approx(2.0)
    assert images[1, 0] == pytest.approx(1.0)
    assert images[:, 2] == pytest.approx(1.9)
    assert images[:, 1] == pytest.approx(100.0)


@given(st.integers(1, 3600), st.integers(1, 128), traced_elevations, traced_elevations)
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
