"""The ends of a match: target reached, enough supplies, one team left, or time up."""

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import NOBODY, Agents, Ending, Game, Matches
from wildscav_engine.simulation.systems.supplies import team_supplies

TIME_UP, GOAL, LAST_STANDING = int(Ending.TIME_UP), int(Ending.GOAL), int(Ending.LAST_STANDING)


@inlined_kernel
def end(matches: Matches, match: int, ending: int) -> None:
    """End a match; only the first reason counts."""
    if not matches.over[match]:
        matches.over[match] = True
        matches.ending[match] = ending


@inlined_kernel
def end_at_target(game: Game) -> None:
    """End the match when agents are at the target (3D distance from the soles). All of them have reached it.

    An agent that comes near a hidden target finds it for its whole team.
    """
    agents, matches, match, rules = game.agents, game.matches, game.match, game.rules
    if not matches.has_target[match]:
        return
    target, reach = matches.target[match], rules.target_distance
    for turn in range(agents.turns.shape[0]):
        seat = agents.turns[turn]
        if agents.health[seat] <= 0:
            continue
        dx = agents.position[seat, 0] - target[0]
        dy = agents.position[seat, 1] - target[1]
        dz = agents.position[seat, 2] - target[2]
        distance = dx * dx + dy * dy + dz * dz
        if not agents.knows_target[seat] and distance <= rules.target_sight * rules.target_sight:
            _reveal_to_team(agents, agents.team[seat])
        if distance <= reach * reach:
            agents.reached[seat] = True
            end(matches, match, GOAL)
            if matches.reached_by[match] == NOBODY:
                matches.reached_by[match] = seat


@kernel
def _reveal_to_team(agents: Agents, team: int) -> None:
    for seat in range(agents.team.shape[0]):
        if agents.team[seat] == team:
            agents.knows_target[seat] = True


@inlined_kernel
def end_at_supply_goal(agents: Agents, matches: Matches, match: int) -> None:
    """End the match when a team carries as many supplies as the goal."""
    goal = matches.supply_goal[match]
    if goal == 0:
        return
    for seat in range(agents.team.shape[0]):
        # Only an agent that picked up supplies in this step can have brought its team to the goal.
        if agents.gained[seat] > 0 and team_supplies(agents.team, agents.supplies, agents.team[seat]) >= goal:
            end(matches, match, GOAL)
            return


@inlined_kernel
def end_at_last_standing(matches: Matches, match: int) -> None:
    """End a match when one of several teams is left, or none; a single team plays until it is eliminated."""
    left = matches.teams_left[match]
    if left == 0 or (left == 1 and matches.teams[match] > 1 and not matches.respawns[match]):
        end(matches, match, LAST_STANDING)


@inlined_kernel
def end_at_time_limit(matches: Matches, match: int) -> None:
    """End the match when its time is up."""
    if matches.frame[match] >= matches.frame_limit[match]:
        end(matches, match, TIME_UP)
