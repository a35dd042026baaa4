"""The colours of everything in a replay apart from the world, as red, green, blue 0-255.

The viewer shows text and plots on a white background in its light theme, and on a nearly black one in its
dark theme. ``readable`` makes a colour legible on both. Objects in the 3D scene do not need that.
"""

import numpy as np

from wildscav_engine.rendering.palette import SUPPLY_BOX, of_seat

Color = tuple[int, int, int]

EARTH, DEEP_EARTH = (128, 98, 70), (84, 64, 48)

OUTDOOR_BOX, INDOOR_BOX, DROPPED_BOX = SUPPLY_BOX, (30, 110, 255), (120, 80, 235)
TARGET, START = (255, 60, 160), (40, 120, 230)
ZONE, NEXT_ZONE = (60, 130, 255), (255, 255, 255)
OUTSIDE = (225, 50, 60, 70)
HEAT = ((255, 226, 110, 70), (255, 160, 50, 90), (240, 70, 30, 110))  # few supplies, more, most
SHOT, HIT = (255, 224, 90), (255, 50, 40)
DEAD = (150, 150, 155)

# Relative luminance of legible text: a contrast over 3 : 1 on white and 4.5 : 1 on near-black.
DIMMEST, BRIGHTEST = 0.21, 0.28
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of red, green and blue, by WCAG 2


def luminance(color: Color) -> float:
    """Return the relative luminance of a colour, 0 for black and 1 for white, as WCAG 2 defines it."""
    return float(_linear(color) @ LUMINANCE)


def readable(color: Color) -> Color:
    """Return a colour of the same hue that is legible on a white and on a black background."""
    linear = _linear(color)
    light = float(linear @ LUMINANCE)
    if light > BRIGHTEST:
        linear = linear * (BRIGHTEST / light)
    elif light < DIMMEST:
        linear = linear + (1.0 - linear) * ((DIMMEST - light) / (1.0 - light))
    channels = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    red, green, blue = np.round(255 * channels).astype(int).tolist()
    return red, green, blue


def team_color(team: int) -> Color:
    """Return the colour of a team in text and plots; bodies have the stronger colour of the palette."""
    return readable(of_seat(team))


def _linear(color: Color) -> np.ndarray:
    channels = np.array(color) / 255
    return np.where(channels <= 0.04045, channels / 12.92, ((channels + 0.055) / 1.055) ** 2.4)


START_END = readable((110, 120, 135))
PICK_UP, HURT, DEATH = readable((40, 150, 230)), readable((200, 140, 30)), readable((235, 50, 45))
RESPAWN, GOAL = readable((130, 130, 130)), readable((235, 50, 150))
