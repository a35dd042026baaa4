"""The motion of one body in one frame.

Most frames take place on open ground, where nothing but the terrain matters. This file handles those itself
as a fast path. ``walking.py`` and ``flight.py`` handle all others; for open ground they would give the same
result, bit for bit.
"""

from wildscav_engine.arithmetic.elementary_functions import cosine, sine
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.sweep import is_body_near
from wildscav_engine.geometry.terrain import Ground, ground_at, is_steep
from wildscav_engine.geometry.world import World, cell_of
from wildscav_engine.motion.collision import (
    FARTHEST,
    TOUCHING,
    Bodies,
    Moved,
    Point,
    find_surroundings,
    inside_edges,
)
from wildscav_engine.motion.flight import flown, fly_among_obstacles, rise_after
from wildscav_engine.motion.walking import LIFT, is_sliding, walk_among_obstacles
from wildscav_engine.specs.body import BODY_HEIGHT, JUMP_SPEED, STEP_HEIGHT
from wildscav_engine.specs.rules import FRAME

HEADROOM = STEP_HEIGHT + LIFT + TOUCHING  # m of free space above a body that the fast path requires


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

    Returns:
        The body's state after the frame.
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
