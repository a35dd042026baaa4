"""Walking: on level ground, slopes, steps and stairs; and sliding down ground that is too steep.

A move from a free place always ends at a free place: each part of a move is swept, and if the ground leaves
no space for the body, the whole move is undone. So a body never passes through anything.
"""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.terrain import Ground, ground_at, is_steep
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.collision import (
    FARTHEST,
    TOUCHING,
    Bodies,
    Moved,
    Point,
    Surroundings,
    find_surroundings,
    inside_edges,
    slide,
    sweep,
)
from wildscav_engine.specs.body import COS_SLOPE_LIMIT, SLIDE_SPEED, STEP_HEIGHT, TAN_SLOPE_LIMIT
from wildscav_engine.specs.rules import FRAME

GAINED = 0.999  # of the wanted displacement; a body that came less far was stopped
BURIED = 1e-9  # m that a body may be below the ground because of rounding
# A body clears an obstacle that it is above by any amount, and rests up to SKIN above what it stands on.
CLIMB = STEP_HEIGHT + SKIN  # m that a body rises before a step
LIFT = STEP_HEIGHT + TOUCHING  # m that the ground may raise a body in one move, and that it may step down


@kernel
def walk(world: World, bodies: Bodies, here: Point, delta_x: float, delta_z: float) -> Moved:
    """Walk up to 0.5 m over the ground or whatever else a body stands on."""
    far = max(FARTHEST, np.sqrt(delta_x * delta_x + delta_z * delta_z))
    return walk_among_obstacles(
        world, bodies, find_surroundings(world, bodies, here, far), here, delta_x, delta_z
    )


@kernel
def walk_among_obstacles(
    world: World, bodies: Bodies, surroundings: Surroundings, here: Point, delta_x: float, delta_z: float
) -> Moved:
    """Walk past the obstacles in ``surroundings``."""
    delta_x, delta_z = _off_steep_ground(world, here, delta_x, delta_z)
    reached = here
    if delta_x != 0.0 or delta_z != 0.0:
        reached = _go(world, bodies, surroundings, here, delta_x, delta_z)
    landed = _settle(world, bodies, surroundings, reached)
    if not _is_allowed(world, here, landed):
        landed = _settle(world, bodies, surroundings, here)
    on_ground = _stands(world, bodies, surroundings, landed)
    return Moved(landed.x, landed.y, landed.z, 0.0, on_ground)


@kernel
def _go(
    world: World, bodies: Bodies, surroundings: Surroundings, here: Point, delta_x: float, delta_z: float
) -> Point:
    """Move as far as the path is free, or over a step if that leads farther."""
    reached = slide(world, bodies, surroundings, here, _over_ground(world, here, delta_x, delta_z))
    gain = _gain(here, reached, delta_x, delta_z)
    if gain < GAINED * (delta_x * delta_x + delta_z * delta_z):
        stepped = _step_up(world, bodies, surroundings, here, delta_x, delta_z)
        if _gain(here, stepped, delta_x, delta_z) > gain + 1e-9:
            return stepped
    return reached


@kernel
def _gain(here: Point, there: Point, delta_x: float, delta_z: float) -> float:
    """Return the progress of a move along the wanted displacement (times its length)."""
    return (there.x - here.x) * delta_x + (there.z - here.z) * delta_z


@kernel
def _is_allowed(world: World, here: Point, there: Point) -> bool:
    """Return whether a walk may end at a place: not below the ground and not up a slope that is too steep."""
    ground = ground_at(world, there.x, there.z)
    if there.y < ground.height - BURIED:
        return False  # no space between ground and ceiling
    if not (is_steep(ground) and there.y <= ground.height + TOUCHING):
        return True
    dx, dz = there.x - here.x, there.z - here.z
    return bool(there.y - here.y <= TAN_SLOPE_LIMIT * np.sqrt(dx * dx + dz * dz) + TOUCHING)


@kernel
def on_steep_ground(world: World, at: Point) -> bool:
    """Return whether a body touches ground too steep to stand on."""
    ground = ground_at(world, at.x, at.z)
    return is_steep(ground) and at.y <= ground.height + TOUCHING


@kernel
def is_sliding(world: World, here: Point, ground: Ground) -> bool:
    """Return whether a body slides: the ground is too steep there and leads down from there.

    At the bottom of a narrow gully with two steep sides the ground does not lead down, so a body stands
    there.
    """
    if not (is_steep(ground) and here.y <= ground.height + TOUCHING):
        return False
    delta_x, delta_z = _downhill(ground)
    return ground_at(world, here.x + delta_x, here.z + delta_z).height < here.y - TOUCHING


@kernel
def _downhill(ground: Ground) -> tuple[float, float]:
    """Return the displacement in m of a body that slides down steep ground for a frame."""
    steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
    far = SLIDE_SPEED * FRAME / steepness
    return -ground.slope_x * far, -ground.slope_z * far


@kernel
def _off_steep_ground(world: World, here: Point, delta_x: float, delta_z: float) -> tuple[float, float]:
    """Return a displacement that makes a body on too steep ground slide downhill; it may steer, not stop."""
    ground = ground_at(world, here.x, here.z)
    if not is_sliding(world, here, ground):
        return delta_x, delta_z
    steep = ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z
    uphill = max(0.0, (delta_x * ground.slope_x + delta_z * ground.slope_z) / steep)
    down_x, down_z = _downhill(ground)
    delta_x, delta_z = delta_x - ground.slope_x * uphill + down_x, delta_z - ground.slope_z * uphill + down_z
    share = FARTHEST / max(FARTHEST, np.sqrt(delta_x * delta_x + delta_z * delta_z))
    inside = inside_edges(world, here, Point(delta_x * share, 0.0, delta_z * share))
    return inside.x, inside.z


@kernel
def _over_ground(world: World, here: Point, delta_x: float, delta_z: float) -> Point:
    """Return a displacement that rises with the ground; zero into ground that is too steep to walk up."""
    ground = ground_at(world, here.x + delta_x, here.z + delta_z)
    rise = ground.height - here.y
    if rise <= 0.0:
        return Point(delta_x, 0.0, delta_z)
    if is_steep(ground):
        steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
        up_x, up_z = ground.slope_x / steepness, ground.slope_z / steepness
        uphill = delta_x * up_x + delta_z * up_z
        if uphill > 0.0:
            level = inside_edges(world, here, Point(delta_x - up_x * uphill, 0.0, delta_z - up_z * uphill))
            delta_x, delta_z = level.x, level.z
            rise = ground_at(world, here.x + delta_x, here.z + delta_z).height - here.y
            if rise > TAN_SLOPE_LIMIT * np.sqrt(delta_x * delta_x + delta_z * delta_z):
                return Point(0.0, 0.0, 0.0)
    if rise > LIFT:
        return Point(0.0, 0.0, 0.0)
    return Point(delta_x, max(0.0, rise), delta_z)


@kernel
def _step_up(
    world: World, bodies: Bodies, surroundings: Surroundings, here: Point, delta_x: float, delta_z: float
) -> Point:
    """Rise by the height of a step, move, and come down again: over obstacles that are low enough."""
    up = sweep(world, bodies, surroundings, here, Point(0.0, CLIMB, 0.0))
    lifted = Point(here.x, here.y + CLIMB * up.fraction, here.z)
    there = slide(world, bodies, surroundings, lifted, Point(delta_x, 0.0, delta_z))
    ground = ground_at(world, there.x, there.z)
    if ground.height > there.y:
        return here
    down = sweep(world, bodies, surroundings, there, Point(0.0, here.y - there.y, 0.0))
    if down.fraction < 1.0 and down.n_y < COS_SLOPE_LIMIT:
        return here  # it would stand on something too steep
    return Point(there.x, max(ground.height, there.y + (here.y - there.y) * down.fraction), there.z)


@kernel
def _settle(world: World, bodies: Bodies, surroundings: Surroundings, at: Point) -> Point:
    """Put a body onto the ground, a floor or a step closely below it; or onto ground closely above it."""
    ground = ground_at(world, at.x, at.z).height
    if ground > at.y + LIFT:
        return at
    if ground > at.y:
        up = sweep(world, bodies, surroundings, at, Point(0.0, ground - at.y, 0.0))
        return Point(at.x, ground if up.fraction >= 1.0 else at.y + (ground - at.y) * up.fraction, at.z)
    drop = max(ground - at.y, -LIFT)
    down = sweep(world, bodies, surroundings, at, Point(0.0, drop, 0.0))
    if down.fraction < 1.0:
        return Point(at.x, at.y + drop * down.fraction, at.z)
    if ground < at.y - LIFT:
        return at  # nothing closely below: the body will fall
    return Point(at.x, ground, at.z)


@kernel
def _stands(world: World, bodies: Bodies, surroundings: Surroundings, at: Point) -> bool:
    """Return whether a body stands on something."""
    if at.y <= ground_at(world, at.x, at.z).height + TOUCHING:
        return True
    contact = sweep(world, bodies, surroundings, at, Point(0.0, -TOUCHING, 0.0))
    return contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT
