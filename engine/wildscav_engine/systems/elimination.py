"""Death for good: who is out of a match where nobody comes back, and which place its team takes."""

from wildscav_engine.kernel import inlined_kernel, kernel
from wildscav_engine.state import NOT_OUT, Agents, Matches


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
