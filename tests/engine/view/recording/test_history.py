from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from tests.builders import act, box, flat_world, make_match, place

from wildscav_engine.sensors.optics.pinhole import PinholeCamera
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.rules import Rules
from wildscav_engine.view.events import events_of, kills_of
from wildscav_engine.view.recording.camera_poses import ABOVE, BACK, CLEARANCE, HEAD, above
from wildscav_engine.view.recording.colors import team_color
from wildscav_engine.view.recording.history import (
    COLOR_CAMERA,
    DEPTH_CAMERA,
    History,
    ImageSequence,
    changes,
    collect_history,
)

NAMES = ("ann", "bob")


def duel(steps: int) -> Iterator[Match]:
    """Ann, looking north at Bob five metres away, holds the trigger; Bob does nothing."""
    rules = Rules(shot_damage=50, respawn_time=1.0, invincible_time=5.0)
    match = make_match("battle", seats=2, rules=rules, time_limit=60.0)
    place(match, 0, (0.0, 0.0, 0.0))
    place(match, 1, (0.0, 0.0, 5.0))
    yield match
    for _ in range(steps):
        act(match, seat_0={"shoot": 1.0})
        yield match


@pytest.fixture(scope="module")
def history() -> History:
    return collect_history(duel(20), 20, images_of=0)[1]


def test_a_duel_is_told_in_order(history: History) -> None:
    events = [event for event in events_of(history, NAMES) if event.kind in ("HIT", "DEATH", "RESPAWN")]

    assert [event.text for event in events] == [
        "ann hits bob, 50 hp left",
        "ann hits bob, 0 hp left",
        "bob dies, shot by ann",
        "bob is back",
    ]
    assert [event.row for event in events[:3]] == [1, 3, 3]  # shots in frames 1 and 11


def test_the_feed_of_kills_names_the_killer_in_the_colour_of_its_team(history: History) -> None:
    (kill,) = kills_of(history, NAMES)
    assert (kill.kind, kill.text, kill.color) == ("KILL", "ann shoots bob", team_color(0))


def test_the_log_begins_and_ends_with_the_match_and_says_who_won(history: History) -> None:
    for texts in ((), ("Battle", "ann wins")):
        first, *_, last = events_of(history, NAMES, *texts)
        assert [(event.kind, event.row) for event in (first, last)] == [("START", 0), ("END", 20)]
        assert not texts or (first.text, last.text) == texts


def test_the_history_holds_the_state_after_every_step(history: History) -> None:
    assert history.frame.tolist() == [5 * row for row in range(21)]
    assert history.agents.position.shape == (21, 2, 3)
    for row, match in enumerate(duel(20)):
        for name, field in history.agents._asdict().items():
            np.testing.assert_array_equal(field[row], getattr(match.state.agents, name)[0], err_msg=name)


@pytest.mark.parametrize(("film", "camera"), [("depth", DEPTH_CAMERA), ("color", COLOR_CAMERA)])
def test_the_image_at_a_row_is_what_the_followed_agents_camera_sees_then(
    history: History, film: str, camera: PinholeCamera
) -> None:
    kept: ImageSequence = getattr(history, film)

    assert kept.rows.tolist() == list(range(21))
    for row, match in enumerate(duel(20)):
        np.testing.assert_array_equal(kept.images[row], camera.read(match, [0])[0], err_msg=f"row {row}")


def test_the_last_picture_is_of_the_last_step(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("wildscav_engine.view.recording.history.MAX_PICTURES", 5)
    _, history = collect_history(duel(20), 20, images_of=0)

    assert history.color is not None
    assert history.color.rows.tolist() == [0, 6, 12, 18, 20]


def alone(**match: Any) -> tuple[Match, History]:
    """Return the start of a match with one agent in the middle, and its history without images."""
    begun = make_match("battle", time_limit=60.0, **match)
    place(begun, 0, (0.0, 0.0, 0.0))
    history = collect_history([begun], 0, images_of=None)[1]
    assert history.depth is history.color is None
    return begun, history


def test_boxes_are_noted_when_they_change_only(history: History) -> None:
    rows = [boxes.row for boxes in history.boxes]

    assert rows[0] == 0
    assert rows == sorted(set(rows))
    for before, after in zip(history.boxes, history.boxes[1:], strict=False):
        assert not (
            np.array_equal(before.serial, after.serial) and np.array_equal(before.quantity, after.quantity)
        )


def test_changes_are_the_first_row_and_every_row_unlike_the_one_before() -> None:
    assert changes(np.array([1, 1, 2, 2, 1]), np.array([0, 0, 0, 5, 5])).tolist() == [0, 2, 3, 4]


def test_the_camera_that_follows_stands_behind_and_above_even_where_a_wall_is() -> None:
    wall = box((-20.0, 0.0, -2.5), (20.0, 6.0, -2.0))
    match, history = alone(world=flat_world(solids=[wall]))  # looks north, two metres before the wall

    camera = above(match.game_map.world, history.agents, 0)

    np.testing.assert_allclose(camera.position[0], [0.0, HEAD + ABOVE, -BACK])
    assert camera.pitch[0] == pytest.approx(np.degrees(np.arctan2(ABOVE, BACK)))


def test_the_camera_that_follows_stays_above_a_slope_behind() -> None:
    match, history = alone(world=flat_world(slope=2.0))
    history.agents.yaw[0, 0] = -90.0  # looks west, down; the ground behind rises two metres a metre

    camera = above(match.game_map.world, history.agents, 0)

    np.testing.assert_allclose(camera.position[0], [BACK, 2 * BACK + CLEARANCE, 0.0], atol=1e-9)


def test_teammates_have_what_their_team_has() -> None:
    match = make_match("gathering", seats=3, teams=(0, 1, 0), time_limit=60.0)
    match.state.agents.supplies[0] = (1, 2, 4)
    _, history = collect_history(iter([match]), 0, images_of=None)

    assert history.has_teammates
    assert history.supplies_of_team[0].tolist() == [5, 2, 5]
