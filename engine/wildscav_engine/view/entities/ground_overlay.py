"""What lies on the ground in a replay: the heat map of supplies, and the safe zone with its next circle.

Both colour parts of a triangle mesh just above the ground: the heat map where supplies are dense, the zone
all that is outside it.
"""

from collections.abc import Iterator
from functools import cached_property

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.geometry.terrain import spread
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view.recording import colors, coordinates
from wildscav_engine.view.recording.camera_poses import lay_on_ground
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import Boxes, History, changes

MAX_CELLS = 80  # along each side; on larger maps, the overlay is coarser than the ground
LIFT = 0.3  # m above the ground or the water
LEVELS = ("few", "some", "many")  # entities below ``heat``, from the lowest density
SHARES = (0.12, 0.35, 0.65)  # of the greatest density in the match, from which on each level is shown
MIN_SPREAD, SPREAD_OF_MAP = 4.0, 1 / 30  # m, and share of the map's size: the width of the Gaussians
MAX_HEAT_MAPS = 16  # in one replay, which need not show every single pick-up
CORNERS = 120  # of a ring
ZONE_LIFT = 1.5  # m above the ground
ROW_INTERVAL = 5  # the rings move every half second
GROUND_CELLS = 64  # along each side of the overlay that is red outside the zone
MAX_GROUNDS = 24  # different shapes of the red ground in one replay


class GroundOverlay:
    """The overlay of one map: N × N vertices, numbered row by row northwards."""

    def __init__(self, world: World, max_cells: int = MAX_CELLS) -> None:
        """Create the overlay of a world, with at most ``max_cells`` cells along each side."""
        across = len(world.heights) - 1
        cells = min(across, max_cells)
        every = np.round(np.linspace(0, across, cells + 1)).astype(np.int64)
        reach = -(-across // cells) - 1  # vertices of the ground between two of the overlay
        # It must lie above them, too.
        height = spread(_surface(world), reach)[np.ix_(every, every)] + LIFT
        self.east = world.corner[0] + CELL * every  # (N,) m
        self.north = world.corner[1] + CELL * every  # (N,) m
        x, z = np.meshgrid(self.east, self.north)
        self.center_east = (self.east[1:] + self.east[:-1]) / 2  # (N - 1,) m, centers of the cells
        self.center_north = (self.north[1:] + self.north[:-1]) / 2
        self.points = np.stack([x, height, z], axis=-1)  # (N, N, 3) m, in the game's coordinates

    @cached_property
    def vertices(self) -> NDArray[np.float32]:
        """The vertices in Rerun's coordinates, (N * N, 3)."""
        return coordinates.points(self.points.reshape(-1, 3))

    @cached_property
    def triangles(self) -> NDArray[np.int32]:
        """All triangles, (2 * (N - 1)², 3), in Rerun's coordinates; the two of a cell are consecutive."""
        count = len(self.east)
        south_west = (count * np.arange(count - 1)[:, None] + np.arange(count - 1)).ravel()
        south_east, north_west, north_east = south_west + 1, south_west + count, south_west + count + 1
        halves = [[south_west, south_east, north_east], [south_west, north_east, north_west]]
        return np.ascontiguousarray(np.array(halves, np.int32).transpose(2, 0, 1).reshape(-1, 3))

    def columns(self, path: str) -> Columns:
        """Return the vertices, from the first row on, for an entity whose triangles change over time.

        They are not static, because the viewer would draw static vertices as triangles where it has none.
        """
        points = rr.Mesh3D.columns(vertex_positions=self.vertices)
        return Columns(path, np.zeros(1, np.int64), points.partition([len(self.vertices)]))

    def triangles_of(self, chosen: NDArray[np.bool_]) -> NDArray[np.int32]:
        """Return (M, 3) the triangles of the chosen cells, of (N - 1, N - 1); without any, one without area.

        The viewer would draw a mesh without triangles as if every three vertices were one.
        """
        if not chosen.any():
            return np.zeros((1, 3), np.int32)
        return np.asarray(self.triangles.reshape(-1, 2, 3)[chosen.ravel()].reshape(-1, 3))


def _surface(world: World) -> NDArray[np.float64]:
    """Return the height of the ground or the water at every vertex of the ground."""
    rows, columns = world.heights.shape
    surface = world.heights.copy()
    for north, east in ((0, 0), (0, 1), (1, 0), (1, 1)):
        part = surface[north : rows - 1 + north, east : columns - 1 + east]
        np.maximum(part, world.water, out=part)
    return surface


def static_heat(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the colour of each level, if the match has supplies."""
    if not any(len(boxes.serial) for boxes in history.boxes):
        return
    for level, color in zip(LEVELS, colors.HEAT, strict=True):
        yield f"heat/{level}", rr.Mesh3D.from_fields(albedo_factor=color)


def moving_heat(history: History, overlay: GroundOverlay) -> Iterator[Columns]:
    """Yield the triangles of each level whenever the supplies have changed since the last heat map."""
    if not any(len(boxes.serial) for boxes in history.boxes):
        return
    shown = _chosen(history)
    rows = np.array([boxes.row for boxes in shown])
    densities = np.array([density(overlay, boxes) for boxes in shown])  # (M, N - 1, N - 1)
    for level, share in zip(LEVELS, SHARES, strict=True):
        hot = [overlay.triangles_of(each >= share * densities.max()) for each in densities]
        yield overlay.columns(f"heat/{level}")
        columns = rr.Mesh3D.columns(triangle_indices=np.concatenate(hot).reshape(-1, 3))
        yield Columns(f"heat/{level}", rows, columns.partition([len(each) for each in hot]))


def density(overlay: GroundOverlay, boxes: Boxes) -> NDArray[np.float64]:
    """Return the density of supplies in each cell of the overlay, (N - 1, N - 1): a sum of Gaussians."""
    spread = max(MIN_SPREAD, SPREAD_OF_MAP * float(overlay.east[-1] - overlay.east[0]))
    gaussians = [
        np.exp(-0.5 * ((cells[:, None] - boxes.position[:, axis]) / spread) ** 2)
        for cells, axis in ((overlay.center_north, 2), (overlay.center_east, 0))
    ]
    return np.asarray((gaussians[0] * boxes.quantity) @ gaussians[1].T)


def _chosen(history: History) -> list[Boxes]:
    """Return the first set of boxes, and the last one in each of ``MAX_HEAT_MAPS - 1`` parts of the match."""
    parts: dict[int, Boxes] = {-1: history.boxes[0]}
    for boxes in history.boxes[1:]:
        parts[boxes.row * (MAX_HEAT_MAPS - 1) // len(history.frame)] = boxes
    return list(parts.values())


def static_zone(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the static components of the zone, if the match has one."""
    if history.zone is None:
        return
    # In pixels: a line that is thick enough for the overview in metres would look like a wall from nearby.
    yield "zone/edge", rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.5), colors=[colors.ZONE])
    yield "zone/next", rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1), colors=[colors.NEXT_ZONE])
    yield "zone/outside", rr.Mesh3D.from_fields(albedo_factor=colors.OUTSIDE)


def moving_zone(history: History, game_map: GameMap) -> Iterator[Columns]:
    """Yield the position of the zone whenever it moves."""
    if history.zone is None:
        return
    world = game_map.world
    for path, circles in (("zone/edge", history.zone[:, :3]), ("zone/next", history.zone[:, 3:])):
        rows = _moved(circles)
        rings = np.stack([ring(world, circle) for circle in circles[rows]])
        yield Columns(path, rows, rr.LineStrips3D.columns(strips=coordinates.points(rings)))
    rows = _moved(history.zone[:, :3])
    overlay = GroundOverlay(world, GROUND_CELLS)
    yield overlay.columns("zone/outside")
    yield _outside(overlay, history.zone, rows)


def _moved(circles: NDArray[np.float64]) -> NDArray[np.int64]:
    """Return the rows in which (T + 1, 3) circles change, at most every ``ROW_INTERVAL`` rows."""
    rows = changes(circles)
    return np.asarray(rows[(rows % ROW_INTERVAL == 0) | (rows == rows[-1])])


def _outside(overlay: GroundOverlay, zone: NDArray[np.float64], rows: NDArray[np.int64]) -> Columns:
    """Return the ground outside the zone, in a few of the rows in which the zone moves."""
    some = rows[np.unique(np.linspace(0, len(rows) - 1, min(len(rows), MAX_GROUNDS)).round().astype(int))]
    east, north = overlay.center_east, overlay.center_north[:, None]
    grounds = [
        overlay.triangles_of((east - x) ** 2 + (north - z) ** 2 > radius * radius)
        for x, z, radius in zone[some, :3]
    ]
    columns = rr.Mesh3D.columns(triangle_indices=np.concatenate(grounds))
    return Columns("zone/outside", some, columns.partition([len(ground) for ground in grounds]))


def ring(world: World, circle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (CORNERS + 1, 3) m a closed line along a circle (x, z, radius), clipped to the map.

    Outside the map, the line runs along the edge of the map.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, CORNERS + 1)
    x, z, radius = circle
    line = np.empty((CORNERS + 1, 3))
    low, high = world.corner, -world.corner
    line[:, 0] = np.clip(x + radius * np.sin(angles), low[0], high[0])
    line[:, 2] = np.clip(z + radius * np.cos(angles), low[1], high[1])
    lay_on_ground(world, ZONE_LIFT, line)
    return line
