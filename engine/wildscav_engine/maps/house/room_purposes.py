"""Assigning purposes to rooms by the style of the house, the storey and their size."""

from wildscav_engine.arithmetic.random_numbers import Dice
from wildscav_engine.geometry.shapes import Rectangle
from wildscav_engine.maps.house.plan import NARROWEST_ROOM

STYLES = ("dwelling", "dwelling", "dwelling", "store", "office")  # each entry is equally likely

# The purposes of a storey's rooms, the largest room first; the last one repeats.
GROUND: dict[str, tuple[str, ...]] = {
    "dwelling": ("living", "kitchen", "dining", "study", "bath", "pantry"),
    "store": ("store", "store", "workshop", "office", "store", "pantry"),
    "office": ("office", "dining", "office", "kitchen", "office"),
}
UPPER: dict[str, tuple[str, ...]] = {
    "dwelling": ("bedroom", "bedroom", "study", "bath", "bedroom"),
    "store": ("store", "workshop", "store", "bedroom", "pantry"),
    "office": ("office", "office", "study", "office"),
}


def assign_purposes(
    dice: Dice, rooms: list[Rectangle], hall: Rectangle | None, style: str, level: int
) -> list[str]:
    """Return the purpose of each room of a storey."""
    wanted = (UPPER if level else GROUND)[style]
    names = [""] * len(rooms)
    # Rooms of similar size are ordered at random.
    order = sorted((-room.area * dice.uniform(0.8, 1.2), number) for number, room in enumerate(rooms))
    named = 0
    for _, number in order:
        room = rooms[number]
        if room == hall:
            names[number] = "hall"
        elif min(room.right - room.left, room.front - room.back) < NARROWEST_ROOM - 0.1:
            names[number] = "corridor"
        else:
            names[number] = wanted[min(named, len(wanted) - 1)]
            named += 1
    return names
