"""The rules of a match, as text."""

from wildscav.agent import MatchInfo
from wildscav_language.body import UNARMED, WITHOUT_SUPPLIES
from wildscav_language.player import REFUSAL_TIME

GOALS = {
    "navigation": "Reach the target as fast as you can: within {target:g} m of it.",
    "gathering": "Carry as many supplies as you can when the time is up.",
    "capture": "Find the hidden target with your team, and reach it: within {target:g} m of it.",
    "battle": "Carry as many supplies as you can when the time is up. Whoever dies drops a share of them.",
    "royale": "Be the last team alive, inside the shrinking safe zone. Whoever dies is out.",
}
STANDS_STILL = "The world stands still between calls."
BETWEEN_CALLS = {
    "running": "The world goes on between calls, and you walk on as you last walked.",
    "tokens": f"{STANDS_STILL} Then each token that you write costs {{token:g}} s, in which you walk on.",
}
CALLS = " A call of a tool plays game time until the tool ends."
SENSES = {
    "original": "You are told of agents in view, with their health and velocity, and of all boxes within "
    "{sight:g} m, even behind walls.",
    "sighted": "You are told of agents and boxes in view. Boxes are seen within {sight:g} m, so look around.",
    "pixels": "You are told neither of agents nor of boxes: only pictures show them.",
}


def rules(match: MatchInfo) -> str:
    """Return the rules of a match."""
    goal = GOALS.get(match.track, "Play by what the texts tell.").format(target=match.target_distance)
    lines = [
        f"This is a match of {match.track}. You have seat {match.seat}; there are {match.seats} seats.",
        f"Your team is {match.team}. {goal}",
        f"It lasts {match.time_limit:g} s at most. The map has sides of {match.map_size:g} m.",
        "Bearings are compass degrees: 0 is north, 90 is east.",
        "Hours of the clock are relative to your view: 12 is ahead, 3 is to the right.",
        "You walk and run at up to 10 m/s, half as fast in water, and up steps of 0.5 m.",
        BETWEEN_CALLS.get(match.clock, STANDS_STILL).format(token=match.token_time) + CALLS,
        f"A bad call costs {REFUSAL_TIME:g} s, in which you stand still.",
        SENSES[match.senses].format(sight=match.supply_sight),
    ]
    lines += [] if match.track in WITHOUT_SUPPLIES else _of_supplies(match)
    lines += [] if match.track in UNARMED else _of_weapons(match)
    return "\n".join(lines)


def _of_supplies(match: MatchInfo) -> list[str]:
    lines = [f"Boxes of supplies are picked up within {match.pick_up_distance:g} m, while you walk past."]
    if match.supply_goal:
        lines.append(f"The first team that carries {match.supply_goal} supplies ends the match.")
    if len(match.supply_waves) > 1:
        lines.append("More supplies appear in waves, whose times and places are told before.")
    return lines


def _of_weapons(match: MatchInfo) -> list[str]:
    lines = [
        f"You have {match.start_health} health. Your clip holds {match.clip_size} rounds.",
        "You do not shoot, since you cannot tell where others are."
        if match.senses == "pixels"
        else "You shoot at enemies in sight while you do other things, unless you hold your fire.",
    ]
    if match.bounty:
        lines.append(f"A kill brings {match.bounty} supplies.")
    if match.respawns:
        lines.append("The dead come back after a while, with full health.")
    return lines
