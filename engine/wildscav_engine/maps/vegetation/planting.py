"""Planting a map with trees, bushes and rocks, never in water, houses, doorways or lanes."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.shapes import allocate_ring_stacks, solids_of
from wildscav_engine.geometry.world import Solid
from wildscav_engine.maps.ground.terrain import Terrain
from wildscav_engine.maps.settlements.footprints import Site, footprints_of, placed_footprints
from wildscav_engine.maps.settlements.sites import door_paths
from wildscav_engine.maps.vegetation.growing_ground import (
    BUSHES,
    ROCKS,
    TREES,
    Fields,
    GrowingGround,
    land_of,
    shores,
    slow_noise,
    steepness,
    wooded,
)
from wildscav_engine.maps.vegetation.scatter import allocate_spots, scatter
from wildscav_engine.maps.vegetation.species import PARTS, grow
from wildscav_engine.specs.map_spec import MapConfig

SHARES = {ROCKS: 0.003, TREES: 0.0075, BUSHES: 0.004}  # per m², with vegetation 1; large ones come first
KEYS = 2**24  # number of keys for the plants of each category
NO_LANES = np.zeros((0, 4))


def plant(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    sites: Sequence[Site],
    doorsteps: NDArray[np.float64],
    lanes: NDArray[np.float64] = NO_LANES,
    taken: NDArray[np.float64] | None = None,
) -> list[Solid]:
    """Return the solids of all trees, bushes and rocks.

    Args:
        terrain: With levelled ground.
        doorsteps: (D, 2) m, x and z in front of each outer doorway.
        lanes: (L, 4) m, see ``sites.Settlement``.
        taken: (F, 6) further footprints where nothing grows.

    Returns:
        One to three solids per tree, one per bush or rock.
    """
    land = _land(config, seed, terrain, sites, doorsteps, lanes, taken)
    area = float(config.size * config.size) * config.vegetation
    wanted = {category: int(share * area + 0.5) for category, share in SHARES.items()}
    spots = allocate_spots(config.size, sum(wanted.values()))
    half = config.size / 2.0
    everywhere = np.array([0.0, 0.0, 0.0, 1.0, half, half])
    found = 0
    for category, count in wanted.items():
        first = (category + 1) * KEYS
        found = scatter(np.uint64(seed), first, category, count, everywhere, land, spots, found)
    stacks = allocate_ring_stacks(PARTS * found)
    return solids_of(stacks, grow(spots.rows, found, stacks))


def _land(
    config: MapConfig,
    seed: int,
    terrain: Terrain,
    sites: Sequence[Site],
    doorsteps: NDArray[np.float64],
    lanes: NDArray[np.float64],
    taken: NDArray[np.float64] | None,
) -> GrowingGround:
    woods = wooded(seed, config.size, config.vegetation)
    shore, steep = shores(terrain, len(woods)), steepness(terrain, len(woods))
    trees = np.maximum(np.maximum(woods, 0.03), np.where(shore, 0.45, 0.0))
    edges = 4.0 * woods * (1.0 - woods)
    bushes = np.maximum(0.08 + 0.2 * woods + 0.7 * edges, np.where(shore, 0.3, 0.0))
    rocks = np.clip(0.05 + 0.08 * woods + 1.8 * np.maximum(0.0, steep - 0.2), 0.0, 1.0)
    paths = np.concatenate([lanes, door_paths(lanes, doorsteps)])
    fields = Fields(np.stack([trees, bushes, rocks]), conifers(config, seed, terrain), shore)
    placed = placed_footprints(config)
    if taken is not None:
        placed = np.concatenate([placed, taken])
    return land_of(terrain, footprints_of(sites), placed, doorsteps, paths, fields)


def conifers(config: MapConfig, seed: int, terrain: Terrain) -> NDArray[np.float64]:
    """Return (Q, Q) the chance that a tree is a conifer: higher in some woods and at greater heights."""
    noise = slow_noise(seed, config.size, 1)
    heights = terrain.heights[::2, ::2]
    lowest, highest = heights.min(), heights.max()
    high = np.zeros(noise.shape)
    rows, columns = min(len(noise), heights.shape[0]), min(len(noise), heights.shape[1])
    high[:rows, :columns] = (heights[:rows, :columns] - lowest) / max(1.0, highest - lowest)
    return np.clip(5.0 * (noise - 0.5) + 1.2 * (high - 0.4) + 0.4, 0.03, 0.97)
