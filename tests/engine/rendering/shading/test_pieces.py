"""A row of pixels is divided where another surface begins."""

from itertools import groupby

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from wildscav_engine.geometry.rays import NOTHING_HIT, TERRAIN_HIT
from wildscav_engine.rendering.hits import WATER_HIT
from wildscav_engine.rendering.shading.pieces import find_pieces

HITS = st.tuples(st.sampled_from([NOTHING_HIT, TERRAIN_HIT, WATER_HIT, 0, 7]), st.integers(0, 2))


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
