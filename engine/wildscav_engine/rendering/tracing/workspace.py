"""Room to make images in, kept for the next ones: to make it takes longer than a small image."""

import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import ArrayTable, addresses_of, expect, reader
from wildscav_engine.rendering.tracing.canvas import allocate_rays, allocate_strips
from wildscav_engine.rendering.tracing.image import allocate_desk
from wildscav_engine.rendering.tracing.packing import Packed, pack_nothing

KEPT = 8  # rooms of a thread and a scene
MOST_KEPT = 2**16  # rays of an image whose room is kept


class Size(NamedTuple):
    """What room for an image depends on."""

    height: int  # pixels
    width: int  # pixels
    half_width: float  # see ``Cameras``
    most_faces: int = 0  # of one of the solids that move in it


class Room(NamedTuple):
    """Room for the images of one size, of one scene."""

    numbers: NDArray[np.float64]  # the scene; see ``Packed``
    indices: NDArray[np.int64]
    halves: NDArray[np.float32]
    rays: NDArray[np.float64]  # the image; see ``canvas_on``
    met: NDArray[np.int32]
    strips: NDArray[np.float64]
    sketch: NDArray[np.float32]  # from here on, see ``Desk``
    boxes: NDArray[np.float32]
    outside: NDArray[np.float64]
    shown: NDArray[np.float32]
    queue: NDArray[np.int64]
    rings: NDArray[np.int64]
    cells: NDArray[np.int64]
    done: NDArray[np.int64]
    moving_numbers: NDArray[np.float64]  # what moves; see ``Packed``
    moving_indices: NDArray[np.int64]
    viewers: NDArray[np.int32]  # (N,) see ``Cameras``; none where nothing moves


def allocate_room(scene: Packed, size: Size) -> Room:
    """Return room for images of a size in which nothing moves."""
    nothing = pack_nothing()
    return Room(
        scene.numbers,
        scene.indices,
        scene.halves,
        allocate_rays(size.height, size.width, size.half_width),
        np.empty(size.height * size.width, np.int32),
        allocate_strips(size.height, size.width),
        *allocate_desk(scene.blocks, scene.solids, max(scene.most_faces, size.most_faces)),
        nothing.numbers,
        nothing.indices,
        np.zeros(0, np.int32),
    )


class Moving(NamedTuple):
    """The last arrays of a room."""

    moving_numbers: NDArray[np.float64]
    moving_indices: NDArray[np.int64]
    viewers: NDArray[np.int32]


NOWHERE = Packed(np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.float32), 0, 0, 0)
read_room = reader(allocate_room(NOWHERE, Size(1, 1, 1.0)))
expect(Moving(np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.int32)))


class PlacedRoom(ArrayTable):
    """A room, and where it lies."""

    def __init__(self, room: Room) -> None:
        """Note where it lies."""
        super().__init__(room)
        self.tables = self.addresses[np.newaxis]  # (1, F, 6) as kernels take those of several images

    def with_moving(self, moving: Packed, viewers: NDArray[np.int32]) -> NDArray[np.int64]:
        """Return ``tables`` of the same room with what moves, and who looks; both are not kept alive."""
        tables = self.tables.copy()
        tables[0, -3:] = addresses_of(Moving(moving.numbers, moving.indices, viewers))
        return tables


class Rooms(threading.local):
    """The rooms of one scene, each thread's own."""

    def __init__(self) -> None:
        self.kept: dict[Size, PlacedRoom] = {}

    def __reduce__(self) -> tuple[type["Rooms"], tuple[()]]:
        """Copy and pickle as what is empty."""
        return Rooms, ()

    def of(self, scene: Packed, size: Size) -> PlacedRoom:
        """Return room for images of a size, of the scene, which is always the same."""
        return self.kept.get(size) or self.make(scene, size)

    def make(self, scene: Packed, size: Size) -> PlacedRoom:
        """Make room that is not kept yet."""
        room = PlacedRoom(allocate_room(scene, size))
        if size.height * size.width <= MOST_KEPT:
            if len(self.kept) >= KEPT:
                self.kept.clear()
            self.kept[size] = room
        return room
