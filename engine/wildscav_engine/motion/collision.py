"""What moving bodies meet: solids and each other, swept as one; and what is left of a way after that."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.near import Near, is_anything_near, solids_near, sweep_near
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
FARTHEST = MAX_WALK_SPEED * FRAME  # m, the longest way sideways in a frame, by whatever means
TOUCHING = 3.0 * SKIN  # m, a body this near above something stands on it
# What slides along a surface leaves it by this share of what it ran into it: rounding must not hold it there.
LEAVING = 1.0 + 1e-6
BELOW = FALL_SPEED_LIMIT * FRAME + FARTHEST  # m, what a move can reach under the soles
ABOVE = BODY_HEIGHT + 1.6  # m, and over them: up a step, up a slope and up onto the ground


class Bodies(NamedTuple):
    """The bodies of a match, as obstacles to the one that moves."""

    position: NDArray[np.float64]  # (A, 3) m, soles
    others: NDArray[np.int32]  # (N,) the seats of those that can be met
    mover: int


class Point(NamedTuple):
    """A place in m, or a way from one place to another."""

    x: float
    y: float
    z: float


class Moved(NamedTuple):
    """Where a move ended."""

    x: float
    y: float
    z: float
    rise: float  # m/s, the vertical speed left
    on_ground: bool


class Around(NamedTuple):
    """What a body can touch in one move."""

    solids: Near
    has_solids: bool
    has_bodies: bool


@kernel
def look_around(world: World, bodies: Bodies, here: Point, far: float) -> Around:
    """Find what a body can touch in a move of up to ``far`` m sideways, at most 0.5 m."""
    reach = BODY_RADIUS + 2.0 * SKIN + far
    solids = solids_near(world, here.x, here.z, reach, here.y - BELOW, here.y + ABOVE)
    has_bodies = is_body_near(bodies.position, bodies.others, bodies.mover, here.x, here.y, here.z, 2.0 * far)
    return Around(solids, is_anything_near(solids), has_bodies)


@kernel
def sweep(world: World, bodies: Bodies, around: Around, at: Point, way: Point) -> Contact:
    """Return the first contact with a solid or another body."""
    contact = FREE
    if around.has_solids:
        contact = sweep_near(world, around.solids, at.x, at.y, at.z, way.x, way.y, way.z)
    if around.has_bodies:
        position, others, mover = bodies
        other = sweep_bodies(position, others, mover, at.x, at.y, at.z, way.x, way.y, way.z)
        if other.fraction < contact.fraction:
            contact = other
    return contact


@kernel
def along(at: Point, way: Point, fraction: float) -> Point:
    """Return the place where a share of a way ends."""
    return Point(at.x + way.x * fraction, at.y + way.y * fraction, at.z + way.z * fraction)


@kernel
def slide(world: World, bodies: Bodies, around: Around, at: Point, way: Point) -> Point:
    """Go a way; where something stops it, go on along its surface.

    Floors and gentle roofs lead upwards, walls and steep faces only sideways, and nothing leads over the edge
    of the map.
    """
    first_x, first_z = way.x, way.z
    for _ in range(SLIDES):
        way = inside_edges(world, at, way)
        contact = sweep(world, bodies, around, at, way)
        at = along(at, way, contact.fraction)
        if contact.fraction >= 1.0:
            break
        left = 1.0 - contact.fraction
        way = clip(sideways(contact), Point(way.x * left, way.y * left, way.z * left))
        # Never turn back: in a corner, that would tremble.
        if way.x * first_x + way.z * first_z <= 0.0:
            break
    return at


@kernel
def sideways(contact: Contact) -> Contact:
    """Return a contact with a face too steep to walk up as one with a wall."""
    if not 0.0 < contact.n_y < COS_SLOPE_LIMIT:
        return contact
    flat = np.sqrt(contact.n_x * contact.n_x + contact.n_z * contact.n_z)
    return Contact(contact.fraction, contact.n_x / flat, 0.0, contact.n_z / flat)


@kernel
def clip(contact: Contact, way: Point) -> Point:
    """Return what is left of a way along the surface that stopped it."""
    into = (way.x * contact.n_x + way.y * contact.n_y + way.z * contact.n_z) * LEAVING
    return Point(way.x - contact.n_x * into, way.y - contact.n_y * into, way.z - contact.n_z * into)


@kernel
def inside_edges(world: World, here: Point, way: Point) -> Point:
    """Cut a way so that it ends inside the map; from outside, so that it leads no farther out."""
    rows, columns = world.water.shape
    west, south = world.corner[0] + EDGE_MARGIN, world.corner[1] + EDGE_MARGIN
    east = world.corner[0] + columns * CELL - EDGE_MARGIN
    north = world.corner[1] + rows * CELL - EDGE_MARGIN
    way_x = max(min(way.x, max(east - here.x, 0.0)), min(west - here.x, 0.0))
    way_z = max(min(way.z, max(north - here.z, 0.0)), min(south - here.z, 0.0))
    return Point(way_x, way.y, way_z)
