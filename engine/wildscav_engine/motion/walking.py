"""Walking: level, up and down slopes, steps and stairs; and sliding down what is too steep.

A body that is somewhere free is moved to somewhere free: each part of a move is swept, and where the ground
leaves no room, the whole way is taken back. So nothing is ever passed through.
"""

import numpy as np

from wildscav_engine.compilation.kernel import kernel
from wildscav_engine.geometry.sweep import SKIN
from wildscav_engine.geometry.terrain import Ground, ground_at, is_steep
from wildscav_engine.geometry.world import World
from wildscav_engine.motion.collision import (
    FARTHEST,
    TOUCHING,
    Around,
    Bodies,
    Moved,
    Point,
    inside_edges,
    look_around,
    slide,
    sweep,
)
from wildscav_engine.specs.body import COS_SLOPE_LIMIT, SLIDE_SPEED, STEP_HEIGHT, TAN_SLOPE_LIMIT
from wildscav_engine.specs.rules import FRAME

GAINED = 0.999  # of a way, what has come less far was held up
BURIED = 1e-9  # m below the ground that rounding may leave
# A body gets over what it is above, however little, and rests up to SKIN above what it stands on.
CLIMB = STEP_HEIGHT + SKIN  # m that a body lifts itself before a step
LIFT = STEP_HEIGHT + TOUCHING  # m that the ground may lift a body in one move, and that it may step down


@kernel
def walk(world: World, bodies: Bodies, here: Point, way_x: float, way_z: float) -> Moved:
    """Walk a way of up to 0.5 m over the ground or whatever a body stands on."""
    far = max(FARTHEST, np.sqrt(way_x * way_x + way_z * way_z))
    return walk_among(world, bodies, look_around(world, bodies, here, far), here, way_x, way_z)


@kernel
def walk_among(
    world: World, bodies: Bodies, around: Around, here: Point, way_x: float, way_z: float
) -> Moved:
    """Walk among the things that were found around."""
    way_x, way_z = _off_steep_ground(world, here, way_x, way_z)
    reached = here
    if way_x != 0.0 or way_z != 0.0:
        reached = _go(world, bodies, around, here, way_x, way_z)
    landed = _settle(world, bodies, around, reached)
    if not _is_allowed(world, here, landed):
        landed = _settle(world, bodies, around, here)
    on_ground = _stands(world, bodies, around, landed)
    return Moved(landed.x, landed.y, landed.z, 0.0, on_ground)


@kernel
def _go(world: World, bodies: Bodies, around: Around, here: Point, way_x: float, way_z: float) -> Point:
    """Go a way as far as it is free, over a step where that leads farther."""
    reached = slide(world, bodies, around, here, _over_ground(world, here, way_x, way_z))
    gain = _gain(here, reached, way_x, way_z)
    if gain < GAINED * (way_x * way_x + way_z * way_z):
        stepped = _step_up(world, bodies, around, here, way_x, way_z)
        if _gain(here, stepped, way_x, way_z) > gain + 1e-9:
            return stepped
    return reached


@kernel
def _gain(here: Point, there: Point, way_x: float, way_z: float) -> float:
    """Return how far a move has come along the wanted way (times its length)."""
    return (there.x - here.x) * way_x + (there.z - here.z) * way_z


@kernel
def _is_allowed(world: World, here: Point, there: Point) -> bool:
    """Return whether a walk may end at a place: not under the ground, nor up what nobody can walk up."""
    ground = ground_at(world, there.x, there.z)
    if there.y < ground.height - BURIED:
        return False  # no room between ground and ceiling
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
    """Return whether a body on the ground slides: it is too steep there, and leads down from there.

    At the bottom of a narrow gully it does not, though both sides are steep: there one stands.
    """
    if not (is_steep(ground) and here.y <= ground.height + TOUCHING):
        return False
    way_x, way_z = _downhill(ground)
    return ground_at(world, here.x + way_x, here.z + way_z).height < here.y - TOUCHING


@kernel
def _downhill(ground: Ground) -> tuple[float, float]:
    """Return the way in m that a body slides down steep ground in a frame."""
    steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
    far = SLIDE_SPEED * FRAME / steepness
    return -ground.slope_x * far, -ground.slope_z * far


@kernel
def _off_steep_ground(world: World, here: Point, way_x: float, way_z: float) -> tuple[float, float]:
    """Let a body that stands on ground too steep slide downhill; it may steer, but not hold on."""
    ground = ground_at(world, here.x, here.z)
    if not is_sliding(world, here, ground):
        return way_x, way_z
    steep = ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z
    uphill = max(0.0, (way_x * ground.slope_x + way_z * ground.slope_z) / steep)
    down_x, down_z = _downhill(ground)
    way_x, way_z = way_x - ground.slope_x * uphill + down_x, way_z - ground.slope_z * uphill + down_z
    share = FARTHEST / max(FARTHEST, np.sqrt(way_x * way_x + way_z * way_z))
    inside = inside_edges(world, here, Point(way_x * share, 0.0, way_z * share))
    return inside.x, inside.z


@kernel
def _over_ground(world: World, here: Point, way_x: float, way_z: float) -> Point:
    """Return a way that rises with the ground; none into ground too steep to walk up."""
    ground = ground_at(world, here.x + way_x, here.z + way_z)
    rise = ground.height - here.y
    if rise <= 0.0:
        return Point(way_x, 0.0, way_z)
    if is_steep(ground):
        steepness = np.sqrt(ground.slope_x * ground.slope_x + ground.slope_z * ground.slope_z)
        up_x, up_z = ground.slope_x / steepness, ground.slope_z / steepness
        uphill = way_x * up_x + way_z * up_z
        if uphill > 0.0:
            level = inside_edges(world, here, Point(way_x - up_x * uphill, 0.0, way_z - up_z * uphill))
            way_x, way_z = level.x, level.z
            rise = ground_at(world, here.x + way_x, here.z + way_z).height - here.y
            if rise > TAN_SLOPE_LIMIT * np.sqrt(way_x * way_x + way_z * way_z):
                return Point(0.0, 0.0, 0.0)
    if rise > LIFT:
        return Point(0.0, 0.0, 0.0)
    return Point(way_x, max(0.0, rise), way_z)


@kernel
def _step_up(world: World, bodies: Bodies, around: Around, here: Point, way_x: float, way_z: float) -> Point:
    """Go up by the height of a step, then along the way: over what is low enough."""
    up = sweep(world, bodies, around, here, Point(0.0, CLIMB, 0.0))
    lifted = Point(here.x, here.y + CLIMB * up.fraction, here.z)
    there = slide(world, bodies, around, lifted, Point(way_x, 0.0, way_z))
    ground = ground_at(world, there.x, there.z)
    if ground.height > there.y:
        return here
    down = sweep(world, bodies, around, there, Point(0.0, here.y - there.y, 0.0))
    if down.fraction < 1.0 and down.n_y < COS_SLOPE_LIMIT:
        return here  # it would stand on something too steep
    return Point(there.x, max(ground.height, there.y + (here.y - there.y) * down.fraction), there.z)


@kernel
def _settle(world: World, bodies: Bodies, around: Around, at: Point) -> Point:
    """Put a body onto the ground, a floor or a step that is near below (or above, for the ground)."""
    ground = ground_at(world, at.x, at.z).height
    if ground > at.y + LIFT:
        return at
    if ground > at.y:
        up = sweep(world, bodies, around, at, Point(0.0, ground - at.y, 0.0))
        return Point(at.x, ground if up.fraction >= 1.0 else at.y + (ground - at.y) * up.fraction, at.z)
    drop = max(ground - at.y, -LIFT)
    down = sweep(world, bodies, around, at, Point(0.0, drop, 0.0))
    if down.fraction < 1.0:
        return Point(at.x, at.y + drop * down.fraction, at.z)
    if ground < at.y - LIFT:
        return at  # nothing near below: it will fall
    return Point(at.x, ground, at.z)


@kernel
def _stands(world: World, bodies: Bodies, around: Around, at: Point) -> bool:
    """Return whether there is something right below a body."""
    if at.y <= ground_at(world, at.x, at.z).height + TOUCHING:
        return True
    contact = sweep(world, bodies, around, at, Point(0.0, -TOUCHING, 0.0))
    return contact.fraction < 1.0 and contact.n_y >= COS_SLOPE_LIMIT
