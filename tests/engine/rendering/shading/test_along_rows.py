"""What is computed for many pixels of a row at once is what each of them would get alone."""

from itertools import islice

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import box, flat_world, map_from

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.cameras import Cameras
from wildscav_engine.rendering.hits import Hits, allocate_hits
from wildscav_engine.rendering.images import trace
from wildscav_engine.rendering.shading.light.ambient_occlusion import (
    LOOKED_AT,
    Around,
    are_alike_far,
    unoccluded_share,
    write_depths,
    write_shares,
    write_tilts,
)
from wildscav_engine.rendering.shading.pixel_rows import (
    Channels,
    Places,
    RowOfPixels,
    Tilts,
    Vectors,
    allocate_rows,
    allocate_texture_scratch,
    cosines_of,
    view_of,
    write_directions,
)
from wildscav_engine.rendering.shading.sky import (
    CLOUD,
    CLOUDS_FROM,
    CLOUDS_REACH,
    CLOUDS_STEP,
    CLOUDS_WIDTH,
    DISC,
    FLATTENED,
    GLOW,
    INTO_CLOUDS,
    SUN_COLOR,
    SUN_DIRECTION,
    clouds,
    write_sky,
)
from wildscav_engine.rendering.shading.surfaces import has_spots, write_spotted
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import ColorCamera

Vector = tuple[float, float, float]
CAMERA = ColorCamera(width=160, height=90)


def traced(game_map: GameMap, eye: Vector, yaw: float, pitch: float) -> tuple[Cameras, Hits]:
    cameras = CAMERA._cameras([eye], [yaw], [pitch], None)
    hits = allocate_hits(1, CAMERA.height, CAMERA.width)
    trace(game_map.scene, gather_solids([]), cameras, hits)
    return cameras, hits


def row_of(cameras: Cameras, row: int) -> RowOfPixels:
    rows = iter(allocate_rows(CAMERA.width))
    kinds = Vectors, Channels, Vectors, Tilts, Places
    pixels = RowOfPixels(*(kind(*islice(rows, 3)) for kind in kinds), *rows)
    view = view_of(cameras, 0, CAMERA.height, CAMERA.width, 1)
    cosines = cosines_of(cameras.half_width, CAMERA.height, CAMERA.width)[row]
    write_directions(view, row, np.arange(CAMERA.width, dtype=np.int32), cosines, pixels.ways)
    return pixels


def shares_at(
    hits: Hits, cameras: Cameras, row: int, first: int, last: int, normals: NDArray[np.float64]
) -> tuple[NDArray[np.float32], NDArray[np.float64]]:
    """Return the shares of ambient light of some columns, computed together and one by one."""
    view, pixels = view_of(cameras, 0, CAMERA.height, CAMERA.width, 1), row_of(cameras, row)
    depths = np.empty((CAMERA.height, CAMERA.width), np.float32)
    write_depths(hits.distance[0], cosines_of(cameras.half_width, *depths.shape), depths)
    for part in range(3):
        pixels.normal[part][:] = normals[:, part]
    write_tilts(view, row, pixels.normal, pixels.tilt)
    distances, shares = hits.distance[0, row], np.empty(last - first, np.float32)
    around = Around(*np.empty((4, LOOKED_AT), np.float32))
    write_shares(depths, view, row, first, float(distances[first]), pixels.tilt, shares)
    alone = [
        unoccluded_share(depths, row, column, view, float(distances[column]), pixels.tilt, around)
        for column in range(first, last)
    ]
    return shares, np.array(alone)


def normals_of(game_map: GameMap, hits: Hits, row: int) -> NDArray[np.float64]:
    """Return (W, 3) those of flat ground and of solids."""
    up = np.array([0.0, 1.0, 0.0])
    faces = [*game_map.world.faces[:, :3], up]
    met = np.where(hits.solid[0, row] >= 0, hits.face[0, row], -1)
    return np.array([faces[face] for face in met])


def test_corners_are_as_dark_together_as_alone() -> None:
    game_map = map_from(flat_world(40, [box((-6, -1, 4), (6, 5, 5)), box((1, -1, 1), (2, 2, 4))]))
    cameras, hits = traced(game_map, (-1.0, 1.6, 0.0), 20.0, 18.0)
    together, alone = [], []
    for row in range(0, CAMERA.height, 3):
        for first in range(0, CAMERA.width, 32):
            if are_alike_far(hits.distance[0, row, first : first + 32]):
                normals = normals_of(game_map, hits, row)
                both = shares_at(hits, cameras, row, first, first + 32, normals)
                together.append(both[0])
                alone.append(both[1])
    differences = np.abs(np.concatenate(together) - np.concatenate(alone))
    assert np.concatenate(alone).min() < 0.8, "there are dark corners among them"
    assert (np.concatenate(alone) == 1.0).mean() > 0.3, "and open places"
    assert differences.mean() < 0.01
    assert np.quantile(differences, 0.99) < 0.12


def test_on_even_ground_nothing_takes_any_light() -> None:
    game_map = map_from(flat_world(200, []))
    cameras, hits = traced(game_map, (0.0, 1.6, 0.0), 0.0, 30.0)
    for row in range(30, CAMERA.height):
        together, alone = shares_at(hits, cameras, row, 0, 32, normals_of(game_map, hits, row))
        assert (together == 1.0).all()
        assert (alone == 1.0).all()


def test_pixels_are_only_looked_at_together_where_they_are_about_as_far() -> None:
    assert are_alike_far(np.array([10.0, 11.0, 9.0], np.float32))
    assert not are_alike_far(np.array([10.0, 12.0], np.float32))
    assert not are_alike_far(np.array([10.0, 8.0], np.float32))
    assert not are_alike_far(np.array([10.0, np.inf], np.float32))


def spotted(kind: Kind, normal: Vector, columns: slice) -> NDArray[np.float32]:
    """Return (C, 3) the colours of some columns of a row that shows a face from 3 m away to 6 m."""
    camera = CAMERA._cameras([(3.0, 1.5, -7.0)], [20.0], [5.0], None)
    view, pixels = view_of(camera, 0, CAMERA.height, CAMERA.width, 1), row_of(camera, 50)
    distances = np.linspace(3.0, 6.0, CAMERA.width, dtype=np.float32)[columns]
    ways = Vectors(*(part[columns] for part in pixels.ways))
    shown = np.empty((3, len(distances)), np.float32)
    scratch = allocate_texture_scratch()
    normals = Vectors(*(np.full(len(distances), part, np.float32) for part in normal))
    write_spotted(kind, (200.0, 180.0, 90.0), normals, view, ways, distances, scratch, Channels(*shown))
    return shown.T


SPOTTED = (Kind.WALL, Kind.TRUNK, Kind.CROWN, Kind.BUSH, Kind.ROCK, Kind.FURNITURE)
TOWARDS_EYE = (0.0, 0.0, -1.0)


@pytest.mark.parametrize("kind", SPOTTED)
def test_spots_change_how_bright_a_pixel_is_whatever_is_computed_with_it_but_not_its_colour(
    kind: Kind,
) -> None:
    assert has_spots(kind, TOWARDS_EYE)
    row = spotted(kind, TOWARDS_EYE, slice(0, CAMERA.width))
    for first, last in ((0, 1), (5, 8), (17, 50), (100, CAMERA.width)):
        assert (spotted(kind, TOWARDS_EYE, slice(first, last)) == row[first:last]).all()
    bright = row[:, 0] / 200.0
    assert bright.std() > 0.01
    assert abs(bright.mean() - 1.0) < 0.15
    assert row / bright[:, None] == pytest.approx(np.tile([200.0, 180.0, 90.0], (len(row), 1)), rel=1e-5)


def test_tiles_and_boards_are_drawn_one_by_one_but_flat_roofs_have_spots() -> None:
    assert has_spots(Kind.ROOF, (0.0, 1.0, 0.0))
    assert not has_spots(Kind.ROOF, (0.0, 0.8, 0.6))
    assert not has_spots(Kind.FLOOR, (0.0, 1.0, 0.0))


def test_the_sky_along_a_row_has_haze_clouds_and_the_sun_in_their_directions() -> None:
    to_sun = float(np.degrees(np.arctan2(SUN_DIRECTION[0], SUN_DIRECTION[2])))
    cameras = CAMERA._cameras([(0.0, 0.0, 0.0)], [to_sun], [-30.0], None)
    for row in range(0, CAMERA.height, 4):
        pixels, fog = row_of(cameras, row), np.empty(CAMERA.width, np.float32)
        write_sky(pixels.ways, clouds(), allocate_texture_scratch(), pixels.color, fog)
        ways, color = np.stack(pixels.ways, axis=-1), np.stack(pixels.color, axis=-1)
        aside = ways @ np.array(SUN_DIRECTION)
        assert (fog[ways[:, 1] < CLOUDS_FROM] == 1.0).all()  # nothing is before the haze there
        assert (fog[aside > DISC] == 0.0).all()
        assert color[aside > DISC] == pytest.approx(np.tile(SUN_COLOR, ((aside > DISC).sum(), 1)), abs=0.05)
        assert color[aside < GLOW] == pytest.approx(np.tile(CLOUD, ((aside < GLOW).sum(), 1)), abs=0.05)
        # The plane of the clouds, looked up at the nearest number of their map.
        scale = CLOUDS_WIDTH / (np.maximum(CLOUDS_FROM, ways[:, 1]) + FLATTENED)
        at = ((ways[:, [2, 0]] * scale[:, None] + CLOUDS_REACH) / CLOUDS_STEP).round().astype(int)
        near = clouds()[tuple(np.clip(at, 0, len(clouds()) - 1).T)]
        cover = near * np.clip((ways[:, 1] - CLOUDS_FROM) * INTO_CLOUDS, 0.0, 1.0)
        assert fog[aside < GLOW] == pytest.approx(1.0 - cover[aside < GLOW], abs=0.15)
