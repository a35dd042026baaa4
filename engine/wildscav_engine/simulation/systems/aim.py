"""What limits aiming: how fast a view turns, how far off shots are, and how far each one raises the view.

Spread and recoil grow with what a body does: both are multiplied by its sway, which is 1 for a body that
stands still and looks ahead. With the rules of the original game, none of this has any effect.
"""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine, wrap
from wildscav_engine.arithmetic.random_numbers import Stream, philox, to_unit
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import Agents
from wildscav_engine.specs.actions import MAX_WALK_SPEED, Field
from wildscav_engine.specs.rules import AT_ONCE, FRAME, Rules

SWAY_TURN = 100.0  # degrees/s, the turn to which ``turning_sway`` refers
SIDEWAYS = 0.5  # of the recoil: how far it turns the view to either side at most


@inlined_kernel
def turn_of(action: NDArray[np.float32], rules: Rules) -> tuple[float, float]:
    """Return by how much a body turns and looks down in this frame, in degrees."""
    turn, look = np.float64(action[Field.TURN]), np.float64(action[Field.LOOK])
    if rules.turn_speed >= AT_ONCE:
        return turn, look
    limit = rules.turn_speed * FRAME
    return min(limit, max(-limit, wrap(turn))), min(limit, max(-limit, look))


@inlined_kernel
def sway_of(agents: Agents, seat: int, action: NDArray[np.float32], rules: Rules) -> float:
    """Return by what factor a body's motion in this frame multiplies spread and recoil, at least 1.

    Turns count as far as the view has moved: neither whole turns, nor looking beyond the zenith.
    """
    east, north = agents.velocity[seat, 0], agents.velocity[seat, 2]
    walking = np.sqrt(east * east + north * north) / MAX_WALK_SPEED
    turn, look = turn_of(action, rules)
    turn, look = wrap(turn), look if abs(agents.pitch[seat]) < 90.0 else 0.0
    turning = np.sqrt(turn * turn + look * look) / FRAME / SWAY_TURN
    return float(1.0 + rules.walking_sway * walking + rules.turning_sway * turning)


@kernel
def direction_of_shot(
    yaw: float, pitch: float, spread: float, seed: int, frame: int, seat: int
) -> tuple[float, float, float]:
    """Return the unit vector of a shot along a view in degrees, or off it at random by ``spread`` at most.

    The shots of a still body fall evenly on a disc around the point that it aims at.
    """
    level = cosine(pitch)
    ahead = sine(yaw) * level, -sine(pitch), cosine(yaw) * level
    if spread == 0.0:
        return ahead
    first, second = philox(seed, Stream.SPREAD, frame, seat, 0)
    off, around = min(90.0, spread) * np.sqrt(to_unit(first)), 360.0 * to_unit(second)
    right, up, along = sine(off) * sine(around), sine(off) * cosine(around), cosine(off)
    x = along * ahead[0] + right * cosine(yaw) + up * sine(yaw) * sine(pitch)
    y = along * ahead[1] + up * level
    z = along * ahead[2] - right * sine(yaw) + up * cosine(yaw) * sine(pitch)
    return x, y, z


@inlined_kernel
def kick(agents: Agents, seat: int, recoil: float, seed: int, frame: int) -> None:
    """Raise the view of a seat that has shot by ``recoil`` degrees, and turn it a little to a random side."""
    if recoil == 0.0:
        return
    side = 2.0 * to_unit(philox(seed, Stream.SPREAD, frame, seat, 1)[0]) - 1.0
    agents.pitch[seat] = max(-90.0, agents.pitch[seat] - recoil)
    agents.yaw[seat] = wrap(agents.yaw[seat] + SIDEWAYS * recoil * side)
