"""The rules of a match, as text."""

from wildscav.agent import MatchInfo

GOALS = {
    "navigation": "Reach the target as fast as you can: within {target:g} m of it.",
    "gathering": "Carry as many supplies as you can when the time is up.",
    "capture": "Find the hidden target with your team, and reach it: within {target:g} m of it.",
    "battle": "Carry as many supplies as you can when the time is up. Who dies drops a share of them.",
    "royale": "Be the last team alive, inside the shrinking safe zone. Who dies is out.",
}


def rules(match: MatchInfo) -> str:
    """Return the rules of a match."""
    goal = GOALS.get(match.track, "Play by what the texts tell.").format(target=match.target_distance)
    lines = [
        f"This is a match of {match.track}: you have seat {match.seat} of {match.seats}, team {match.team}.",
        goal,
        f"It lasts {match.time_limit:g} s at most. The map has sides of {match.map_size:g} m.",
        "Bearings are compass degrees: 0 is north, 90 is east.",
        "Hours of the clock are relative to your view: 12 is ahead, 3 is to the right.",
        "Each call of a tool plays game time until it ends. A bad call costs 0.5 s.",
    ]
    return "\n".join(lines)
