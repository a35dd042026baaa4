"""Colours of edges: no more of them than the busiest node has edges, and none twice at a node."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from wildscav_evaluator.tournaments.seating import colour_edges


@given(st.lists(st.tuples(st.integers(0, 8), st.integers(0, 8)), min_size=1, max_size=60))
def test_no_node_has_two_edges_of_a_colour(edges: list[tuple[int, int]]) -> None:
    left, right = np.array(edges, np.int64).T
    colours = int(max(np.bincount(left).max(), np.bincount(right).max()))

    found = colour_edges(left, right, colours)

    assert found.min() >= 0
    assert found.max() < colours
    for nodes in (left, right):
        assert len(set(zip(nodes.tolist(), found.tolist(), strict=True))) == len(edges)


@pytest.mark.parametrize("size", [1, 2, 7, 40])
def test_a_complete_graph_becomes_a_latin_square(size: int) -> None:
    left, right = np.divmod(np.arange(size * size), size)

    square = colour_edges(left, right, size).reshape(size, size)

    assert (np.sort(square, axis=0) == np.arange(size)[:, None]).all()
    assert (np.sort(square, axis=1) == np.arange(size)[None, :]).all()
