"""Swept collision: where a body that moves first touches something.

The body is an upright cylinder. Sweeping it against a convex solid equals sweeping a point (the middle of its
soles) against the solid with its faces pushed out by the body. Paths are clipped exactly, never sampled, so
no speed is too great. At sharp edges the pushed-out faces meet beyond the true outline; the pushed-out
bounding box of the solid limits this.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS

SKIN = 1e-3  # m, kept between a body and what it touches
NEAR_HEIGHT = 2.0 * BODY_HEIGHT  # m; in one frame a body cannot touch another that is farther above or below


class Contact(NamedTuple):
    """How far a body can move before something stops it."""

    fraction: float  # of the displacement that is free, 0–1
    n_x: float  # unit normal of the surface that stops it; zero if none does
    n_y: float
    n_z: float


FREE = Contact(1.0, 0.0, 0.0, 0.0)


class Cut(NamedTuple):
    """The part of a displacement (as fractions) that lies inside all faces tested so far."""

    enter: float
    leave: float
    n_x: float
    n_y: float
    n_z: float
    outside: bool  # whether the start is outside
    missed: bool  # whether the displacement never comes inside


class Box(NamedTuple):
    """An upright box, in m."""

    west: float
    bottom: float
    south: float
    east: float
    top: float
    north: float


@kernel
def box_of_sweep(x: float, y: float, z: float, dx: float, dy: float, dz: float) -> Box:
    """Return a box that safely contains the volume a body sweeps; see ``sweep_world`` for the arguments."""
    reach = BODY_RADIUS + 2.0 * SKIN
    return Box(
        min(x, x + dx) - reach,
        min(y, y + dy) - 2.0 * SKIN,
        min(z, z + dz) - reach,
        max(x, x + dx) + reach,
        max(y, y + dy) + BODY_HEIGHT + 2.0 * SKIN,
        max(z, z + dz) + reach,
    )


@kernel
def is_apart(world: World, solid: int, box: Box) -> bool:
    """Return whether a solid's bounding box is apart from a box: a cheap test that rejects most solids."""
    return bool(
        world.solid_high[solid, 1] < box.bottom
        or world.solid_low[solid, 1] > box.top
        or world.solid_low[solid, 0] > box.east
        or world.solid_high[solid, 0] < box.west
        or world.solid_low[solid, 2] > box.north
        or world.solid_high[solid, 2] < box.south
    )


@kernel
def _cut_by_face(cut: Cut, n_x: float, n_y: float, n_z: float, start: float, end: float) -> Cut:
    """Clip a displacement by one face, given the distances of its start and end from the face's plane."""
    if start > 0.0 and (end >= SKIN or end >= start):
        return Cut(cut.enter, cut.leave, cut.n_x, cut.n_y, cut.n_z, True, True)
    outside = cut.outside or start > 0.0
    if start <= 0.0 and end <= 0.0:
        return Cut(cut.enter, cut.leave, cut.n_x, cut.n_y, cut.n_z, outside, False)
    if start > end:
        enter = max(0.0, (start - SKIN) / (start - end))
        if enter > cut.enter:
            return Cut(enter, cut.leave, n_x, n_y, n_z, outside, False)
        return Cut(cut.enter, cut.leave, cut.n_x, cut.n_y, cut.n_z, outside, False)
    leave = min(cut.leave, start / (start - end))
    return Cut(cut.enter, leave, cut.n_x, cut.n_y, cut.n_z, outside, False)


@inlined_kernel
def sweep_solid(
    world: World, solid: int, x: float, y: float, z: float, dx: float, dy: float, dz: float
) -> Contact:
    """Return how far a body can move before it touches one solid. A solid does not stop a body inside it."""
    low, high = world.solid_low[solid], world.solid_high[solid]
    cut = Cut(-1.0, 1.0, 0.0, 0.0, 0.0, False, False)
    # The bounding box comes first: beyond it, the pushed-out faces do not belong to the solid.
    over = y - high[1]
    cut = _cut_by_face(cut, 0.0, 1.0, 0.0, over, over + dy)
    if cut.missed:
        return FREE
    under = low[1] - BODY_HEIGHT - y
    cut = _cut_by_face(cut, 0.0, -1.0, 0.0, under, under - dy)
    if cut.missed:
        return FREE
    east = x - high[0] - BODY_RADIUS
    cut = _cut_by_face(cut, 1.0, 0.0, 0.0, east, east + dx)
    if cut.missed:
        return FREE
    west = low[0] - BODY_RADIUS - x
    cut = _cut_by_face(cut, -1.0, 0.0, 0.0, west, west - dx)
    if cut.missed:
        return FREE
    north = z - high[2] - BODY_RADIUS
    cut = _cut_by_face(cut, 0.0, 0.0, 1.0, north, north + dz)
    if cut.missed:
        return FREE
    south = low[2] - BODY_RADIUS - z
    cut = _cut_by_face(cut, 0.0, 0.0, -1.0, south, south - dz)
    if cut.missed:
        return FREE
    for face in range(world.solid_start[solid], world.solid_start[solid + 1]):
        n_x, n_y, n_z = world.faces[face, 0], world.faces[face, 1], world.faces[face, 2]
        start = n_x * x + n_y * y + n_z * z - world.faces[face, 3] - world.face_reach[face]
        cut = _cut_by_face(cut, n_x, n_y, n_z, start, start + n_x * dx + n_y * dy + n_z * dz)
        if cut.missed:
            return FREE
    if not cut.outside or cut.enter < 0.0 or cut.enter > cut.leave:
        return FREE
    return Contact(cut.enter, cut.n_x, cut.n_y, cut.n_z)


@kernel
def sweep_world(world: World, x: float, y: float, z: float, dx: float, dy: float, dz: float) -> Contact:
    """Return how far a body can move before it touches a solid. The caller handles the terrain.

    Args:
        x: m, the middle of the soles; so y and z.
        dx: m, the displacement; so dy and dz.
    """
    rows, columns = world.water.shape
    first = FREE
    reach = BODY_RADIUS + SKIN
    west = cell_of(world.corner[0], min(x, x + dx) - reach, columns)
    east = cell_of(world.corner[0], max(x, x + dx) + reach, columns)
    south = cell_of(world.corner[1], min(z, z + dz) - reach, rows)
    north = cell_of(world.corner[1], max(z, z + dz) + reach, rows)
    lowest = min(y, y + dy)
    swept = box_of_sweep(x, y, z, dx, dy, dz)
    for row in range(south, north + 1):
        for column in range(west, east + 1):
            if world.cell_top[row, column] + SKIN < lowest:
                continue
            cell = row * columns + column
            for item in range(world.cell_start[cell], world.cell_start[cell + 1]):
                solid = world.cell_solids[item]
                if world.solid_low[solid, 1] > swept.top:
                    break  # all solids after it begin higher still
                if is_apart(world, solid, swept):
                    continue
                contact = sweep_solid(world, solid, x, y, z, dx, dy, dz)
                if contact.fraction < first.fraction:
                    first = contact
    return first


@kernel
def sweep_bodies(
    bodies: NDArray[np.float64],
    others: NDArray[np.int32],
    mover: int,
    x: float,
    y: float,
    z: float,
    dx: float,
    dy: float,
    dz: float,
) -> Contact:
    """Return how far a body can move before it touches another body.

    Args:
        bodies: (A, 3) m, the soles of all bodies.
        others: (N,) indices of the bodies that it can touch; the mover may be among them.
        mover: Index of the body that moves; it does not touch itself.
        x: m, the middle of its soles; so y and z.
        dx: m, the displacement; so dy and dz.

    Returns:
        The first contact. Bodies that already overlap do not stop each other.
    """
    first = FREE
    near = 2.0 * BODY_RADIUS
    for other in others:
        if other == mover:
            continue
        from_x, from_z = x - bodies[other, 0], z - bodies[other, 2]
        reach = near + SKIN + abs(dx) + abs(dz)
        if from_x * from_x + from_z * from_z > reach * reach:
            continue
        over = y - bodies[other, 1] - BODY_HEIGHT
        under = bodies[other, 1] - BODY_HEIGHT - y
        cut = Cut(-1.0, 1.0, 0.0, 0.0, 0.0, False, False)
        cut = _cut_by_face(cut, 0.0, 1.0, 0.0, over, over + dy)
        if cut.missed:
            continue
        cut = _cut_by_face(cut, 0.0, -1.0, 0.0, under, under - dy)
        if cut.missed:
            continue
        cut = _cut_by_circle(cut, from_x, from_z, dx, dz, near)
        if cut.missed or not cut.outside or cut.enter < 0.0 or cut.enter > cut.leave:
            continue
        if cut.enter < first.fraction:
            first = Contact(cut.enter, cut.n_x, cut.n_y, cut.n_z)
    return first


@kernel
def _cut_by_circle(cut: Cut, x: float, z: float, dx: float, dz: float, radius: float) -> Cut:
    """Clip a displacement by an upright cylinder about the origin."""
    missed = Cut(cut.enter, cut.leave, cut.n_x, cut.n_y, cut.n_z, True, True)
    distance = np.sqrt(x * x + z * z)
    if distance <= radius:
        return cut
    toward = x * dx + z * dz
    if toward >= 0.0:
        return missed
    if distance <= radius + SKIN:
        enter = 0.0
    else:
        keep = radius + SKIN
        length = dx * dx + dz * dz
        root = toward * toward - length * (distance * distance - keep * keep)
        if root < 0.0:
            return missed
        enter = (-toward - np.sqrt(root)) / length
        if enter > 1.0:
            return missed
    if enter > cut.enter:
        touch_x, touch_z = x + dx * enter, z + dz * enter
        norm = np.sqrt(touch_x * touch_x + touch_z * touch_z)
        return Cut(enter, cut.leave, touch_x / norm, 0.0, touch_z / norm, True, False)
    return Cut(cut.enter, cut.leave, cut.n_x, cut.n_y, cut.n_z, True, False)


@kernel
def is_body_near(
    bodies: NDArray[np.float64],
    others: NDArray[np.int32],
    mover: int,
    x: float,
    y: float,
    z: float,
    reach: float,
) -> bool:
    """Return whether a body may touch another one when it moves up to ``reach`` m sideways.

    Args:
        bodies: (A, 3) m, the soles of all bodies.
        others: (N,) indices of the bodies that it can touch; the mover may be among them.
        x: m, the middle of its soles; so y and z.
        reach: m.
    """
    apart = 2.0 * BODY_RADIUS + reach
    for other in others:
        if other == mover:
            continue
        east, north = bodies[other, 0] - x, bodies[other, 2] - z
        if east * east + north * north <= apart * apart and abs(bodies[other, 1] - y) <= NEAR_HEIGHT:
            return True
    return False
