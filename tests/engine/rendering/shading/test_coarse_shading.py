"""Fast pictures shade a quarter of the pixels, and every pixel has a colour of the surface that it shows."""

from typing import Literal

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from tests.builders import box, flat_world, map_from

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.rendering.hits import Hits
from wildscav_engine.rendering.shading.coarse_shading import Chosen, choose_half, choose_unlike
from wildscav_engine.rendering.shading.pictures import find_pieces
from wildscav_engine.sensors import ColorCamera

Surface = tuple[int, int]  # solid and face
GROUND, SKY, WALL = (TERRAIN_HIT, 0), (NOTHING_HIT, 0), (7, 3)
ROWS = st.integers(1, 40).flatmap(
    lambda width: st.tuples(
        *[st.lists(st.sampled_from([GROUND, SKY, WALL, (7, 4)]), min_size=width, max_size=width)] * 2
    )
)


def line_of(surfaces: list[Surface]) -> Hits:
    solids, faces = np.array(surfaces, np.int32).T.copy()
    return Hits(np.arange(len(solids), dtype=np.float32), solids, faces)


def choose(surfaces: list[Surface], over: list[Surface] | None = None) -> tuple[list[int], Chosen, int]:
    """Return where the pieces of a row begin, and the chosen pixels with their number.

    The row is even, or the odd one below another.
    """
    line, width = line_of(surfaces), len(surfaces)
    pieces, cosines = np.empty(width + 1, np.int32), np.ones(width, np.float32)
    chosen = Chosen(*np.empty((4, width), np.int32), *np.empty((2, width), np.float32))
    if over is None:
        count = find_pieces(line.solid, line.face, pieces)
        many = choose_half(line, cosines, pieces, count, chosen)
    else:
        count, many = choose_unlike(line, line_of(over), cosines, pieces, chosen)
    return pieces[: count + 1].tolist(), chosen, many


def test_of_each_piece_every_second_pixel_is_shaded_and_the_next_one_gets_its_colour() -> None:
    pieces, chosen, many = choose([GROUND] * 5 + [WALL] * 2 + [SKY])
    assert pieces == [0, 3, 4, 5]
    assert many == 5
    assert chosen.column[:5].tolist() == [0, 2, 4, 5, 7]
    assert chosen.beside[:5].tolist() == [1, 3, 4, 6, 7]
    assert chosen.distance[:5].tolist() == [0.0, 2.0, 4.0, 5.0, 7.0]


def test_in_the_row_below_only_what_shows_something_else_is_shaded() -> None:
    pieces, chosen, many = choose(
        [GROUND, GROUND, WALL, WALL, WALL, SKY], [GROUND] * 2 + [SKY] * 2 + [WALL, SKY]
    )
    assert (pieces, many) == ([0, 1], 1)
    assert (chosen.column[0], chosen.beside[0], chosen.solid[0], chosen.face[0]) == (2, 3, *WALL)


@given(ROWS)
def test_every_pixel_has_a_colour_of_its_surface(rows: tuple[list[Surface], list[Surface]]) -> None:
    first, second = rows
    for row, (_, chosen, many) in ((first, choose(first)), (second, choose(second, first))):
        colored = dict(zip(chosen.beside[:many].tolist(), chosen.column[:many].tolist(), strict=True))
        colored |= {column: column for column in chosen.column[:many].tolist()}
        above = {column for column in range(len(row)) if row is second and second[column] == first[column]}
        assert set(colored) | above == set(range(len(row)))
        assert not set(colored) & above
        assert all(row[column] == row[source] for column, source in colored.items())


def picture(quality: Literal["full", "fast"], *, shadows: bool = True) -> NDArray[np.float64]:
    game_map = map_from(flat_world(80, [box((-4, -1, 6), (-1, 3, 7)), box((2, -1, 4), (3, 2, 5))]))
    camera = ColorCamera(width=96, height=54, quality=quality, shadows=shadows)
    return camera.render(game_map, [(0.0, 1.6, 0.0)], [0.0], [10.0])[0].astype(float)


def test_fast_pictures_show_the_same_shapes_and_shadows() -> None:
    full, fast = picture("full"), picture("fast")
    assert 0.0 < np.abs(full - fast).mean() < 5.0
    bright, simple = picture("full", shadows=False), picture("fast", shadows=False)
    shaded, coarse = (
        (np.abs(some - other).sum(axis=-1) > 30).sum() for some, other in ((full, bright), (fast, simple))
    )
    assert shaded > 40
    assert coarse == pytest.approx(shaded, rel=0.25)
