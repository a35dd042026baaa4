"""One step of a match: all rules in the order in which they apply."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.arithmetic.elementary_functions import cosine, sine, wrap
from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.geometry.terrain import water_at
from wildscav_engine.motion.body_motion import move_by
from wildscav_engine.motion.collision import Bodies
from wildscav_engine.simulation.digest import digest_boxes, digest_step
from wildscav_engine.simulation.robots.base import Situation
from wildscav_engine.simulation.robots.decide import decide
from wildscav_engine.simulation.robots.skill import skill_of
from wildscav_engine.simulation.state import NOBODY, Agents, Game
from wildscav_engine.simulation.systems.agent_grid import index_agents, others_near
from wildscav_engine.simulation.systems.aim import turn_of
from wildscav_engine.simulation.systems.damage import apply_damage, equip, respawn_agents
from wildscav_engine.simulation.systems.elimination import rank_teams
from wildscav_engine.simulation.systems.endings import (
    end_at_last_standing,
    end_at_supply_goal,
    end_at_target,
    end_at_time_limit,
)
from wildscav_engine.simulation.systems.supplies import index_boxes, pick_up
from wildscav_engine.simulation.systems.turn_order import draw_turns
from wildscav_engine.simulation.systems.visibility import Seen, find_seen
from wildscav_engine.simulation.systems.weapons import handle_weapons, shoot
from wildscav_engine.simulation.systems.zone import damage_outside_zone
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED, Field
from wildscav_engine.specs.rules import FRAME


@inlined_kernel
def play_step(game: Game, actions: NDArray[np.float32], frames_per_action: int, is_reset: bool) -> None:
    """Play one step of one match in place: one action of every agent, held for several frames.

    A reset begins the match instead of playing: it equips the agents and indexes the boxes.
    """
    matches, match = game.matches, game.match
    if is_reset:
        _begin(game)
        return
    for _ in range(frames_per_action):
        if not matches.over[match]:
            play_frame(game, actions)
    matches.step[match] += 1
    matches.digest[match] = digest_step(matches.digest[match], game.agents, actions, matches.frame[match])


@inlined_kernel
def resolve_actions(agents: Agents, actions: NDArray[np.float32], allowed: NDArray[np.bool_]) -> None:
    """Replace (A, FIELDS) actions of a match without robots by those played: invalid rows do nothing."""
    _clear_events(agents)
    for seat in range(actions.shape[0]):
        _resolve_action(agents, seat, allowed, actions[seat])


@inlined_kernel
def let_robots_decide(
    game: Game, seen: Seen, actions: NDArray[np.float32], allowed: NDArray[np.bool_], frames_per_action: int
) -> None:
    """Do the same as ``resolve_actions`` with robots, whose rows are replaced by what they decide.

    Robots decide in the order of the seats, and see which way the agents before them are going to walk. Only
    their rows of what is seen are updated, before they decide.
    """
    agents, matches, match, rules = game.agents, game.matches, game.match, game.rules
    _update_seen_of_robots(game, seen)
    _clear_events(agents)
    for seat in range(actions.shape[0]):
        action = actions[seat]
        if agents.robot[seat] != 0:
            for field in range(FIELDS):
                action[field] = 0.0
            if agents.health[seat] > 0:
                frame, seed = matches.frame[match], matches.seed[match]
                skill = skill_of(agents.robot[seat])
                situation = Situation(
                    agents,
                    game.supplies,
                    seen,
                    seat,
                    seed,
                    frame,
                    frames_per_action,
                    matches,
                    match,
                    skill,
                    game.world,
                    rules.spread,
                    rules.walking_sway,
                )
                decide(situation, action)
        _resolve_action(agents, seat, allowed, action)


@inlined_kernel
def play_frame(game: Game, actions: NDArray[np.float32]) -> None:
    """Play one frame in place. The order of the calls is part of the rules."""
    agents, matches, match = game.agents, game.matches, game.match
    draw_turns(matches.seed[match], matches.frame[match], agents.turns)
    # Collisions and shots of the whole frame use the present positions.
    index_agents(game)
    # Timers run from the next frame on: an agent that dies now waits for the whole respawn time.
    respawn_agents(game)
    for turn in range(agents.turns.shape[0]):
        _turn_and_move(game, agents.turns[turn], actions)
    matches.frame[match] += 1
    # The target is tested in every frame, so that no agent runs through it between two steps.
    end_at_target(game)
    pick_up(game, actions)
    end_at_supply_goal(agents, matches, match)
    handle_weapons(agents, actions, game.rules)
    # All agents have moved before the first shot, so being first is no advantage.
    shoot(game, actions)
    # Damage takes effect after the last shot: two agents can kill each other in one frame.
    damage_outside_zone(agents, matches, match)
    apply_damage(game)
    # After all deaths of the frame, because teams eliminated together share a placement.
    rank_teams(agents, matches, match)
    end_at_last_standing(matches, match)
    end_at_time_limit(matches, match)


@kernel
def _begin(game: Game) -> None:
    agents, matches, match = game.agents, game.matches, game.match
    for seat in range(agents.health.shape[0]):
        if agents.present[seat]:
            equip(agents, seat)
    index_boxes(game.world, game.supplies, matches, match)
    matches.digest[match] = digest_boxes(matches.digest[match], game.supplies)


@inlined_kernel
def _update_seen_of_robots(game: Game, seen: Seen) -> None:
    agents, is_indexed = game.agents, False
    for seat in range(agents.robot.shape[0]):
        if agents.robot[seat] == 0 or agents.health[seat] <= 0:
            continue
        if not is_indexed:
            index_agents(game)
            is_indexed = True
        find_seen(game, seat, seen)


@inlined_kernel
def _clear_events(agents: Agents) -> None:
    for seat in range(agents.fired.shape[0]):
        agents.fired[seat] = False
        agents.hit_seat[seat] = NOBODY
        agents.hit_by_seat[seat] = NOBODY
        agents.gained[seat] = 0


@inlined_kernel
def _resolve_action(
    agents: Agents, seat: int, allowed: NDArray[np.bool_], action: NDArray[np.float32]
) -> None:
    """Replace an action row by its valid part, which is played."""
    valid = agents.present[seat]
    for field in range(FIELDS):
        if not allowed[field]:
            action[field] = 0.0
        valid = valid and np.isfinite(action[field])
    if not (valid and 0.0 <= action[Field.WALK_SPEED] <= MAX_WALK_SPEED):
        for field in range(FIELDS):
            action[field] = 0.0
    direction, speed = np.float64(action[Field.WALK_DIRECTION]), np.float64(action[Field.WALK_SPEED])
    agents.walk_velocity[seat, 0] = speed * sine(direction)
    agents.walk_velocity[seat, 1] = speed * cosine(direction)


@inlined_kernel
def _turn_and_move(game: Game, seat: int, actions: NDArray[np.float32]) -> None:
    """Turn the view of one agent, then move its body."""
    world, agents = game.world, game.agents
    if agents.health[seat] <= 0:
        return
    action = actions[seat]
    turn, look = turn_of(action, game.rules)
    agents.yaw[seat] = wrap(agents.yaw[seat] + turn)
    agents.pitch[seat] = min(90.0, max(-90.0, agents.pitch[seat] + look))
    position = agents.position[seat]
    others = agents.near[: others_near(game, seat)]
    moved = move_by(
        world,
        Bodies(agents.position, others, seat),
        agents.velocity[seat, 1],
        agents.on_ground[seat],
        agents.walk_velocity[seat, 0],
        agents.walk_velocity[seat, 1],
        action[Field.JUMP] != 0.0,
        game.rules.water_speed_factor,
    )
    dx, dz = moved.x - position[0], moved.z - position[2]
    agents.walked[seat] += np.sqrt(dx * dx + dz * dz)
    agents.velocity[seat, 0] = dx / FRAME
    agents.velocity[seat, 1] = moved.rise
    agents.velocity[seat, 2] = dz / FRAME
    position[0], position[1], position[2] = moved.x, moved.y, moved.z
    agents.on_ground[seat] = moved.on_ground
    agents.in_water[seat] = moved.y < water_at(world, moved.x, moved.z)
