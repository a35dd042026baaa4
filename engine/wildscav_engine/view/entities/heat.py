"""The heat map of a replay: where on the ground supplies lie, and how many, as the match goes on."""

from collections.abc import Iterator

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from wildscav_engine.view.entities.draped import Net
from wildscav_engine.view.recording import colors
from wildscav_engine.view.recording.columns import Columns
from wildscav_engine.view.recording.history import Boxes, History

LEVELS = ("few", "some", "many")  # entities below ``heat``, each over the one before
SHARES = (0.12, 0.35, 0.65)  # of the most that ever lie around one place, from which a level is shown
NARROWEST, OF_MAP = 4.0, 1 / 30  # m and share of the map's size: how far supplies spread
MOST_MAPS = 16  # in one replay: it shows how a country is emptied, not every box


def static_heat(history: History) -> Iterator[tuple[str, rr.AsComponents]]:
    """Yield the colour of each level of a match that has supplies."""
    if not any(len(boxes.serial) for boxes in history.boxes):
        return
    for level, color in zip(LEVELS, colors.HEAT, strict=True):
        yield f"heat/{level}", rr.Mesh3D.from_fields(albedo_factor=color)


def moving_heat(history: History, net: Net) -> Iterator[Columns]:
    """Yield the triangles of each level, wherever the supplies have changed since the last map."""
    if not any(len(boxes.serial) for boxes in history.boxes):
        return
    shown = _chosen(history)
    rows = np.array([boxes.row for boxes in shown])
    densities = np.array([density(net, boxes) for boxes in shown])  # (M, N - 1, N - 1)
    for level, share in zip(LEVELS, SHARES, strict=True):
        hot = [net.where(each >= share * densities.max()) for each in densities]
        yield net.columns(f"heat/{level}")
        columns = rr.Mesh3D.columns(triangle_indices=np.concatenate(hot).reshape(-1, 3))
        yield Columns(f"heat/{level}", rows, columns.partition([len(each) for each in hot]))


def density(net: Net, boxes: Boxes) -> NDArray[np.float64]:
    """Return how many supplies lie around each cell of a net, (N - 1, N - 1): a sum of Gaussian bells."""
    spread = max(NARROWEST, OF_MAP * float(net.east[-1] - net.east[0]))
    bells = [
        np.exp(-0.5 * ((cells[:, None] - boxes.position[:, axis]) / spread) ** 2)
        for cells, axis in ((net.middle_north, 2), (net.middle_east, 0))
    ]
    return np.asarray((bells[0] * boxes.quantity) @ bells[1].T)


def _chosen(history: History) -> list[Boxes]:
    """Return the first set of boxes and the last one of each of so many parts of the match."""
    parts: dict[int, Boxes] = {-1: history.boxes[0]}
    for boxes in history.boxes[1:]:
        parts[boxes.row * (MOST_MAPS - 1) // len(history.frame)] = boxes
    return list(parts.values())
