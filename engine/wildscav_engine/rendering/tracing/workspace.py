"""Workspaces for tracing images, cached because allocating one takes longer than tracing a small image."""

import threading
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.array_tables import ArrayTable, reader
from wildscav_engine.rendering.tracing.front_to_back import Scratch, allocate_scratch
from wildscav_engine.rendering.tracing.hit_buffer import allocate_rays, allocate_strips
from wildscav_engine.rendering.tracing.packing import Packed

MAX_CACHED = 8  # workspaces per thread and scene
LARGEST_CACHED = 2**16  # rays of the largest image whose workspace is cached in its scene


class Size(NamedTuple):
    """The size of an image and of its moving solids, which a workspace depends on."""

    height: int  # pixels
    width: int  # pixels
    half_width: float  # see ``Cameras``
    most_faces: int = 0  # of any moving solid


class Workspace(NamedTuple):
    """The arrays for tracing images of one size in one scene."""

    numbers: NDArray[np.float64]  # the scene; see ``Packed``
    indices: NDArray[np.int64]
    float32s: NDArray[np.float32]
    kinds: NDArray[np.int8]
    rays: NDArray[np.float64]  # the image; see ``hit_buffer_in``
    met: NDArray[np.int32]
    strips: NDArray[np.float64]
    projection: NDArray[np.float32]  # from here to ``done``, see ``Scratch``
    boxes: NDArray[np.float32]
    outside: NDArray[np.float64]
    shown: NDArray[np.float32]
    queue: NDArray[np.int64]
    rings: NDArray[np.int64]
    cells: NDArray[np.int64]
    done: NDArray[np.int64]


class ImageArrays(NamedTuple):
    """The arrays of a workspace that hold an image while it is traced."""

    rays: NDArray[np.float64]
    met: NDArray[np.int32]
    strips: NDArray[np.float64]


def allocate_image(size: Size) -> ImageArrays:
    """Return the arrays for an image of a size."""
    return ImageArrays(
        allocate_rays(size.height, size.width, size.half_width),
        np.empty(size.height * size.width, np.int32),
        allocate_strips(size.height, size.width),
    )


class Scratches(threading.local):
    """The scratch buffers of each thread, for scenes up to the next powers of two of their sizes.

    Scenes of about the same size share them for the same reason as the arrays for images.
    """

    def __init__(self) -> None:
        self._cached: dict[tuple[int, ...], Scratch] = {}

    def of(self, *sizes: int) -> Scratch:
        """Return buffers for a scene of at least these sizes, see ``allocate_scratch``."""
        rounded = tuple(1 << size.bit_length() for size in sizes)
        if rounded not in self._cached:
            if len(self._cached) >= MAX_CACHED:
                self._cached.clear()
            self._cached[rounded] = allocate_scratch(*rounded)
        return self._cached[rounded]


scratches = Scratches()


def allocate_workspace(scene: Packed, size: Size, image: ImageArrays) -> Workspace:
    """Return a workspace for images of a size."""
    return Workspace(
        scene.numbers,
        scene.indices,
        scene.float32s,
        scene.kinds,
        image.rays,
        image.met,
        image.strips,
        *scratches.of(scene.blocks, scene.solids, max(scene.most_faces, size.most_faces)),
    )


NOWHERE = Packed(np.zeros(0), np.zeros(0, np.int64), np.zeros(0, np.float32), np.zeros(0, np.int8), 0, 0, 0)
POINT = Size(1, 1, 1.0)
read_workspace = reader(allocate_workspace(NOWHERE, POINT, allocate_image(POINT)))


class WorkspaceTable(ArrayTable):
    """A workspace and the table of its addresses."""

    def __init__(self, workspace: Workspace) -> None:
        """Store the addresses of the arrays."""
        super().__init__(workspace)
        self.tables = self.addresses[np.newaxis]  # (1, F, 6) in the form that kernels take for several images


class Images(threading.local):
    """The arrays for images of the latest sizes, separate for each thread.

    All scenes share them, so that they stay in the processor's cache when a thread traces one scene after
    another, as vector environments do.
    """

    def __init__(self) -> None:
        self._cached: dict[Size, ImageArrays] = {}

    def of(self, size: Size) -> ImageArrays:
        """Return the arrays for images of a size."""
        size = size._replace(most_faces=0)
        if size not in self._cached:
            if len(self._cached) >= MAX_CACHED:
                self._cached.clear()
            self._cached[size] = allocate_image(size)
        return self._cached[size]


images = Images()


class Workspaces(threading.local):
    """The cached workspaces of one scene, separate for each thread."""

    def __init__(self) -> None:
        self.cached: dict[Size, WorkspaceTable] = {}

    def __reduce__(self) -> tuple[type["Workspaces"], tuple[()]]:
        """Copies and pickles are empty."""
        return Workspaces, ()

    def of(self, scene: Packed, size: Size) -> WorkspaceTable:
        """Return the workspace for images of a size; ``scene`` is always the same one."""
        return self.cached.get(size) or self.make(scene, size)

    def make(self, scene: Packed, size: Size) -> WorkspaceTable:
        """Allocate a workspace that is not cached yet."""
        if size.height * size.width > LARGEST_CACHED:
            return latest_large.of(scene, size)
        workspace = WorkspaceTable(allocate_workspace(scene, size, images.of(size)))
        if len(self.cached) >= MAX_CACHED:
            self.cached.clear()
        self.cached[size] = workspace
        return workspace


class LatestLarge(threading.local):
    """The workspace of the latest large image of each thread, whichever scene it showed.

    Those that show one large image after another need no new one, and no more than one takes memory.
    """

    def __init__(self) -> None:
        self._size: Size | None = None
        self._workspace: WorkspaceTable | None = None

    def of(self, scene: Packed, size: Size) -> WorkspaceTable:
        """Return the workspace for images of a size in a scene."""
        workspace = self._workspace
        if workspace is None or self._size != size or workspace.arrays.numbers is not scene.numbers:
            self._workspace = None  # so that its memory is free before more is taken
            workspace = WorkspaceTable(allocate_workspace(scene, size, allocate_image(size)))
            self._size, self._workspace = size, workspace
        return workspace


latest_large = LatestLarge()
