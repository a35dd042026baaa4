"""The tools of seats of words: each plays many steps, and ends early with a reason."""

from wildscav_language.body import Body
from wildscav_language.calls import Tool
from wildscav_language.tools.fighting import ATTACK, FOLLOW, HOLD_FIRE, RELOAD, TAKE_COVER
from wildscav_language.tools.looking import LOOK_AROUND, TURN, WAIT_UNTIL
from wildscav_language.tools.walking import EXPLORE, GO, PICK_UP


def tools_of(body: Body) -> tuple[Tool, ...]:
    """Return the tools of a match: those of its track, as far as its senses tell of others."""
    match = body.match
    tools = [LOOK_AROUND, TURN, GO, EXPLORE, WAIT_UNTIL]
    if match.seats > 1 and match.senses != "pixels":
        tools.append(FOLLOW)
    if body.gathers:
        tools.append(PICK_UP)
    if body.is_armed:
        tools.append(RELOAD)
        tools += [] if match.senses == "pixels" else [ATTACK, HOLD_FIRE, TAKE_COVER]
    return tuple(tools)


# Those of all tracks.
TOOLS = (
    *(LOOK_AROUND, TURN, GO, EXPLORE, FOLLOW, PICK_UP),
    *(ATTACK, HOLD_FIRE, RELOAD, TAKE_COVER, WAIT_UNTIL),
)
