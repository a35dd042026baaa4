"""The colours of what a replay shows beside the world itself, as red, green, blue 0-255."""

import colorsys

EARTH, DEEP_EARTH = (128, 98, 70), (84, 64, 48)

OUTDOOR_BOX, INDOOR_BOX, DROPPED_BOX = (90, 200, 255), (30, 110, 255), (120, 80, 235)
TARGET = (255, 60, 160)
START = (250, 250, 250)
SHOT, HIT = (255, 224, 90), (255, 50, 40)
PICK_UP, DEATH, RESPAWN, GOAL = (70, 190, 255), (255, 70, 60), (190, 190, 190), (255, 110, 190)
START_END = (255, 255, 255)
DEAD = (150, 150, 155)


def of_seat(seat: int) -> tuple[int, int, int]:
    """Return a strong colour for a seat; the first dozen are far apart."""
    hue = (0.02 + 0.381966 * seat) % 1.0  # the golden angle
    red, green, blue = colorsys.hsv_to_rgb(hue, 0.80 - 0.25 * (seat // 7 % 2), 1.0)
    return round(255 * red), round(255 * green), round(255 * blue)
