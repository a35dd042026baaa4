"""The weapon: one shot is one ray from the eye, stopped by the world and by the first body."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.actions import Field
from wildscav_engine.body import BODY_HEIGHT, BODY_RADIUS, EYE_HEIGHT
from wildscav_engine.geometry.rays import cast_ray
from wildscav_engine.geometry.world import World
from wildscav_engine.kernel import kernel
from wildscav_engine.rules import Rules, frames
from wildscav_engine.state import NOBODY, Agents
from wildscav_engine.systems.turns import Turns, seat_at
from wildscav_engine.trig import cosine, sine


@kernel
def handle_weapon(agents: Agents, seat: int, reload: bool, rules: Rules) -> None:
    """Let the weapon of one agent cool down, and start or finish a reload.

    A reload moves as many spare rounds into the clip as fit when it is done; until then the weapon is silent.
    """
    agents.fire_left[seat] = max(0, agents.fire_left[seat] - 1)
    if agents.reload_left[seat] > 0:
        agents.reload_left[seat] -= 1
        if agents.reload_left[seat] == 0:
            moved = min(rules.clip_size - agents.clip[seat], agents.spare_ammo[seat])
            agents.clip[seat] += moved
            agents.spare_ammo[seat] -= moved
    elif reload and agents.clip[seat] < rules.clip_size and agents.spare_ammo[seat] > 0:
        agents.reload_left[seat] = frames(rules.reload_time)


@kernel
def shoot(world: World, agents: Agents, actions: NDArray[np.float32], turns: Turns, rules: Rules) -> None:
    """Fire the weapons of all agents that shoot in this frame.

    Nobody is hurt yet, the damage is only noted: two agents can kill each other in one frame.

    Args:
        world: The static world.
        agents: The agents of the match.
        actions: (A, FIELDS).
        turns: The frame's order; of several hits on one agent, the last counts as who hit it.
        rules: The rules.
    """
    for turn in range(turns.seats):
        seat = seat_at(turns, turn)
        if agents.health[seat] <= 0 or actions[seat, Field.SHOOT] == 0.0:
            continue
        if agents.clip[seat] <= 0 or agents.fire_left[seat] > 0 or agents.reload_left[seat] > 0:
            continue
        agents.clip[seat] -= 1
        agents.fire_left[seat] = frames(rules.fire_interval)
        agents.fired[seat] = True
        agents.shots[seat] += 1
        victim = _hit_by_shot(world, agents, seat, rules.bullet_range)
        if victim != NOBODY and agents.team[victim] != agents.team[seat]:
            agents.hits[seat] += 1
            agents.hit_seat[seat] = victim
            agents.hit_by_seat[victim] = seat
            if agents.invincible_left[victim] == 0:
                agents.damage[victim] += rules.shot_damage


@kernel
def _hit_by_shot(world: World, agents: Agents, shooter: int, bullet_range: float) -> int:
    """Return whose body a shot hits, or NOBODY, and note where the shot ends."""
    eye_x = agents.position[shooter, 0]
    eye_y = agents.position[shooter, 1] + EYE_HEIGHT
    eye_z = agents.position[shooter, 2]
    level = cosine(agents.pitch[shooter])
    dx = sine(agents.yaw[shooter]) * level
    dy = -sine(agents.pitch[shooter])
    dz = cosine(agents.yaw[shooter]) * level
    nearest = min(bullet_range, cast_ray(world, eye_x, eye_y, eye_z, dx, dy, dz, bullet_range).distance)
    victim = NOBODY
    for other in range(agents.health.shape[0]):
        if other == shooter or agents.health[other] <= 0:
            continue
        distance = meet_body(
            eye_x - agents.position[other, 0],
            eye_y - agents.position[other, 1],
            eye_z - agents.position[other, 2],
            dx,
            dy,
            dz,
        )
        if distance < nearest:
            nearest, victim = distance, other
    agents.shot_end[shooter, 0] = eye_x + dx * nearest
    agents.shot_end[shooter, 1] = eye_y + dy * nearest
    agents.shot_end[shooter, 2] = eye_z + dz * nearest
    return victim


@kernel
def meet_body(x: float, y: float, z: float, dx: float, dy: float, dz: float) -> float:
    """Return the distance in m at which a ray meets a body; 0 from inside it, inf if it misses.

    Args:
        x: m from the middle of the body's soles to the ray's start; so y and z.
        y: m.
        z: m.
        dx: Unit vector of the ray's direction; so dy and dz.
        dy: See dx.
        dz: See dx.
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
