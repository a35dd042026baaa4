"""Flight: jumping, falling, landing, and the collisions during them."""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import Contact
from wildscav_engine.geometry.terrain import ground_at, is_steep
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.collision import (
    FARTHEST,
    SLIDES,
    Bodies,
    Moved,
    Point,
    Surroundings,
    along,
    clip,
    inside_edges,
    sideways,
    sweep,
)
from wildscav_engine.motion.walking import LIFT
from wildscav_engine.specs.body import COS_SLOPE_LIMIT, FALL_SPEED_LIMIT, GRAVITY
from wildscav_engine.specs.rules import FRAME

ROUNDING = 1e-9  # m
HELD = 0.1  # of a free fall; a body that falls less, wedged between steep faces, counts as standing


@kernel
def rise_after(rise: float) -> float:
    """Return the vertical speed in m/s a frame later, in free flight."""
    return max(rise - GRAVITY * FRAME, -FALL_SPEED_LIMIT)


@kernel
def flown(rise: float) -> float:
    """Return the rise in m during a frame of free flight: the exact parabola, at any frame rate."""
    return 0.5 * (rise + rise_after(rise)) * FRAME


@kernel
def fly_among_obstacles(
    world: World,
    bodies: Bodies,
    surroundings: Surroundings,
    here: Point,
    delta_x: float,
    delta_z: float,
    rise: float,
) -> Moved:
    """Jump or fall for one frame, with an initial vertical speed of ``rise`` m/s."""
    at, delta = here, Point(delta_x, flown(rise), delta_z)
    later, free_rise = rise_after(rise), flown(rise)
    landed, is_held = False, False
    for _ in range(SLIDES):
        delta = inside_edges(world, at, delta)
        contact = sweep(world, bodies, surroundings, at, delta)
        at = along(at, delta, contact.fraction)
        if contact.fraction >= 1.0:
            break
        landed = landed or contact.n_y >= COS_SLOPE_LIMIT
        is_held = is_held or 0.0 < contact.n_y < COS_SLOPE_LIMIT
        if contact.n_y < 0.0:
            later = min(later, 0.0)
        delta = _slip(delta, contact)
    ground = ground_at(world, at.x, at.z)
    if at.y <= ground.height:
        if ground.height > here.y + (0.0 if is_steep(ground) else LIFT):
            # The body flew against a steep slope, so it only rises or falls where it is.
            return _fly_straight(world, bodies, surroundings, here, rise)
        up = sweep(world, bodies, surroundings, at, Point(0.0, ground.height - at.y, 0.0))
        if up.fraction < 1.0:  # no space between ground and ceiling
            return _fly_straight(world, bodies, surroundings, here, rise)
        return Moved(at.x, ground.height, at.z, 0.0, True)
    if is_held and free_rise < 0.0 and at.y - here.y > HELD * free_rise:
        landed = True
    if landed:
        return Moved(at.x, at.y, at.z, 0.0, True)
    return Moved(at.x, at.y, at.z, _rise_left(later, free_rise, at.y - here.y), False)


@kernel
def _rise_left(later: float, free_rise: float, risen: float) -> float:
    """Return the vertical speed in m/s of a body that may have been stopped: no faster than it really fell.

    Args:
        later: m/s, its vertical speed in free flight.
        free_rise: m, its rise in a frame of free flight.
        risen: m, its actual rise.
    """
    if later >= 0.0 or risen <= free_rise + ROUNDING:
        return later
    return min(max(later, risen / FRAME - 0.5 * GRAVITY * FRAME), 0.0)


@kernel
def _fly_straight(
    world: World, bodies: Bodies, surroundings: Surroundings, here: Point, rise: float
) -> Moved:
    """Rise or fall without horizontal motion."""
    later, free_rise = rise_after(rise), flown(rise)
    ground = ground_at(world, here.x, here.z).height
    delta = Point(0.0, max(free_rise, ground - here.y), 0.0)
    contact = sweep(world, bodies, surroundings, here, delta)
    at = along(here, delta, contact.fraction)
    landed = at.y <= ground or (contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT)
    if contact.fraction < 1.0 and contact.n_y < 0.0:
        later = min(later, 0.0)
    if landed:
        return Moved(at.x, max(at.y, ground), at.z, 0.0, True)
    return Moved(at.x, at.y, at.z, _rise_left(later, free_rise, at.y - here.y), False)


@kernel
def _slip(delta: Point, contact: Contact) -> Point:
    """Return the rest of a flight's displacement along the surface that stopped it."""
    left = 1.0 - contact.fraction
    delta = Point(delta.x * left, delta.y * left, delta.z * left)
    wall = sideways(contact)
    if delta.x * wall.n_x + delta.y * wall.n_y + delta.z * wall.n_z < 0.0:
        delta = clip(wall, delta)  # a body does not slide up steep faces
    if delta.x * contact.n_x + delta.y * contact.n_y + delta.z * contact.n_z < 0.0:
        delta = clip(contact, delta)
    # A fall onto a steep face continues sideways, but no faster than a body can walk.
    aside = np.sqrt(delta.x * delta.x + delta.z * delta.z)
    share = FARTHEST * left / max(FARTHEST * left, aside)
    return Point(delta.x * share, delta.y * share, delta.z * share)
