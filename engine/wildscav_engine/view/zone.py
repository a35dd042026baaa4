"""The safe zone of a replay: two rings over the ground, its edge and the circle that it draws in to."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.geometry.terrain import ground_at
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.view import colors, frame
from wildscav_engine.view.columns import Columns
from wildscav_engine.view.history import History, changes

CORNERS = 120  # of a ring
LIFT = 1.5  # m above the ground
EACH = 5  # rows: the rings move in half seconds


def static_zone(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield how the rings of a match that has a safe zone look."""
    if history.zone is not None:
        yield "zone/edge", rr.LineStrips3D.from_fields(radii=0.3, colors=[colors.ZONE])
        yield "zone/next", rr.LineStrips3D.from_fields(radii=0.15, colors=[colors.NEXT_ZONE])


def moving_zone(history: History, game_map: GameMap) -> Iterator[Columns]:
    """Yield where the rings are, wherever they move."""
    if history.zone is None:
        return
    for path, circles in (("zone/edge", history.zone[:, :3]), ("zone/next", history.zone[:, 3:])):
        rows = changes(circles)
        rows = rows[(rows % EACH == 0) | (rows == rows[-1])]
        rings = np.stack([ring(game_map.world, circle) for circle in circles[rows]])
        strips = rr.LineStrips3D.columns(strips=frame.points(rings))
        yield Columns(path, rows, strips)


def ring(world: World, circle: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (CORNERS + 1, 3) m a closed line along a circle (x, z, radius), as far as it is on the map.

    Beyond the edge of the map it runs along that edge.
    """
    angles = np.linspace(0.0, 2.0 * np.pi, CORNERS + 1)
    x, z, radius = circle
    line = np.empty((CORNERS + 1, 3))
    low, high = world.corner, -world.corner
    line[:, 0] = np.clip(x + radius * np.sin(angles), low[0], high[0])
    line[:, 2] = np.clip(z + radius * np.cos(angles), low[1], high[1])
    _lay_on_ground(world, line)
    return line


@kernel
def _lay_on_ground(world: World, line: NDArray[np.float64]) -> None:
    for corner in range(line.shape[0]):
        line[corner, 1] = ground_at(world, line[corner, 0], line[corner, 2]).height + LIFT
