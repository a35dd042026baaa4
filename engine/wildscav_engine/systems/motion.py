"""Motion: walking, steps and slopes, jumping and falling, water, and being stopped by everything else.

A body that is somewhere free is moved to somewhere free: each part of a move is swept (``geometry/sweep``),
and where the ground leaves no room, the whole move is taken back. So nothing is ever passed through.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.actions import MAX_WALK_SPEED
from wildscav_engine.body import (
    COS_SLOPE_LIMIT,
    EDGE_MARGIN,
    FALL_SPEED_LIMIT,
    GRAVITY,
    JUMP_SPEED,
    SLIDE_SPEED,
    STEP_HEIGHT,
    TAN_SLOPE_LIMIT,
)
from wildscav_engine.geometry.sweep import SKIN, Contact, sweep_bodies, sweep_world
from wildscav_engine.geometry.terrain import ground_at, water_at
from wildscav_engine.geometry.world import CELL, World
from wildscav_engine.kernel import kernel
from wildscav_engine.rules import FRAME
from wildscav_engine.trig import cosine, sine

SLIDES = 4  # how many surfaces one move can slide along
FARTHEST = MAX_WALK_SPEED * FRAME  # m, the longest way sideways in a frame, by whatever means
# What slides along a surface leaves it by this share of what it ran into it: rounding must not hold it there.
LEAVING = 1.0 + 1e-6
TOUCHING = 3.0 * SKIN  # m, a body this near above something stands on it


class Bodies(NamedTuple):
    """All bodies of a match, as obstacles to the one that moves."""

    position: NDArray[np.float64]  # (A, 3) m, soles
    health: NDArray[np.int32]  # (A,) hp; the dead are no obstacles
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


@kernel
def move(
    world: World,
    bodies: Bodies,
    rise: float,
    on_ground: bool,
    walk_direction: float,
    walk_speed: float,
    jump: bool,
    water_speed_factor: float,
) -> Moved:
    """Move one body for one frame.

    Args:
        world: The static world.
        bodies: All bodies, and which of them moves.
        rise: m/s, its vertical speed; 0 on the ground.
        on_ground: Whether it stands on something.
        walk_direction: Degrees, compass.
        walk_speed: m/s. In the air it steers as on the ground: there is no inertia sideways.
        jump: Whether to jump; only from the ground, and not in water or on ground too steep to stand on.
        water_speed_factor: What is left of the walk speed in water.

    Returns:
        Where it is after the frame.
    """
    place = bodies.position[bodies.mover]
    here = Point(place[0], place[1], place[2])
    speed = walk_speed
    if here.y < water_at(world, here.x, here.z):
        speed *= water_speed_factor
        jump = False
    if on_steep_ground(world, here):
        jump = False
    way_x = speed * FRAME * sine(walk_direction)
    way_z = speed * FRAME * cosine(walk_direction)
    way_x, way_z = _inside_edges(world, here, way_x, way_z)
    if on_ground and not jump:
        return walk(world, bodies, here, way_x, way_z)
    if on_ground:
        rise = JUMP_SPEED
    return _fly(world, bodies, here, way_x, way_z, rise)


@kernel
def _inside_edges(world: World, here: Point, way_x: float, way_z: float) -> tuple[float, float]:
    """Cut a way so that it ends inside the map."""
    rows, columns = world.water.shape
    west, south = world.corner[0] + EDGE_MARGIN, world.corner[1] + EDGE_MARGIN
    east = world.corner[0] + columns * CELL - EDGE_MARGIN
    north = world.corner[1] + rows * CELL - EDGE_MARGIN
    to_x = min(max(here.x + way_x, west), east)
    to_z = min(max(here.z + way_z, south), north)
    return to_x - here.x, to_z - here.z


@kernel
def _sweep(world: World, bodies: Bodies, at: Point, way: Point) -> Contact:
    """Return the first contact with the world or another body."""
    contact = sweep_world(world, at.x, at.y, at.z, way.x, way.y, way.z)
    other = sweep_bodies(bodies.position, bodies.health, bodies.mover, at.x, at.y, at.z, way.x, way.y, way.z)
    return other if other.fraction < contact.fraction else contact


@kernel
def _along(at: Point, way: Point, fraction: float) -> Point:
    return Point(at.x + way.x * fraction, at.y + way.y * fraction, at.z + way.z * fraction)


@kernel
def _slide(world: World, bodies: Bodies, at: Point, way: Point) -> Point:
    """Go a way; where something stops it, go on along its surface.

    Floors and gentle roofs lead upwards, walls and steep faces only sideways.
    """
    first_x, first_z = way.x, way.z
    for _ in range(SLIDES):
        contact = _sweep(world, bodies, at, way)
        at = _along(at, way, contact.fraction)
        if contact.fraction >= 1.0:
            break
        left = 1.0 - contact.fraction
        way = _clip(Point(way.x * left, way.y * left, way.z * left), contact)
        # Never turn back: in a corner, that would tremble.
        if way.x * first_x + way.z * first_z <= 0.0:
            break
    return at


@kernel
def _clip(way: Point, contact: Contact) -> Point:
    """Return what is left of a way along the surface that stopped it."""
    n_x, n_y, n_z = contact.n_x, contact.n_y, contact.n_z
    if 0.0 < n_y < COS_SLOPE_LIMIT:
        flat = np.sqrt(n_x * n_x + n_z * n_z)
        n_x, n_y, n_z = n_x / flat, 0.0, n_z / flat
    into = (way.x * n_x + way.y * n_y + way.z * n_z) * LEAVING
    return Point(way.x - n_x * into, way.y - n_y * into, way.z - n_z * into)


@kernel
def walk(world: World, bodies: Bodies, here: Point, way_x: float, way_z: float) -> Moved:
    """Walk on the ground: level, up and down slopes, steps and stairs."""
    way_x, way_z = _off_steep_ground(world, here, way_x, way_z)
    reached = here
    if way_x != 0.0 or way_z != 0.0:
        reached = _slide(world, bodies, here, _over_ground(world, here, way_x, way_z))
        wanted = way_x * way_x + way_z * way_z
        if _gain(here, reached, way_x, way_z) < 0.999 * wanted:
            stepped = _step_up(world, bodies, here, way_x, way_z)
            if _gain(here, stepped, way_x, way_z) > _gain(here, reached, way_x, way_z) + 1e-9:
                reached = stepped
    landed = _settle(world, bodies, reached)
    if landed.y < ground_at(world, landed.x, landed.z).height - 1e-9:
        return Moved(here.x, here.y, here.z, 0.0, True)  # no room between ground and ceiling
    if on_steep_ground(world, landed) and _climbs(here, landed):
        return Moved(here.x, here.y, here.z, 0.0, True)
    on_ground = _stands(world, bodies, landed)
    return Moved(landed.x, landed.y, landed.z, 0.0, on_ground)


@kernel
def on_steep_ground(world: World, at: Point) -> bool:
    """Return whether a body touches ground too steep to stand on."""
    ground = ground_at(world, at.x, at.z)
    steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
    return bool(steepness > TAN_SLOPE_LIMIT and at.y <= ground.height + TOUCHING)


@kernel
def _climbs(here: Point, there: Point) -> bool:
    """Return whether a move leads upwards more steeply than anybody can walk."""
    dx, dz = there.x - here.x, there.z - here.z
    return bool(there.y - here.y > TAN_SLOPE_LIMIT * np.sqrt(dx * dx + dz * dz) + TOUCHING)


@kernel
def _gain(here: Point, there: Point, way_x: float, way_z: float) -> float:
    """Return how far a move has come along the wanted way (times its length)."""
    return (there.x - here.x) * way_x + (there.z - here.z) * way_z


@kernel
def _over_ground(world: World, here: Point, way_x: float, way_z: float) -> Point:
    """Return a way that rises with the ground; none into ground too steep to walk up."""
    ground = ground_at(world, here.x + way_x, here.z + way_z)
    rise = ground.height - here.y
    if rise <= 0.0:
        return Point(way_x, 0.0, way_z)
    steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
    if steepness > TAN_SLOPE_LIMIT:
        up_x, up_z = ground.slope_x / steepness, ground.slope_z / steepness
        uphill = way_x * up_x + way_z * up_z
        if uphill > 0.0:
            way_x, way_z = way_x - up_x * uphill, way_z - up_z * uphill
            rise = ground_at(world, here.x + way_x, here.z + way_z).height - here.y
            if rise > TAN_SLOPE_LIMIT * np.sqrt(way_x * way_x + way_z * way_z):
                return Point(0.0, 0.0, 0.0)
    return Point(way_x, max(0.0, rise), way_z)


@kernel
def _off_steep_ground(world: World, here: Point, way_x: float, way_z: float) -> tuple[float, float]:
    """Let a body that stands on ground too steep slide downhill."""
    if not on_steep_ground(world, here):
        return way_x, way_z
    ground = ground_at(world, here.x, here.z)
    steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
    slide = SLIDE_SPEED * FRAME / steepness
    way_x, way_z = way_x - ground.slope_x * slide, way_z - ground.slope_z * slide
    share = FARTHEST / max(FARTHEST, np.sqrt(way_x * way_x + way_z * way_z))
    return _inside_edges(world, here, way_x * share, way_z * share)


@kernel
def _step_up(world: World, bodies: Bodies, here: Point, way_x: float, way_z: float) -> Point:
    """Go up by the height of a step, then along the way: over what is low enough."""
    up = _sweep(world, bodies, here, Point(0.0, STEP_HEIGHT, 0.0))
    lifted = Point(here.x, here.y + STEP_HEIGHT * up.fraction, here.z)
    there = _slide(world, bodies, lifted, Point(way_x, 0.0, way_z))
    ground = ground_at(world, there.x, there.z)
    if ground.height > there.y:
        return here
    down = _sweep(world, bodies, there, Point(0.0, here.y - there.y, 0.0))
    if down.fraction < 1.0 and down.n_y < COS_SLOPE_LIMIT:
        return here  # it would stand on something too steep
    return Point(there.x, max(ground.height, there.y + (here.y - there.y) * down.fraction), there.z)


@kernel
def _settle(world: World, bodies: Bodies, at: Point) -> Point:
    """Put a body onto the ground, a floor or a step that is near below (or above, for the ground)."""
    ground = ground_at(world, at.x, at.z).height
    if ground > at.y:
        up = _sweep(world, bodies, at, Point(0.0, ground - at.y, 0.0))
        return Point(at.x, ground if up.fraction >= 1.0 else at.y + (ground - at.y) * up.fraction, at.z)
    drop = max(ground - at.y, -STEP_HEIGHT)
    down = _sweep(world, bodies, at, Point(0.0, drop, 0.0))
    if down.fraction >= 1.0 and ground < at.y - STEP_HEIGHT:
        return at  # nothing near below: it will fall
    return Point(at.x, at.y + drop * down.fraction, at.z)


@kernel
def _stands(world: World, bodies: Bodies, at: Point) -> bool:
    """Return whether there is something right below a body."""
    if at.y <= ground_at(world, at.x, at.z).height + TOUCHING:
        return True
    contact = _sweep(world, bodies, at, Point(0.0, -TOUCHING, 0.0))
    return contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT


@kernel
def _fly(world: World, bodies: Bodies, here: Point, way_x: float, way_z: float, rise: float) -> Moved:
    """Jump or fall."""
    rise = max(rise - GRAVITY * FRAME, -FALL_SPEED_LIMIT)
    at, way = here, Point(way_x, rise * FRAME, way_z)
    landed = False
    for _ in range(SLIDES):
        contact = _sweep(world, bodies, at, way)
        at = _along(at, way, contact.fraction)
        if contact.fraction >= 1.0:
            break
        if contact.n_y >= COS_SLOPE_LIMIT:
            landed = True
        elif contact.n_y < 0.0:
            rise = min(rise, 0.0)
        way = _slip(way, contact)
    ground = ground_at(world, at.x, at.z).height
    if at.y <= ground and on_steep_ground(world, Point(at.x, ground, at.z)) and ground > here.y:
        # It flew against a steep slope: it falls or rises where it is.
        return _fly_straight(world, bodies, here, rise)
    if at.y <= ground:
        landed = True
        up = _sweep(world, bodies, at, Point(0.0, ground - at.y, 0.0))
        if up.fraction < 1.0:
            return Moved(here.x, here.y, here.z, 0.0, True)  # no room between ground and ceiling
        at = Point(at.x, ground, at.z)
    return Moved(at.x, at.y, at.z, 0.0 if landed else rise, landed)


@kernel
def _fly_straight(world: World, bodies: Bodies, here: Point, rise: float) -> Moved:
    """Rise or fall without going sideways."""
    ground = ground_at(world, here.x, here.z).height
    way = Point(0.0, max(rise * FRAME, ground - here.y), 0.0)
    contact = _sweep(world, bodies, here, way)
    at = _along(here, way, contact.fraction)
    landed = at.y <= ground or (contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT)
    if contact.fraction < 1.0 and contact.n_y < 0.0:
        rise = min(rise, 0.0)
    return Moved(at.x, at.y, at.z, 0.0 if landed else rise, landed)


@kernel
def _slip(way: Point, contact: Contact) -> Point:
    """Return what is left of a flight along the surface that stopped it."""
    left = 1.0 - contact.fraction
    into = (way.x * contact.n_x + way.y * contact.n_y + way.z * contact.n_z) * LEAVING
    slipped_x = (way.x - contact.n_x * into) * left
    slipped_z = (way.z - contact.n_z * into) * left
    # A fall onto a steep face goes on sideways, but no faster than anybody can walk.
    aside = np.sqrt(slipped_x * slipped_x + slipped_z * slipped_z)
    share = FARTHEST * left / max(FARTHEST * left, aside)
    return Point(slipped_x * share, (way.y - contact.n_y * into) * left * share, slipped_z * share)
