"""Flight: jumping, falling, landing, and what is met on the way."""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import Contact
from wildscav_engine.geometry.terrain import ground_at, is_steep
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.collision import (
    FARTHEST,
    SLIDES,
    Around,
    Bodies,
    Moved,
    Point,
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
HELD = 0.1  # of a free fall; what falls less, held by steep faces on several sides, stands


@kernel
def rise_after(rise: float) -> float:
    """Return the vertical speed in m/s a frame later, in free flight."""
    return max(rise - GRAVITY * FRAME, -FALL_SPEED_LIMIT)


@kernel
def flown(rise: float) -> float:
    """Return how far up in m a frame of free flight leads: the true parabola, at any frame rate."""
    return 0.5 * (rise + rise_after(rise)) * FRAME


@kernel
def fly_among(
    world: World, bodies: Bodies, around: Around, here: Point, way_x: float, way_z: float, rise: float
) -> Moved:
    """Jump or fall for one frame, at a vertical speed of ``rise`` m/s when it begins."""
    at, way = here, Point(way_x, flown(rise), way_z)
    later, free_rise = rise_after(rise), flown(rise)
    landed, is_held = False, False
    for _ in range(SLIDES):
        way = inside_edges(world, at, way)
        contact = sweep(world, bodies, around, at, way)
        at = along(at, way, contact.fraction)
        if contact.fraction >= 1.0:
            break
        landed = landed or contact.n_y >= COS_SLOPE_LIMIT
        is_held = is_held or 0.0 < contact.n_y < COS_SLOPE_LIMIT
        if contact.n_y < 0.0:
            later = min(later, 0.0)
        way = _slip(way, contact)
    ground = ground_at(world, at.x, at.z)
    if at.y <= ground.height:
        if ground.height > here.y + (0.0 if is_steep(ground) else LIFT):
            # It flew against a steep slope: it falls or rises where it is.
            return _fly_straight(world, bodies, around, here, rise)
        up = sweep(world, bodies, around, at, Point(0.0, ground.height - at.y, 0.0))
        if up.fraction < 1.0:  # no room between ground and ceiling
            return _fly_straight(world, bodies, around, here, rise)
        return Moved(at.x, ground.height, at.z, 0.0, True)
    if is_held and free_rise < 0.0 and at.y - here.y > HELD * free_rise:
        landed = True
    if landed:
        return Moved(at.x, at.y, at.z, 0.0, True)
    return Moved(at.x, at.y, at.z, _rise_left(later, free_rise, at.y - here.y), False)


@kernel
def _rise_left(later: float, free_rise: float, risen: float) -> float:
    """Return the vertical speed in m/s of a body that may have been held up: it falls no faster than it did.

    Args:
        later: m/s, what it would be in free flight.
        free_rise: m, how far up a frame of free flight would have led.
        risen: m, how far it did.
    """
    if later >= 0.0 or risen <= free_rise + ROUNDING:
        return later
    return min(max(later, risen / FRAME - 0.5 * GRAVITY * FRAME), 0.0)


@kernel
def _fly_straight(world: World, bodies: Bodies, around: Around, here: Point, rise: float) -> Moved:
    """Rise or fall without going sideways."""
    later, free_rise = rise_after(rise), flown(rise)
    ground = ground_at(world, here.x, here.z).height
    way = Point(0.0, max(free_rise, ground - here.y), 0.0)
    contact = sweep(world, bodies, around, here, way)
    at = along(here, way, contact.fraction)
    landed = at.y <= ground or (contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT)
    if contact.fraction < 1.0 and contact.n_y < 0.0:
        later = min(later, 0.0)
    if landed:
        return Moved(at.x, max(at.y, ground), at.z, 0.0, True)
    return Moved(at.x, at.y, at.z, _rise_left(later, free_rise, at.y - here.y), False)


@kernel
def _slip(way: Point, contact: Contact) -> Point:
    """Return what is left of a flight along the surface that stopped it."""
    left = 1.0 - contact.fraction
    way = Point(way.x * left, way.y * left, way.z * left)
    wall = sideways(contact)
    if way.x * wall.n_x + way.y * wall.n_y + way.z * wall.n_z < 0.0:
        way = clip(wall, way)  # steep faces lead nobody upwards
    if way.x * contact.n_x + way.y * contact.n_y + way.z * contact.n_z < 0.0:
        way = clip(contact, way)
    # A fall onto a steep face goes on sideways, but no faster than anybody can walk.
    aside = np.sqrt(way.x * way.x + way.z * way.z)
    share = FARTHEST * left / max(FARTHEST * left, aside)
    return Point(way.x * share, way.y * share, way.z * share)
