"""What the screen says over the camera's picture, pixel by pixel."""

import hashlib

import numpy as np
import pytest
from numpy.typing import NDArray
from tests.builders import flat_world, lay_boxes, make_match, place, seen_now
from tests.engine.sensors.scenes import duel

from wildscav_engine.sensors import ColorCamera, Screen
from wildscav_engine.sensors.screen.display import GOLD, RED, RING, SKY
from wildscav_engine.sensors.screen.letters import BITS, LETTERS
from wildscav_engine.simulation.match import Match

SCREEN = Screen()  # 160 × 120 pixels, letters of 5 × 7
BOTTOM = 120 - 8  # the row of the lowest line of text


def display(match: Match, sensor: Screen = SCREEN) -> NDArray[np.uint8]:
    """The display of seat 0 alone, over black."""
    picture = np.zeros((1, 1, *sensor.shape), np.uint8)
    sensor.draw_over(match.state, seen_now(match), match.spec.track, np.array([0]), picture)
    return np.asarray(picture[0, 0])


def colored(picture: NDArray[np.uint8], color: int) -> NDArray[np.int64]:
    """Which pixels have a colour: (N, 2) rows and columns."""
    return np.argwhere((picture == [color >> 16, (color >> 8) & 255, color & 255]).all(axis=-1))


def text_at(picture: NDArray[np.uint8], left: int, top: int, scale: int = 1) -> str:
    """Read letters from a place on, to two spaces or the end."""
    lit, text = picture[top::scale, :].any(axis=-1)[:7], ""
    while left + 5 * scale <= picture.shape[1]:
        bits = lit[:, left : left + 5 * scale : scale] @ np.array([16, 8, 4, 2, 1])
        (found,) = np.nonzero((bits == BITS).all(axis=1))
        if not len(found):
            break
        text, left = text + LETTERS[found[0]], left + 6 * scale
    return text.split("  ")[0].rstrip()


def test_outside_the_display_it_is_the_picture_of_the_camera() -> None:
    match = duel()
    screen = SCREEN.read(match, [0])[0]
    camera = ColorCamera(height=120).read(match, [0])[0]
    drawn = (screen != camera).any(axis=-1)
    assert drawn[:18].any()
    assert drawn[-12:].any()
    drawn[54:67, 74:87] = False  # the crosshair
    assert not drawn[18:-12].any()


@pytest.mark.parametrize(
    ("track", "changes", "left", "top", "says"),
    [
        ("battle", {}, 2, 1, "2:00"),
        ("battle", {"health": 100}, 2, BOTTOM, "+100"),
        ("battle", {"clip": 5, "spare_ammo": 60}, 160 - 1 - 24, BOTTOM, "5/60"),
        ("battle", {"reload_left": 70}, 160 - 1 - 60, BOTTOM, "RELOAD 1.4"),
        ("battle", {"supplies": 37}, (160 - 18) // 2, BOTTOM, "=37"),
        ("battle", {"invincible_left": 101}, (160 - 48) // 2, 73, "SAFE 3 S"),
        ("battle", {"clip": 0}, (160 - 30) // 2, 73, "EMPTY"),
        ("battle", {"health": 0, "respawn_left": 350}, (160 - 66) // 2, 73, "BACK IN 7 S"),
        ("navigation", {}, 160 - 1 - 24, BOTTOM, ""),  # no weapon
        ("navigation", {"supplies": 37}, (160 - 18) // 2, BOTTOM, ""),
    ],
)
def test_it_says(track: str, changes: dict[str, int], left: int, top: int, says: str) -> None:
    match = duel(track=track)
    for name, value in changes.items():
        getattr(match.state.agents, name)[0, 0] = value
    assert text_at(display(match), left, top) == says


@pytest.mark.parametrize(
    ("place_of", "column"),
    [
        ((0, 0, 30), 80),  # ahead
        ((30, 0, 30), 80 + 28),  # 45° of 130° to the right, of 80 pixels
        ((-30, 0, 30), 80 - 28),
        ((0, 0, -30), 80 + 38),  # behind: at the end
    ],
)
def test_the_compass_shows_the_way_to_the_target(place_of: tuple[int, int, int], column: int) -> None:
    match = duel(track="navigation")
    match.state.matches.target[0] = place_of
    gold = colored(display(match)[9:18], GOLD)
    assert gold[:, 1].min() + gold[:, 1].max() == pytest.approx(2 * column, abs=2)
    assert text_at(display(match), 160 - 1 - 24, 1) == ("*30M" if 0 in place_of[::2] else "*42M")


def test_a_target_that_is_not_known_is_not_shown() -> None:
    assert not len(colored(display(duel(track="capture")), GOLD))


def test_the_compass_shows_boxes_that_the_seat_is_told_of() -> None:
    match = duel(rules={"senses": "sighted"})
    lay_boxes(match, (0, 0, 8), (0, 0, -8))  # one ahead, one behind
    sky = colored(display(match)[9:18], SKY)
    assert sky[:, 1].tolist() == [79, 80, 81] * 3


@pytest.mark.parametrize(("facing", "has_arc"), [(0.0, True), (180.0, False)])
def test_whoever_is_hit_sees_it_and_from_where_if_it_sees_the_shooter(facing: float, has_arc: bool) -> None:
    match = duel(distance=10.0)
    assert not len(colored(display(match), RED))
    place(match, 0, (0, 0, 0), facing)
    match.state.agents.hit_by_seat[0, 0] = 1
    picture = display(match)
    assert (picture[30:90, :3] == [255, 64, 64]).all()
    assert bool(len(colored(picture[22:40, 40:120], RED))) == has_arc


def test_the_crosshair_turns_red_with_a_hit() -> None:
    match = duel()
    middle = slice(50, 70), slice(70, 90)
    assert not len(colored(display(match)[middle], RED))
    match.state.agents.hit_seat[0, 0] = 1
    assert len(colored(display(match)[middle], RED))


def test_a_royale_shows_the_way_to_the_next_safe_zone() -> None:
    match = make_match(
        "royale",
        flat_world(80),
        seats=2,
        zone={"phases": [{"wait": 60.0, "shrink": 5.0, "share": 0.2, "damage": 1}]},
    )
    place(match, 0, (0, 0, 0))
    picture = display(match)
    assert len(colored(picture[9:18], RING))
    assert text_at(picture, 160 - 1 - 48, 19) == "ZONE 56M"  # a circle around a square of 80 m


@pytest.mark.parametrize(("width", "height", "scale"), [(160, 120, 1), (640, 360, 2), (1280, 720, 4)])
def test_letters_grow_with_the_picture(width: int, height: int, scale: int) -> None:
    picture = display(duel(), Screen(width=width, height=height))
    assert text_at(picture, 2 * scale, scale, scale) == "2:00"


def test_the_display_has_the_same_pixels_on_any_machine() -> None:
    match = duel(distance=10.0)
    lay_boxes(match, (1, 0, 8), (3, 0, 5))
    match.state.agents.yaw[0, 0], match.state.agents.hit_by_seat[0, 0] = 12.3, 1
    picture = display(match, Screen(width=320, height=180))
    assert hashlib.blake2b(picture.tobytes(), digest_size=8).hexdigest() == "3eb0bed1d70ed0b8"
