"""Collisions of a moving body with solids and other bodies, and the displacement that is left afterwards."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.nearby_solids import (
    NearbySolids,
    find_nearby_solids,
    has_nearby_solids,
    sweep_nearby_solids,
)
from wildscav_engine.geometry.sweep import FREE, SKIN, Contact, is_body_near, sweep_bodies
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.specs.actions import MAX_WALK_SPEED
from wildscav_engine.specs.body import (
    BODY_HEIGHT,
    BODY_RADIUS,
    COS_SLOPE_LIMIT,
    EDGE_MARGIN,
    FALL_SPEED_LIMIT,
)
from wildscav_engine.specs.rules import FRAME

SLIDES = 4  # how many surfaces one move can slide along
FARTHEST = MAX_WALK_SPEED * FRAME  # m, the greatest horizontal displacement in a frame, by any means
TOUCHING = 3.0 * SKIN  # m; a body this close above a surface stands on it
# A slide removes slightly more than the displacement into the surface, so that rounding cannot make bodies
# stick.
SEPARATION = 1.0 + 1e-6
BELOW = FALL_SPEED_LIMIT * FRAME + FARTHEST  # m below the soles that a move can reach
ABOVE = BODY_HEIGHT + 1.6  # m above them: up a step, up a slope and up onto the ground


class Bodies(NamedTuple):
    """The bodies of a match, as obstacles to the one that moves."""

    position: NDArray[np.float64]  # (A, 3) m, soles
    others: NDArray[np.int32]  # (N,) indices of those that can be touched
    mover: int


class Point(NamedTuple):
    """A place or a displacement, in m."""

    x: float
    y: float
    z: float


class Moved(NamedTuple):
    """The state of a body after a move."""

    x: float
    y: float
    z: float
    rise: float  # m/s, the vertical speed
    on_ground: bool


class Surroundings(NamedTuple):
    """The solids and bodies that a body can touch in one move."""

    solids: NearbySolids
    has_solids: bool
    has_bodies: bool


@kernel
def find_surroundings(world: World, bodies: Bodies, here: Point, far: float) -> Surroundings:
    """Find what a body can touch in a move of up to ``far`` m sideways; ``far`` is at most 0.5."""
    reach = BODY_RADIUS + 2.0 * SKIN + far
    solids = find_nearby_solids(world, here.x, here.z, reach, here.y - BELOW, here.y + ABOVE)
    has_bodies = is_body_near(bodies.position, bodies.others, bodies.mover, here.x, here.y, here.z, 2.0 * far)
    return Surroundings(solids, has_nearby_solids(solids), has_bodies)


@kernel
def sweep(world: World, bodies: Bodies, surroundings: Surroundings, at: Point, delta: Point) -> Contact:
    """Return the first contact with a solid or another body."""
    contact = FREE
    if surroundings.has_solids:
        contact = sweep_nearby_solids(world, surroundings.solids, at.x, at.y, at.z, delta.x, delta.y, delta.z)
    if surroundings.has_bodies:
        position, others, mover = bodies
        other = sweep_bodies(position, others, mover, at.x, at.y, at.z, delta.x, delta.y, delta.z)
        if other.fraction < contact.fraction:
            contact = other
    return contact


@kernel
def along(at: Point, delta: Point, fraction: float) -> Point:
    """Return the place after a fraction of a displacement."""
    return Point(at.x + delta.x * fraction, at.y + delta.y * fraction, at.z + delta.z * fraction)


@kernel
def slide(world: World, bodies: Bodies, surroundings: Surroundings, at: Point, delta: Point) -> Point:
    """Move by a displacement, sliding along the surfaces that stop the body; return where it ends.

    A body slides up floors and gentle roofs, only sideways along walls and steep faces, and never over the
    edge of the map.
    """
    first_x, first_z = delta.x, delta.z
    for _ in range(SLIDES):
        delta = inside_edges(world, at, delta)
        contact = sweep(world, bodies, surroundings, at, delta)
        at = along(at, delta, contact.fraction)
        if contact.fraction >= 1.0:
            break
        left = 1.0 - contact.fraction
        delta = clip(sideways(contact), Point(delta.x * left, delta.y * left, delta.z * left))
        # Never turn back: the body would jitter in a corner.
        if delta.x * first_x + delta.z * first_z <= 0.0:
            break
    return at


@kernel
def sideways(contact: Contact) -> Contact:
    """Return a contact; one with a face too steep to walk up becomes a contact with a wall."""
    if not 0.0 < contact.n_y < COS_SLOPE_LIMIT:
        return contact
    flat = np.sqrt(contact.n_x * contact.n_x + contact.n_z * contact.n_z)
    return Contact(contact.fraction, contact.n_x / flat, 0.0, contact.n_z / flat)


@kernel
def clip(contact: Contact, delta: Point) -> Point:
    """Return the part of a displacement along the surface that stopped it."""
    into = (delta.x * contact.n_x + delta.y * contact.n_y + delta.z * contact.n_z) * SEPARATION
    return Point(delta.x - contact.n_x * into, delta.y - contact.n_y * into, delta.z - contact.n_z * into)


@kernel
def inside_edges(world: World, here: Point, delta: Point) -> Point:
    """Limit a displacement so that it ends inside the map or, from outside, leads no farther out."""
    rows, columns = world.water.shape
    west, south = world.corner[0] + EDGE_MARGIN, world.corner[1] + EDGE_MARGIN
    east = world.corner[0] + columns * CELL - EDGE_MARGIN
    north = world.corner[1] + rows * CELL - EDGE_MARGIN
    delta_x = max(min(delta.x, max(east - here.x, 0.0)), min(west - here.x, 0.0))
    delta_z = max(min(delta.z, max(north - here.z, 0.0)), min(south - here.z, 0.0))
    return Point(delta_x, delta.y, delta_z)
