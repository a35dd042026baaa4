"""Elimination from matches without respawns, and the placement of teams."""

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import NOT_ELIMINATED, Agents, Matches


@kernel
def eliminate(agents: Agents, matches: Matches, match: int, seat: int) -> None:
    """Eliminate a seat, and its team if it was the last seat of the team."""
    team = agents.team[seat]
    agents.eliminated[seat] = matches.frame[match]
    matches.members_left[match, team] -= 1
    if matches.members_left[match, team] == 0:
        matches.teams_left[match] -= 1


@inlined_kernel
def rank_teams(agents: Agents, matches: Matches, match: int) -> None:
    """Write the placement of teams eliminated in this frame: one more than the number of teams left."""
    if matches.respawns[match]:
        return
    for seat in range(agents.team.shape[0]):
        out = (
            agents.eliminated[seat] != NOT_ELIMINATED and matches.members_left[match, agents.team[seat]] == 0
        )
        if out and agents.placement[seat] == 0:
            agents.placement[seat] = matches.teams_left[match] + 1


@kernel
def current_placement(placement: int, teams_left: int, over: bool) -> int:
    """Return the current placement of a team; ``placement`` is its final one, 0 while it is left.

    Teams that share a placement get the best one of theirs. All teams left when the match is over are
    therefore first. Until then, a team that is left is ranked directly before those that are eliminated.
    """
    if placement != 0:
        return placement
    return 1 if over else max(1, teams_left)
