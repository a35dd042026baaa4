"""Hiding targets: upstairs, in other rooms and at dead ends, and measuring the ways to them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.random_numbers import Dice, Stream
from wildscav_engine.geometry.world import CELL
from wildscav_engine.maps.country.landforms import ward_of_points
from wildscav_engine.maps.country.plan import CountryPlan
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.houses import House
from wildscav_engine.maps.walk import NavGraph
from wildscav_engine.maps.walk.distances import LONGER, distances_to, nodes_of, sources_of

UPSTAIRS, INDOORS, DEAD_ENDS = 6, 4, 6  # targets of each kind, if the map has them
NEAREST = 1.0  # m, the least straight distance that detours are measured over


class Hidden(NamedTuple):
    """The places where the target of a match may be, and how long the ways to them are."""

    places: NDArray[np.float64]  # (T, 3) m
    # (T, S) how many times as long as the straight line the way from each of the map's starts is, at least
    detours: NDArray[np.float32]


def hide_targets(
    graph: NavGraph,
    plan: CountryPlan,
    terrain: Terrain,
    houses: Sequence[House],
    indoor: NDArray[np.float64],
    ground: NDArray[np.float64],
    seed: int,
) -> Hidden:
    """Choose the places where targets may be, and measure the ways to them.

    Args:
        indoor: (I, 3) m, its places in houses.
        ground: (S, 3) m, its places on open ground: the starts.
    """
    is_upstairs = np.zeros(len(indoor), np.bool_)
    x, _, z = indoor.T
    for house in houses:
        across, along = house.pose.inside(x, z)
        within = (np.abs(across) < house.size[0] / 2.0) & (np.abs(along) < house.size[1] / 2.0)
        is_upstairs |= within & (indoor[:, 1] > house.ground + house.storey_height / 2.0)
    columns = ((ground[:, 0] - terrain.corner[0]) / CELL + 0.5).astype(np.int64)
    rows = ((ground[:, 2] - terrain.corner[1]) / CELL + 0.5).astype(np.int64)
    is_dead_end = plan.wards.ways[ward_of_points(plan.wards, terrain)[rows, columns]] == 1
    dice = Dice(seed, Stream.HIDING)
    chosen = [
        _draw(dice, indoor[is_upstairs], UPSTAIRS),
        _draw(dice, indoor[~is_upstairs], INDOORS),
        _draw(dice, ground[is_dead_end], DEAD_ENDS),
    ]
    return measure(graph, np.concatenate(chosen), ground)


def _draw(dice: Dice, places: NDArray[np.float64], wanted: int) -> NDArray[np.float64]:
    """Return at most some of the places, drawn at random."""
    left = list(range(len(places)))
    chosen = [left.pop(dice.integer(0, len(left) - 1)) for _ in range(min(wanted, len(left)))]
    return places[chosen]


def measure(graph: NavGraph, targets: NDArray[np.float64], starts: NDArray[np.float64]) -> Hidden:
    """Measure the ways to targets (T, 3) m from starts (S, 3) m; all of them are nodes of the graph."""
    positions, sources = graph.positions(), sources_of(graph)
    from_nodes = nodes_of(graph, starts)
    detours = np.zeros((len(targets), len(starts)), np.float32)
    for row, node in enumerate(nodes_of(graph, targets).tolist()):
        way = distances_to(positions, sources.first, sources.node, node)[from_nodes] / LONGER
        east, north = starts[:, 0] - targets[row, 0], starts[:, 2] - targets[row, 2]
        detours[row] = way / np.maximum(NEAREST, np.sqrt(east * east + north * north))
    return Hidden(targets, detours)
