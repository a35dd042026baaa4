"""The tools of seats of words: each plays many steps, and ends early with a reason."""

from wildscav.agent import MatchInfo
from wildscav_language.calls import Tool
from wildscav_language.tools.fighting import ATTACK, FOLLOW, HOLD_FIRE, RELOAD, TAKE_COVER
from wildscav_language.tools.looking import LOOK_AROUND, TURN, WAIT_UNTIL
from wildscav_language.tools.walking import EXPLORE, GO, PICK_UP

WITHOUT_SUPPLIES = ("navigation", "capture")  # tracks in which nobody picks anything up
UNARMED = (*WITHOUT_SUPPLIES, "gathering")  # tracks in which nobody shoots


def tools_of(match: MatchInfo) -> tuple[Tool, ...]:
    """Return the tools of a match: those of its track, as far as its senses tell of others."""
    tools = [LOOK_AROUND, TURN, GO, EXPLORE, WAIT_UNTIL]
    if match.seats > 1 and match.senses != "pixels":
        tools.append(FOLLOW)
    if match.track not in WITHOUT_SUPPLIES:
        tools.append(PICK_UP)
    if match.track not in UNARMED:
        tools += [TAKE_COVER, RELOAD]
        tools += [] if match.senses == "pixels" else [ATTACK, HOLD_FIRE]
    return tuple(tools)


# Those of all tracks.
TOOLS = (
    *(LOOK_AROUND, TURN, GO, EXPLORE, FOLLOW, PICK_UP),
    *(ATTACK, HOLD_FIRE, RELOAD, TAKE_COVER, WAIT_UNTIL),
)
