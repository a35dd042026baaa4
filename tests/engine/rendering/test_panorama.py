"""Each ray of a panorama hits what it hits when it is cast alone, in whichever sector it is."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.builders import box, flat_world, map_from

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.geometry.rays import cast_ray
from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import Lidar
from wildscav_engine.specs.map_spec import MapConfig

FAR = 40.0  # m
elevations = st.floats(-90, 90)


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
        hit = cast_ray(country.world, *eye, *way, FAR).distance
        is_on_map = hit < np.inf and np.abs(eye + hit * np.array(way))[[0, 2]].max() <= 30.0 + 1e-9
        distances[ring, column] = hit if is_on_map else FAR
    return distances


@settings(max_examples=150)
@given(
    x=st.floats(-29, 29),
    z=st.floats(-29, 29),
    up=st.floats(0.3, 9),
    yaw=st.floats(0, 360),
    azimuths=st.integers(1, 400),
    channels=st.integers(1, 9),
    one=elevations,
    other=elevations,
)
def test_rays_hit_what_they_hit_alone(
    country: GameMap,
    x: float,
    z: float,
    up: float,
    yaw: float,
    azimuths: int,
    channels: int,
    one: float,
    other: float,
) -> None:
    eye = (x, ground_at(country.world, x, z).height + up, z)
    lidar = Lidar(
        channels=channels, azimuths=azimuths, lowest=min(one, other), highest=max(one, other), range=FAR
    )

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
