"""Pictures of maps: what is visible from above, and that it is at the right place."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image
from tests.builders import box, flat_world, map_from

from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.geometry.world import Kind, World
from wildscav_engine.maps import GameMap, House, MapError, generate_map
from wildscav_engine.maps.picture import draw_map
from wildscav_engine.maps.picture.draw import INDOOR_DOT
from wildscav_engine.maps.picture.paint import STOREYS, contour_interval, raster
from wildscav_engine.maps.picture.sheet import lay_out, round_length
from wildscav_engine.maps.picture.top_view import (
    TopView,
    Window,
    allocate_top_view,
    cast_top_view,
    cuts_at,
    smooth_ground,
)
from wildscav_engine.specs.map_spec import MapConfig

SIZE = 40  # m, of the worlds made by hand
WHOLE = Window(-SIZE / 2, SIZE / 2, 0.5, 2 * SIZE, 2 * SIZE)
WIDTH = 500  # pixels of a sheet that shows dots apart from each other
HOUSE = House(center=(0.0, 0.0), size=(10.0, 10.0), yaw=0.0, ground=0.0, storeys=2, storey_height=3.0)


def house_map(house: House = HOUSE) -> GameMap:
    """Return a map with a doorless house: two floors, a roof, walls of 0.5 m, and a table upstairs."""
    solids = [box((-5, level, -5), (5, level + 0.1, 5), Kind.FLOOR) for level in (0, 3)]
    solids += [box((-5, 6, -5), (5, 6.2, 5), Kind.ROOF), box((-1, 3.1, -1), (1, 3.9, 1), Kind.FURNITURE)]
    for low, high in (((-5, -5), (5, -4.5)), ((-5, 4.5), (5, 5)), ((-5, -5), (-4.5, 5)), ((4.5, -5), (5, 5))):
        solids.append(box((low[0], 0, low[1]), (high[0], 6, high[1])))
    plain = map_from(flat_world(SIZE, solids), indoor=[(2, 0.1, 2), (-2, 3.1, -2)])
    houses = np.zeros(len(solids), np.int16)
    return GameMap(plain.spec, plain.world, (house,), plain.indoor, plain.outdoor, houses)


def survey(world: World, window: Window = WHOLE, cuts: NDArray[np.float64] | None = None) -> TopView:
    seen = allocate_top_view(window.rows, window.columns)
    cast_top_view(world, world.water, 50.0, np.zeros((0, 9)) if cuts is None else cuts, window, seen)
    return seen


def at(x: float, z: float) -> tuple[int, int]:
    """Return the sample of the whole window nearest to a place."""
    return int((SIZE / 2 - z) / 0.5), int((x + SIZE / 2) / 0.5)


def test_north_is_up_and_east_is_right() -> None:
    seen = survey(flat_world(SIZE, [box((5, 0, 10), (9, 3, 12), Kind.ROCK)]))
    rows, columns = np.nonzero(seen.kind == Kind.ROCK)
    assert (rows.min(), columns.min()) == at(5.1, 11.9)
    assert (rows.max(), columns.max()) == at(8.9, 10.1)
    assert seen.height[at(7, 11)] == pytest.approx(3.0)


def test_shadows_fall_away_from_the_upper_left() -> None:
    seen = survey(flat_world(SIZE, [box((-1, 0, -1), (1, 4, 1))]))
    assert not seen.sunny[at(2, -2)]
    for place in ((-2, 2), (2, 2), (-2, -2), (0, 0), (15, -15)):
        assert seen.sunny[at(*place)], place


def test_only_a_cut_opens_a_house() -> None:
    game_map = house_map()
    assert (survey(game_map.world).kind[at(0, 0)], cuts_at(game_map, None).shape) == (Kind.ROOF, (0, 9))
    for storey, middle, height in ((1, Kind.FLOOR, 0.1), (2, Kind.FURNITURE, 3.9)):
        seen = survey(game_map.world, cuts=cuts_at(game_map, storey))
        assert (seen.kind[at(0, 0)], seen.height[at(0, 0)]) == (middle, pytest.approx(height))
        assert (seen.kind[at(4.7, 0)], seen.cut[at(4.7, 0)]) == (Kind.WALL, True)
        assert not seen.cut[at(0, 0)]
        assert seen.kind[at(5.5, 0)] == Kind.TERRAIN
        assert seen.sunny[at(3, 0)]  # under a roof that is removed


def test_a_cut_follows_the_wings_of_a_turned_house() -> None:
    wings = (Rectangle(-5.0, -5.0, 5.0, 0.0), Rectangle(-5.0, 0.0, 0.0, 5.0))
    game_map = house_map(House((0.0, 0.0), (10.0, 10.0), 90.0, 0.0, 2, 3.0, wings=wings))
    seen = survey(game_map.world, cuts=cuts_at(game_map, 1))
    # After a rotation by 90°, the front faces east and the right side south.
    assert seen.kind[at(3, -3)] == Kind.ROOF
    for place in ((-3, 3), (-3, -3), (3, 3)):
        assert seen.kind[at(*place)] == Kind.FLOOR, place


def test_the_smooth_ground_goes_through_the_corners_and_keeps_a_plane() -> None:
    heights = np.random.default_rng(1).uniform(0, 3, (SIZE // 2 + 1, SIZE // 2 + 1))
    world = flat_world(SIZE)._replace(heights=heights)
    for row, column in ((0, 0), (3, 7), (20, 20)):
        height, _, _ = smooth_ground(world, -20.0 + 2 * column, -20.0 + 2 * row)
        assert height == pytest.approx(heights[row, column])
    height, slope_x, slope_z = smooth_ground(flat_world(SIZE, slope=0.5), 3.3, -7.1)
    assert (height, slope_x, slope_z) == pytest.approx((1.65, 0.5, 0.0))


def test_water_is_blue_and_what_lies_beyond_the_map_is_paper() -> None:
    pixels = raster(map_from(flat_world(SIZE, slope=0.2, water=0.0)), Window(-25, 15, 0.5, 60, 100), None)
    red, _, blue = pixels[30, 20].tolist()  # at x = -15, 3 m deep
    assert blue > red + 40
    red, _, blue = pixels[30, 80].tolist()  # at x = 15, dry
    assert blue < red
    assert pixels[30, 2].tolist() == pixels[30, 97].tolist() == [250, 248, 243]


@pytest.mark.parametrize("storeys", [1, 2, 3, 4])
def test_flat_roofs_have_the_colour_of_their_storeys(storeys: int) -> None:
    house = House(HOUSE.center, HOUSE.size, 0.0, 0.0, storeys, 3.0)
    pixels = raster(house_map(house), WHOLE, None)
    assert np.abs(pixels[at(0, 0)] - STOREYS[storeys - 1]).max() < 6


def test_a_picture_is_as_wide_as_asked_and_the_same_each_time() -> None:
    game_map = generate_map(MapConfig(size=60, houses=2), 3)
    picture = draw_map(game_map, width=310)
    assert (picture.width, picture.mode) == (310, "RGB")
    assert picture.tobytes() == draw_map(game_map, width=310).tobytes()


def test_a_part_of_a_map_is_drawn_larger() -> None:
    game_map = house_map()
    layout = lay_out(300, 1.0)
    for span, share in ((40.0, 1 / 16), (20.0, 1 / 4)):
        pixels = np.asarray(draw_map(game_map, width=300, center=(0, 0), span=span)).astype(int)
        roof = np.abs(pixels - STOREYS[1].astype(int)).max(axis=2) < 8
        assert roof.sum() == pytest.approx(share * layout.columns * layout.rows, rel=0.1)


@pytest.mark.parametrize(("storey", "shown"), [(None, [(2, 2), (-2, -2)]), (1, [(2, 2)]), (2, [(-2, -2)])])
def test_locations_are_dots_where_they_are(storey: int | None, shown: list[tuple[float, float]]) -> None:
    picture = draw_map(house_map(), width=WIDTH, locations=True, storey=storey)
    layout = lay_out(WIDTH, 1.0)
    pixels = np.asarray(picture)[layout.top :, layout.left :][: layout.rows, : layout.columns]
    marked = (np.abs(pixels.astype(int) - INDOOR_DOT).max(axis=2) < 3).astype(np.uint8)
    for x, z in ((2, 2), (-2, -2)):
        row, column = ((SIZE / 2 - z) / SIZE * layout.rows, (x + SIZE / 2) / SIZE * layout.columns)
        dot = marked[int(row) - 1 : int(row) + 2, int(column) - 1 : int(column) + 2]
        assert bool(dot.all()) == ((x, z) in shown)
    assert marked.sum() < 60 * len(shown)


@pytest.mark.parametrize(("storey", "shown"), [(None, True), (1, False), (2, False)])
def test_locations_on_a_roof_go_with_the_roof(storey: int | None, shown: bool) -> None:
    game_map = replace(house_map(), outdoor=np.array([(0.0, 6.2, 0.0), (12.0, 0.0, 12.0)]))
    without = replace(game_map, outdoor=game_map.outdoor[1:])
    pictures = [draw_map(each, width=300, locations=True, storey=storey) for each in (game_map, without)]
    assert (pictures[0].tobytes() != pictures[1].tobytes()) == shown


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"storey": 3}, "storey is 3, must be 1 to 2"),
        ({"storey": 0}, "storey is 0, must be 1 to 2"),
        ({"width": 10}, "width is 10, must be 300 to 8000 pixels"),
        ({"span": 0.5}, "span is 0.5, must be 5 to 80 m"),
    ],
)
def test_what_cannot_be_drawn_names_its_range(arguments: dict[str, int], message: str) -> None:
    with pytest.raises(MapError, match=message):
        draw_map(house_map(), **arguments)  # type: ignore[arg-type]


def test_a_map_without_houses_has_no_storeys() -> None:
    with pytest.raises(MapError, match="no houses"):
        draw_map(map_from(flat_world()), storey=1)
    assert isinstance(draw_map(map_from(flat_world()), width=300), Image.Image)


def test_lengths_are_round_and_contours_suit_the_relief() -> None:
    lengths = {100: 100, 99: 50, 4.9: 2, 1: 1, 0.7: 0.5, 0.3: 0.2, 1999: 1000}
    assert {longest: round_length(longest) for longest in lengths} == pytest.approx(lengths)
    intervals = {0: 0.5, 12.6: 1, 45: 2, 60: 5, 200: 10, 900: 20}
    assert {relief: contour_interval(relief) for relief in intervals} == intervals


def test_pillow_is_imported_only_to_draw() -> None:
    code = "import sys, wildscav_engine.maps.picture, wildscav_engine.maps.export.files; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"PIL", "trimesh"} & set(done.stdout.split())
