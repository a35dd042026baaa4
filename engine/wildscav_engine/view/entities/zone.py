"""The safe zone of a replay: its edge, the red ground outside it, and its next circle."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.geometry.world import World
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view.entities.ground_overlay import GroundOverlay
from wildscav_engine.view.recording import colors, coordinates
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.ground import lay_on_ground
from wildscav_engine.view.recording.history import History, changes

CORNERS = 120  # of a ring
LIFT = 1.5  # m above the ground
ROW_INTERVAL = 5  # the rings move every half second
GROUND_CELLS = 64  # along each side of the overlay that is red outside the zone
MAX_GROUNDS = 24  # different shapes of the red ground in one replay


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
    lay_on_ground(world, LIFT, line)
    return line
