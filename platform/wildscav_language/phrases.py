"""How texts say directions, distances, heights and names."""

from wildscav.agent import Vector
from wildscav.geometry import direction_to, flat_distance, turn_to

NAME_LIMIT = 24  # characters of a name that a text repeats
POINTS = ("north", "north-east", "east", "south-east", "south", "south-west", "west", "north-west")
LEVEL = 1.0  # m up or down, that are not worth a word


def clock(turn: float) -> str:
    """Return a turn from the view (degrees, to the right) as an hour: 12 is ahead, 3 is to the right."""
    return f"{round(turn / 30.0) % 12 or 12} o'clock"


def degrees(direction: float) -> str:
    """Return a compass direction in whole degrees, 0 to 359."""
    return f"{round(direction) % 360}°"


def compass(direction: float) -> str:
    """Return a compass direction as a word."""
    return POINTS[round(direction / 45.0) % 8]


def way_to(here: Vector, yaw: float, place: Vector) -> str:
    """Return where a place is: hour, bearing, distance and, unless it is level, height."""
    far = flat_distance(here, place)
    if far < 0.5:
        return f"here{height(place[1] - here[1])}"
    direction = direction_to(here, place)
    hour = clock(turn_to(yaw, direction))
    return f"{hour}, bearing {degrees(direction)}, {far:.1f} m{height(place[1] - here[1])}"


def height(up: float) -> str:
    """Return how much higher or lower something is; nothing if it is level."""
    if abs(up) < LEVEL:
        return ""
    return f", {abs(up):.1f} m {'higher' if up > 0.0 else 'lower'}"


def quoted(name: str) -> str:
    """Return another team's name in quotation marks: of bounded length, on one line, in plain characters.

    A name is a name: whatever it says, a text never contains it outside of quotation marks.
    """
    short = name if len(name) <= NAME_LIMIT else f"{name[: NAME_LIMIT - 1]}…"
    plain = "".join(one if one.isprintable() and one not in "\"'`<>[]{}\\" else "?" for one in short)
    return f'"{plain}"'
