"""The colours of text and plots hold on both of the viewer's themes."""

import pytest

from wildscav_engine.view.recording import colors
from wildscav_engine.view.recording.colors import Color, luminance, readable, team_color

WHITE, NEAR_BLACK = (255, 255, 255), (13, 16, 17)
LEAST = 3.0  # WCAG 2, for large text and for what is drawn
WRITTEN = ("START_END", "PICK_UP", "HURT", "DEATH", "RESPAWN", "GOAL")


def contrast(first: Color, second: Color) -> float:
    darker, lighter = sorted((luminance(first), luminance(second)))
    return (lighter + 0.05) / (darker + 0.05)


def test_contrast_of_black_and_white_is_twenty_one() -> None:
    assert contrast((0, 0, 0), WHITE) == pytest.approx(21.0)


@pytest.mark.parametrize(
    "color",
    [*(getattr(colors, name) for name in WRITTEN), *map(team_color, range(12)), readable(colors.DEAD)],
    ids=str,
)
def test_every_colour_of_text_can_be_read_on_white_and_on_black(color: Color) -> None:
    assert contrast(color, WHITE) >= LEAST
    assert contrast(color, NEAR_BLACK) >= LEAST


@pytest.mark.parametrize("color", [(255, 255, 255), (255, 224, 90), (0, 0, 0), (0, 0, 255)])
def test_any_colour_is_made_readable(color: Color) -> None:
    assert contrast(readable(color), WHITE) >= LEAST
    assert contrast(readable(color), NEAR_BLACK) >= LEAST


def test_a_colour_that_can_be_read_stays() -> None:
    assert readable(readable((40, 150, 230))) == readable((40, 150, 230))
