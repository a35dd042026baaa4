"""Weapons: a shot is a ray from the eye, which the world and the first body stop."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.linked_grid import columns_along, row_of
from wildscav_engine.geometry.rays import raycast
from wildscav_engine.simulation.state import NOBODY, Agents, Game
from wildscav_engine.simulation.systems.agent_grid import LAG, AgentGrid, agent_grid_of
from wildscav_engine.simulation.systems.aim import direction_of_shot, kick, sway_of
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.specs.rules import Rules, frames


@kernel
def load_weapons(agents: Agents, seat: int) -> None:
    """Give an agent the weapons and the ammunition that it is equipped with."""
    agents.clip[seat] = agents.clip_size[seat]
    agents.spare_ammo[seat] = agents.full_spare_ammo[seat]
    agents.reload_left[seat] = 0
    agents.fire_left[seat] = 0


@inlined_kernel
def handle_weapons(agents: Agents, actions: NDArray[np.float32], rules: Rules) -> None:
    """Count down the weapons of living agents, and start or finish reloads.

    A finished reload moves as many spare rounds into the clip as fit. Until then, the weapon cannot fire. A
    reload starts whenever it is requested and the clip is not full, so an agent that always shoots and
    reloads fires one round between two reloads.
    """
    for seat in range(agents.health.shape[0]):
        if agents.health[seat] <= 0:
            continue
        agents.fire_left[seat] = max(0, agents.fire_left[seat] - 1)
        if agents.reload_left[seat] > 0:
            agents.reload_left[seat] -= 1
            if agents.reload_left[seat] == 0:
                moved = min(agents.clip_size[seat] - agents.clip[seat], agents.spare_ammo[seat])
                agents.clip[seat] += moved
                agents.spare_ammo[seat] -= moved
        elif actions[seat, Field.RELOAD] != 0.0 and _can_reload(agents, seat):
            agents.reload_left[seat] = frames(rules.reload_time)


@inlined_kernel
def _can_reload(agents: Agents, seat: int) -> bool:
    return bool(agents.clip[seat] < agents.clip_size[seat] and agents.spare_ammo[seat] > 0)


@inlined_kernel
def shoot(game: Game, actions: NDArray[np.float32]) -> None:
    """Fire the weapons of all agents that shoot in this frame.

    Damage is only added up here, so two agents can kill each other in one frame. Of several agents that hit
    the same one, the last in the order of the frame counts as the one that hit it.
    """
    agents = game.agents
    for turn in range(agents.turns.shape[0]):
        seat = agents.turns[turn]
        if actions[seat, Field.SHOOT] != 0.0 and can_fire(agents, seat):
            _fire(game, seat, sway_of(agents, seat, actions[seat], game.rules))


@inlined_kernel
def can_fire(agents: Agents, seat: int) -> bool:
    """Return whether an agent is alive and its weapon is loaded, ready and not being reloaded."""
    ready = agents.fire_left[seat] == 0 and agents.reload_left[seat] == 0
    return bool(ready and agents.clip[seat] > 0 and agents.health[seat] > 0)


@kernel
def _fire(game: Game, seat: int, sway: float) -> None:
    agents, rules = game.agents, game.rules
    agents.clip[seat] -= 1
    agents.fire_left[seat] = frames(rules.fire_interval)
    agents.fired[seat] = True
    agents.shots[seat] += 1
    seed, frame = game.matches.seed[game.match], game.matches.frame[game.match]
    spread = rules.spread * sway
    direction = direction_of_shot(agents.yaw[seat], agents.pitch[seat], spread, seed, frame, seat)
    victim = _hit_by_shot(game, seat, direction)
    kick(agents, seat, rules.recoil * sway, seed, frame)
    if victim != NOBODY and agents.team[victim] != agents.team[seat]:
        agents.hits[seat] += 1
        agents.hit_seat[seat] = victim
        agents.hit_by_seat[victim] = seat
        if agents.invincible_left[victim] == 0:
            agents.damage[victim] += agents.shot_damage[seat]


@inlined_kernel
def _hit_by_shot(game: Game, shooter: int, direction: tuple[float, float, float]) -> int:
    """Return the seat that a shot hits, or NOBODY, and write where the shot ends."""
    agents, bullet_range = game.agents, game.rules.bullet_range
    eye_x = agents.position[shooter, 0]
    eye_y = agents.position[shooter, 1] + EYE_HEIGHT
    eye_z = agents.position[shooter, 2]
    dx, dy, dz = direction
    far = min(bullet_range, raycast(game.world, eye_x, eye_y, eye_z, dx, dy, dz, bullet_range).distance)
    distance, victim = first_body(agents, agent_grid_of(game), shooter, (eye_x, eye_y, eye_z), direction, far)
    agents.shot_end[shooter, 0] = eye_x + dx * distance
    agents.shot_end[shooter, 1] = eye_y + dy * distance
    agents.shot_end[shooter, 2] = eye_z + dz * distance
    return victim


@inlined_kernel
def first_body(
    agents: Agents,
    grid: AgentGrid,
    shooter: int,
    eye: tuple[float, float, float],
    direction: tuple[float, float, float],
    far: float,
) -> tuple[float, int]:
    """Return the distance in m and the seat of the first living body on a ray; ``far`` and NOBODY if none.

    Of bodies at the same distance, that of the first seat counts; the shooter's is ignored. The direction is
    a unit vector.
    """
    squares, reach = grid.squares, BODY_RADIUS + LAG
    x, y, z = eye
    dx, dy, dz = direction
    nearest, victim = far, NOBODY
    for row in range(
        row_of(squares, min(z, z + dz * far) - reach), row_of(squares, max(z, z + dz * far) + reach) + 1
    ):
        first, last = columns_along(squares, row, x, z, dx * far, dz * far, reach)
        for column in range(first, last + 1):
            other = grid.heads[row * squares.side + column] - 1
            while other >= 0:
                if other != shooter and agents.health[other] > 0:
                    soles = agents.position[other]
                    distance = meet_body(x - soles[0], y - soles[1], z - soles[2], dx, dy, dz)
                    if distance < nearest or (distance == nearest and victim > other):
                        nearest, victim = distance, other
                other = grid.links[other] - 1
    return nearest, victim


@kernel
def meet_body(x: float, y: float, z: float, dx: float, dy: float, dz: float) -> float:
    """Return the distance in m at which a ray meets a body; 0 from inside it, inf if it misses.

    It starts at x, y, z m from the point between the body's soles; dx, dy, dz are the unit vector of its
    direction.
    """
    enter, leave = 0.0, np.inf
    if dy != 0.0:
        first, second = -y / dy, (BODY_HEIGHT - y) / dy
        enter, leave = max(enter, min(first, second)), min(leave, max(first, second))
    elif y < 0.0 or y > BODY_HEIGHT:
        return np.inf
    across = dx * dx + dz * dz
    apart = x * x + z * z - BODY_RADIUS * BODY_RADIUS
    if across == 0.0:
        return enter if apart <= 0.0 and enter <= leave else np.inf
    toward = x * dx + z * dz
    root = toward * toward - across * apart
    if root < 0.0:
        return np.inf
    half = np.sqrt(root)
    enter, leave = max(enter, (-toward - half) / across), min(leave, (-toward + half) / across)
    return enter if enter <= leave else np.inf
