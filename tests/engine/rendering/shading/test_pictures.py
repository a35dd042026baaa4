"""Pictures show sunlight and shadow, water, haze and dark corners, with the same bits everywhere."""

import os
import subprocess
import sys
from hashlib import blake2b
from itertools import groupby
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import box, flat_world, map_from
from tests.engine.rendering.views import View, directions

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.geometry.world import Kind, Solid, build_world
from wildscav_engine.maps import map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.rendering.hits import WATER_HIT
from wildscav_engine.rendering.palette import SUN
from wildscav_engine.rendering.shading.noise import PERIOD, endless_noise, grain, noise
from wildscav_engine.rendering.shading.pictures import find_pieces
from wildscav_engine.rendering.shading.pixel_rows import Vectors, cosines_of, view_of, write_directions
from wildscav_engine.rendering.shading.sky import DISC, HORIZON, SUN_DIRECTION, haze, levelness
from wildscav_engine.rendering.tracing.solids import gather_solids
from wildscav_engine.sensors import ColorCamera
from wildscav_engine.specs.map_spec import MapConfig, MapSpec

Place = tuple[float, float, float]

CONFIG = MapConfig(size=60, houses=2, water=0.1, vegetation=0.8)
ONE = ColorCamera(width=1, height=1, far=1000.0, field_of_view=1.0)
HITS = st.tuples(st.sampled_from([NOTHING_HIT, TERRAIN_HIT, WATER_HIT, 0, 7]), st.integers(0, 2))


def look(
    game_map: GameMap, eye: Place, yaw: float, pitch: float = 0.0, camera: ColorCamera = ONE
) -> NDArray[np.float64]:
    """Return the mean colour of one picture, (3,)."""
    return camera.render(game_map, [eye], [yaw], [pitch])[0].reshape(-1, 3).astype(float).mean(axis=0)


def with_solids(*solids: Solid, size: int = 80) -> GameMap:
    return map_from(flat_world(size, solids))


def lake() -> GameMap:
    """Return ground that sinks eastwards below water: 0.4 m per m, with water from x = 0 on."""
    heights = np.tile(-0.4 * (np.arange(41) * 2.0 - 40), (41, 1))
    spots = np.array([[-10.0, 4.0, 0.0]])
    return map_from(build_world((-40.0, -40.0), heights, np.full((40, 40), 0.0), [], spots))


def test_the_sunny_side_of_a_wall_is_brighter_than_the_other() -> None:
    wall = with_solids(box((-5, -1, -1), (5, 8, 1)))
    sunny, shady = (-1.0, 1.0) if SUN[2] < 0 else (1.0, -1.0)
    bright = look(wall, (0, 4, 10 * sunny), 0.0 if sunny < 0 else 180.0)
    dark = look(wall, (0, 4, 10 * shady), 0.0 if shady < 0 else 180.0)
    assert bright.sum() > 1.3 * dark.sum()


def test_a_wall_casts_its_shadow_away_from_the_sun_if_shadows_are_asked_for() -> None:
    wall = with_solids(box((-10, -1, -1), (10, 8, 1)))
    plain = ColorCamera(width=1, height=1, far=1000.0, field_of_view=1.0, shadows=False)
    behind = (0.0, 5.0, 3.0 if SUN[2] < 0 else -3.0)
    before = (0.0, 5.0, -behind[2])
    assert look(wall, behind, 0.0, 90.0).sum() < 0.8 * look(wall, behind, 0.0, 90.0, plain).sum()
    assert (look(wall, before, 0.0, 90.0) == look(wall, before, 0.0, 90.0, plain)).all()


def test_what_moves_casts_a_shadow_too() -> None:
    ground = with_solids()
    thing = gather_solids([box((-0.5, 2.0, -0.5), (0.5, 3.0, 0.5), Kind.AGENT)])
    # From its middle at 2.5 m the sun's ray comes down here.
    along = 2.5 / SUN_DIRECTION[1]
    eye = [-SUN_DIRECTION[0] * along, 1.5, -SUN_DIRECTION[2] * along]
    alone = ONE.render(ground, [eye], [0.0], [90.0])[0].astype(float).sum()
    shaded = ONE.render(ground, [eye], [0.0], [90.0], moving=thing)[0].astype(float).sum()
    assert shaded < 0.8 * alone
    aside = [eye[0] + 3.0, 1.5, eye[2]]
    assert (
        ONE.render(ground, [aside], [0.0], [90.0], moving=thing) == ONE.render(ground, [aside], [0.0], [90.0])
    ).all()


def test_water_is_bluer_than_the_shore_and_deep_water_than_shallow() -> None:
    def blue(x: float) -> float:
        color = look(lake(), (x, 6.0, 0.0), 0.0, 90.0)
        return float(color[2] / color.sum())

    shore, shallow, deep = blue(-1.0), blue(0.6), blue(12.0)
    assert shore < 0.33 < shallow < deep
    assert deep > 0.45


def test_an_eye_under_water_sees_no_farther_than_the_murk() -> None:
    far = ColorCamera(width=5, height=5, far=300.0)
    color = look(lake(), (15.0, -3.0, 0.0), 0.0, -10.0, far)
    assert color[2] > 1.2 * color[0]
    over = look(lake(), (15.0, 3.0, 0.0), 0.0, -10.0, far)
    assert over.sum() > 1.5 * color.sum()


def test_what_is_far_fades_to_the_colour_of_the_horizon() -> None:
    def wall(share: float) -> NDArray[np.float64]:
        """Return the picture of a wall straight ahead, at a share of the range."""
        camera = ColorCamera(width=1, height=1, far=36.0 / share, field_of_view=1.0)
        return look(with_solids(box((-40, -1, 16), (40, 30, 18))), (0, 1, -20), 0.0, 0.0, camera)

    away = [np.abs(wall(share) - HORIZON).sum() for share in (0.1, 0.5, 0.9, 0.9999)]
    assert away == sorted(away, reverse=True)
    assert away[0] > 100
    assert away[3] <= 3


def test_the_sky_is_bluest_above_and_the_sun_is_where_the_light_comes_from() -> None:
    def clear(up: float) -> list[float]:
        return [haze(channel, np.float32(up), levelness(np.float32(up))) for channel in range(3)]

    assert clear(0.0) == pytest.approx(HORIZON)
    assert clear(1.0)[0] < clear(0.6)[0] < HORIZON[0]
    yaw = float(np.degrees(np.arctan2(SUN_DIRECTION[0], SUN_DIRECTION[2])))
    pitch = -float(np.degrees(np.arcsin(SUN_DIRECTION[1])))
    narrow = 2 * float(np.degrees(np.arccos(DISC)))
    sun = look(with_solids(), (0, 2, 0), yaw, pitch)
    assert sun.min() > 215
    beside = look(with_solids(), (0, 2, 0), yaw + 180.0, pitch)
    assert sun[0] > beside[0] + 20
    assert 1.0 < narrow < 6.0


def test_rooms_are_darker_in_their_corners() -> None:
    room = with_solids(box((-5, -1, 4), (5, 6, 5)), box((4, -1, -5), (5, 6, 5)))
    camera = ColorCamera(width=64, height=36, field_of_view=60.0, shadows=False)
    picture = camera.render(room, [(0, 3, 0)], [45.0], [0.0])[0].astype(float).sum(axis=-1)
    assert picture[5:12, 31:33].mean() < 0.93 * picture[5:12, 10:14].mean()


def test_under_a_roof_light_comes_from_all_sides() -> None:
    roof = box((-6, 5, -6), (6, 6, 6), Kind.ROOF)
    camera = ColorCamera(width=1, height=1, shadows=False)
    table, under = box((-1, 2, -1), (1, 3, 1)), (0.0, 1.0, 0.0)
    outside = look(with_solids(table), under, 0.0, -90.0, camera)
    inside = look(with_solids(table, roof), under, 0.0, -90.0, camera)
    # It is the underside of the table that is seen, below the roof or below the sky.
    assert inside.sum() > 1.2 * outside.sum()


@pytest.mark.parametrize("kind", [kind for kind in Kind if Kind.WALL <= kind <= Kind.BUSH])
def test_every_kind_of_thing_is_told_from_the_sky(kind: Kind) -> None:
    thing = with_solids(box((-5, -1, 4), (5, 6, 5), kind))
    picture = ColorCamera(width=16, height=9).render(thing, [(0, 2, 0)], [0.0], [0.0])[0]
    assert np.abs(picture[4].astype(float).mean(axis=0) - HORIZON).sum() > 60


def test_the_ground_has_grain_near_and_none_where_a_pixel_is_larger_than_it() -> None:
    camera = ColorCamera(width=32, height=32, field_of_view=20.0)
    near = camera.render(with_solids(), [(0, 2, 0)], [0.0], [90.0])[0].astype(float)
    far = camera.render(with_solids(size=400), [(0, 250, 0)], [0.0], [90.0])[0].astype(float)
    step = [np.abs(np.diff(picture[..., 1], axis=1)).mean() for picture in (near, far)]
    assert step[0] > 1.0
    assert step[1] < step[0]


def world_with_everything() -> GameMap:
    """A map that another process need not compile the generator for: this one has put it into the cache."""
    return map_of(MapSpec(config=CONFIG, seed=3))


def views(count: int) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    game_map, dice = world_with_everything(), np.random.default_rng(4)
    places = np.concatenate([game_map.outdoor, game_map.indoor])
    eyes = places[dice.integers(0, len(places), count)] + [0.0, 1.5, 0.0]
    return eyes, dice.uniform(-180, 180, count), dice.uniform(-30, 30, count)


CAMERAS = ColorCamera(width=40, height=23), ColorCamera(width=40, height=23, quality="fast")


def digest() -> str:
    pictures = [camera.render(world_with_everything(), *views(8)).tobytes() for camera in CAMERAS]
    return blake2b(b"".join(pictures), digest_size=8).hexdigest()


@pytest.mark.slow  # all that takes pictures is compiled anew for it
def test_another_process_takes_the_same_pictures_on_a_generic_processor() -> None:
    here, folder = digest(), Path(__file__).parent
    paths = os.pathsep.join([str(folder), str(folder.parents[3])])
    done = subprocess.run(
        [sys.executable, "-c", f"import {Path(__file__).stem} as here; print(here.digest())"],
        env={**os.environ, "PYTHONPATH": paths, "NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip() == here


@pytest.mark.parametrize(("yaw", "pitch"), [(0.0, 0.0), (31.0, -12.0), (-140.0, 25.0), (90.0, 89.0)])
def test_the_rays_that_are_shaded_are_those_that_are_traced(yaw: float, pitch: float) -> None:
    camera = ColorCamera(width=9, height=5, field_of_view=90.0)
    cameras = camera._cameras([(0.0, 0.0, 0.0)], [yaw], [pitch], None)
    view = view_of(cameras, 0, 5, 9, 1)
    wanted = directions(View((0.0, 0.0, 0.0), yaw, pitch, (9, 5), 90.0)).reshape(5, 9, 3)
    for row in range(5):
        ways = Vectors(*np.empty((3, 9), np.float32))
        columns, cosines = np.arange(9, dtype=np.int32), cosines_of(cameras.half_width, 5, 9)[row]
        write_directions(view, row, columns, cosines, ways)
        assert np.stack(ways, axis=1) == pytest.approx(wanted[row], abs=1e-6)


def test_noise_is_even_smooth_and_unlike_at_neighbours() -> None:
    values = np.array([grain(x, y, z) for x in range(-10, 10) for y in range(-10, 10) for z in (0, 5, -9)])
    assert 0.0 <= values.min() < 0.01
    assert 0.99 < values.max() < 1.0
    assert abs(values.mean() - 0.5) < 0.03
    assert len(np.unique(values)) == len(values)
    for x in (-3.0, 0.0, 7.0):
        assert endless_noise(x, 2.0) == grain(int(x), 2, 0)
        assert noise(x - 1e-9, 2.5) == pytest.approx(noise(x + 1e-9, 2.5), abs=1e-6)


@pytest.mark.parametrize(("x", "z"), [(0.0, 0.0), (3.0, 127.0), (5.25, 9.75), (127.5, 126.9)])
def test_quick_noise_is_that_of_a_square_repeated_without_end(x: float, z: float) -> None:
    if max(x, z) < PERIOD - 1:  # beyond, it returns to the first row and column
        assert noise(x, z) == pytest.approx(endless_noise(x, z), abs=1 / 255)
    for east, north in ((PERIOD, 0), (-PERIOD, 3 * PERIOD)):
        assert noise(x + east, z + north) == pytest.approx(noise(x, z), abs=1e-6)


def pieces_of(hits: list[tuple[int, int]]) -> list[int]:
    """Return where the pieces of a row begin, and where the last ends."""
    solids, faces = np.array(hits, np.int32).T.copy()
    pieces = np.empty(len(hits) + 1, np.int32)
    return pieces[: find_pieces(solids, faces, pieces) + 1].tolist()


@given(st.lists(HITS, min_size=1, max_size=60))
def test_a_piece_shows_one_face_of_a_solid_or_ground_of_any_triangle(hits: list[tuple[int, int]]) -> None:
    shown = [(solid, 0 if solid == TERRAIN_HIT else face) for solid, face in hits]
    lengths = [len(list(group)) for _, group in groupby(shown)]
    assert pieces_of(hits) == [0, *np.cumsum(lengths).tolist()]
