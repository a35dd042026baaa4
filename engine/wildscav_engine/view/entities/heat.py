"""The heat map of a replay: the density of supplies on the ground over time."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.view.entities.ground_overlay import GroundOverlay
from wildscav_engine.view.recording import colors
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import Boxes, History

LEVELS = ("few", "some", "many")  # entities below ``heat``, from the lowest density
SHARES = (0.12, 0.35, 0.65)  # of the greatest density in the match, from which on each level is shown
MIN_SPREAD, SPREAD_OF_MAP = 4.0, 1 / 30  # m, and share of the map's size: the width of the Gaussians
MAX_HEAT_MAPS = 16  # in one replay, which need not show every single pick-up


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
