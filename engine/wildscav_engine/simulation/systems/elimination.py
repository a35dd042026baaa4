"""Death for good: who is out of a match where nobody comes back, and which place its team takes."""

from wildscav_engine.compilation.kernel import inlined_kernel, kernel
from wildscav_engine.simulation.state import NOT_OUT, Agents, Matches


@kernel
def eliminate(agents: Agents, matches: Matches, match: int, seat: int) -> None:
    """Take a seat out of the match, and its team with the last of its seats."""
    team = agents.team[seat]
    agents.eliminated[seat] = matches.frame[match]
    matches.members_left[match, team] -= 1
    if matches.members_left[match, team] == 0:
        matches.teams_left[match] -= 1


@inlined_kernel
def rank_teams(agents: Agents, matches: Matches, match: int) -> None:
    """Give the teams that went out in this frame their placement: one more than there are teams left."""
    if matches.respawns[match]:
        return
    for seat in range(agents.team.shape[0]):
        out = agents.eliminated[seat] != NOT_OUT and matches.members_left[match, agents.team[seat]] == 0
        if out and agents.placement[seat] == 0:
            agents.placement[seat] = matches.teams_left[match] + 1


@kernel
def placement_now(placement: int, teams_left: int, over: bool) -> int:
    """Return the place of a team as it stands, for scores and rewards alike.

    Teams that share a place share the best of it. So all that are left when the match is over are first.
    Until then, a team that is still in has outlived those that are out, and no more.

    Args:
        placement: With which it went out, 0 if it is still in.
        teams_left: How many are in.
        over: Whether the match is.
    """
    if placement != 0:
        return placement
    return 1 if over else max(1, teams_left)
