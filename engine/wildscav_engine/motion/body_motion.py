"""The motion of one body in one frame.

Most frames take place on open ground, where nothing but the terrain matters. ``move`` handles those itself as
a fast path. Flight, that is jumping, falling, landing and the collisions during them, is here as well;
``walking.py`` handles all others. For open ground, both would give the same result, bit for bit.
"""

import numpy as np

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.sweep import Contact, is_body_near
from wildscav_engine.geometry.terrain import Ground, ground_at, is_steep
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.motion.collision import (
    FARTHEST,
    SLIDES,
    TOUCHING,
    Bodies,
    Moved,
    Point,
    Surroundings,
    along,
    clip,
    find_surroundings,
    inside_edges,
    sideways,
    sweep,
)
from wildscav_engine.motion.walking import LIFT, is_sliding, walk_among_obstacles
from wildscav_engine.specs.body import (
    BODY_HEIGHT,
    COS_SLOPE_LIMIT,
    FALL_SPEED_LIMIT,
    GRAVITY,
    JUMP_SPEED,
    STEP_HEIGHT,
)
from wildscav_engine.specs.rules import FRAME

ROUNDING = 1e-9  # m
HELD = 0.1  # of a free fall; a body that falls less, wedged between steep faces, counts as standing
HEADROOM = STEP_HEIGHT + LIFT + TOUCHING  # m of free space above a body that the fast path requires


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
        rise: m/s, its vertical speed; 0 on the ground.
        on_ground: Whether it stands on something.
        walk_direction: Degrees, compass.
        walk_speed: m/s. In the air it steers as on the ground: there is no horizontal inertia.
        jump: Whether to jump; this works only on the ground, not in water and not while sliding.
    """
    east, north = walk_speed * sine(walk_direction), walk_speed * cosine(walk_direction)
    return move_by(world, bodies, rise, on_ground, east, north, jump, water_speed_factor)


@inlined_kernel
def move_by(
    world: World,
    bodies: Bodies,
    rise: float,
    on_ground: bool,
    east: float,
    north: float,
    jump: bool,
    water_speed_factor: float,
) -> Moved:
    """Move one body for one frame like ``move``, at a walk velocity of ``east`` and ``north`` m/s."""
    place = bodies.position[bodies.mover]
    here = Point(place[0], place[1], place[2])
    ground = ground_at(world, here.x, here.z)
    if here.y < ground.water:
        east, north, jump = east * water_speed_factor, north * water_speed_factor, False
    delta_x, _, delta_z = inside_edges(world, here, Point(east * FRAME, 0.0, north * FRAME))
    is_held = is_steep(ground) and here.y <= ground.height + TOUCHING
    walks = on_ground and not jump
    if not is_held:
        there = ground_at(world, here.x + delta_x, here.z + delta_z)
        moved = _move_freely(here, there, delta_x, delta_z, walks, _speed_up(rise, on_ground))
        if _is_open(world, bodies, here, ground, there, moved.y, walks):
            return moved
    return _move_among_obstacles(world, bodies, here, delta_x, delta_z, on_ground, jump, rise)


@kernel
def _speed_up(rise: float, jumps: bool) -> float:
    """Return the vertical speed in m/s at the start of a flight."""
    return JUMP_SPEED if jumps else rise


@kernel
def _move_freely(
    here: Point, there: Ground, delta_x: float, delta_z: float, walks: bool, rise: float
) -> Moved:
    """Return the result of a move if nothing but the ground is near."""
    x, z = here.x + delta_x, here.z + delta_z
    if walks:
        return Moved(x, there.height, z, 0.0, True)
    y = here.y + flown(rise)
    if y <= there.height:
        return Moved(x, there.height, z, 0.0, True)
    return Moved(x, y, z, rise_after(rise), False)


@kernel
def _is_open(
    world: World, bodies: Bodies, here: Point, ground: Ground, there: Ground, height: float, walks: bool
) -> bool:
    """Return whether nothing but gentle ground affects a move that ends at a height of ``height`` m."""
    if there.height > here.y + LIFT or (is_steep(there) and height <= there.height):
        return False
    if walks and (here.y > ground.height + TOUCHING or there.height < here.y - LIFT):
        return False
    rows, columns = world.water.shape
    row, column = cell_of(world.corner[1], here.z, rows), cell_of(world.corner[0], here.x, columns)
    if max(here.y, height) + BODY_HEIGHT + HEADROOM >= world.ceiling[row, column]:
        return False
    position, others, mover = bodies
    return not is_body_near(position, others, mover, here.x, here.y, here.z, 2.0 * FARTHEST)


@kernel
def _move_among_obstacles(
    world: World,
    bodies: Bodies,
    here: Point,
    delta_x: float,
    delta_z: float,
    on_ground: bool,
    jump: bool,
    rise: float,
) -> Moved:
    """Move a body where more than the ground may matter."""
    surroundings = find_surroundings(world, bodies, here, FARTHEST)
    jump = jump and not is_sliding(world, here, ground_at(world, here.x, here.z))
    if on_ground and not jump:
        return walk_among_obstacles(world, bodies, surroundings, here, delta_x, delta_z)
    return fly_among_obstacles(
        world, bodies, surroundings, here, delta_x, delta_z, _speed_up(rise, on_ground)
    )
