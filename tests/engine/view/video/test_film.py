"""What the pictures of a match show."""

from pathlib import Path

import numpy as np
import pytest
from tests.engine.view.agent_note import AgentNote
from tests.engine.view.conftest import robots_play

from wildscav_engine.record import Record
from wildscav_engine.rendering.palette import of_seat
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.view.recording.history import History
from wildscav_engine.view.video.cameras import Camera
from wildscav_engine.view.video.encode import write_poster
from wildscav_engine.view.video.film import SHORTEST, VIEWS, Film, Look, VideoError, View, whom_to_follow
from wildscav_engine.view.video.moments import moment_at
from wildscav_engine.view.video.overlay.drawing import font, shortened
from wildscav_engine.view.video.overlay.feed import news_of


def small(view: View = "follow", seat: int | None = None) -> Look:
    return Look(view, seat, width=320, height=180, detail=0.5)


@pytest.mark.parametrize("view", VIEWS)
def test_every_view_shows_a_picture_of_the_asked_size_that_changes(battle: Record, view: View) -> None:
    film = Film(battle, small(view))

    first, last = (np.asarray(film.picture(seconds)) for seconds in (0.0, film.seconds))

    assert first.shape == last.shape == (180, 320, 3)
    assert first.std() > 10.0
    assert (first != last).any()
    assert film.seconds == pytest.approx(10.0)


@pytest.mark.parametrize("track", ["navigation", "gathering", "royale"])
def test_every_kind_of_match_can_be_filmed(track: str) -> None:
    film = Film(robots_play(track), small())
    assert np.asarray(film.picture(film.best_time)).std() > 10.0


def test_what_is_said_is_written_below_for_long_enough_to_be_read(battle: Record) -> None:
    look = small(seat=1)
    film = Film(battle, look, notes=[AgentNote(1, 10, text="I hide. " * 20), AgentNote(2, 12, text="Who?")])
    silent = Film(battle, look)
    changed = [
        np.argwhere((np.asarray(film.picture(time)) != np.asarray(silent.picture(time))).any(axis=(1, 2)))
        for time in (0.9, 1.1, 9.5)
    ]
    captions = film.hud.captions

    assert [len(rows) > 0 for rows in changed] == [False, True, True]
    assert changed[1].min() > 0.4 * 180  # not before what happens
    assert captions.at(60.0, None).text == "Who?"  # type: ignore[union-attr]
    assert captions.at(60.0, 0) is None


def test_the_same_record_gives_the_same_picture(battle: Record) -> None:
    one, other = (Film(battle, small(seat=1)).picture(5.0) for _ in range(2))
    assert one.tobytes() == other.tobytes()


@pytest.mark.parametrize(
    ("look", "why"),
    [
        (Look(seat=3), "no seat 3: the record has seats 0 to 2"),
        (Look(width=100), "100x720, must be from 160x90 to 1920x1080"),
        (Look(detail=2.0), "detail is 2, must be 0.2 to 1"),
    ],
)
def test_what_cannot_be_shown_is_refused(battle: Record, look: Look, why: str) -> None:
    with pytest.raises(VideoError, match=why):
        Film(battle, look)


def test_between_two_steps_agents_are_between_two_places(seen: History) -> None:
    moves = np.linalg.norm(np.diff(seen.agents.position[:, 1], axis=0), axis=1)
    row = int(np.argmax((moves > 0.1) & (seen.agents.health[1:, 1] > 0) & (moves < 2.0)))
    middle = float(seen.frame[row] + seen.frame[row + 1]) / 2

    moment = moment_at(seen, middle)

    assert moment.row == row
    halfway = (seen.agents.position[row, 1] + seen.agents.position[row + 1, 1]) / 2
    assert moment.position[1] == pytest.approx(halfway)
    assert moment_at(seen, float(seen.frame[row])).position == pytest.approx(seen.agents.position[row])


def test_a_turn_through_south_takes_the_short_way(seen: History) -> None:
    agents = seen.agents._replace(yaw=seen.agents.yaw.copy())
    agents.yaw[0, 0], agents.yaw[1, 0] = 170.0, -170.0
    moment = moment_at(seen._replace(agents=agents), float(seen.frame[1]) / 2)
    assert moment.yaw[0] == pytest.approx(180.0)


def test_the_camera_projects_as_it_takes_pictures() -> None:
    camera = Camera(np.array([0.0, 2.0, 0.0]), 90.0, 0.0, None)  # looks east
    ahead, right_of_it, behind = camera.onto(
        np.array([[10.0, 2.0, 0.0], [10.0, 2.0, -1.0], [-10.0, 2.0, 0.0]]), 640, 360
    )
    assert ahead.tolist() == pytest.approx([320.0, 180.0, 10.0])
    assert right_of_it[0] > 320.0  # south is to the right of someone who looks east
    assert behind[2] < 0.0


def test_the_feed_tells_every_death_and_who_caused_it(seen: History, battle: Record) -> None:
    news = news_of(seen, battle.names)
    deaths = int(seen.agents.deaths[-1].sum())
    told = [part.words for item in news for part in item.parts if part.seat is None]
    assert len(news) == deaths
    assert told.count("shot") == int(seen.agents.kills[-1].sum())


def test_whom_a_video_follows_changes_only_now_and_then(seen: History) -> None:
    followed = whom_to_follow(seen)
    cuts = seen.frame[np.nonzero(np.diff(followed))[0]]
    alive = seen.agents.health[np.arange(len(followed)), followed] > 0
    assert (np.diff(cuts) >= SHORTEST * 50 - 5).all() or not alive.all()
    assert ((followed >= 0) & (followed < 3)).all()


def test_a_shot_is_drawn_towards_what_it_hit(battle: Record, seen: History) -> None:
    shots = np.argwhere(seen.agents.fired & (seen.agents.hit_seat != NOBODY))
    assert len(shots), "this battle has shots that hit"
    row, seat = shots[0].tolist()
    film = Film(battle, Look("follow", seat=seat, width=640, height=360, detail=1.0))
    picture = np.asarray(film.picture(float(seen.frame[row] + 1) / 50)).astype(int)
    is_yellow = (picture[..., 0] > 200) & (picture[..., 1] > 150) & (picture[..., 2] < 110)
    assert is_yellow.any()


def test_long_names_are_shortened_to_their_room() -> None:
    short = shortened("a name that is much too long for its room", 16, 100)
    assert short.endswith("…")
    assert font(16).getlength(short) <= 100
    assert shortened("bob", 16, 100) == "bob"


def test_a_poster_is_one_picture_of_a_good_moment(battle: Record, tmp_path: Path) -> None:
    from PIL import Image

    film = Film(battle, small())
    for name in ("poster.png", "poster.webp", "poster.jpg"):
        write_poster(film, tmp_path / name)
        with Image.open(tmp_path / name) as picture:
            assert picture.size == (320, 180)
    with pytest.raises(VideoError, match=r"must end in \.png"):
        write_poster(film, tmp_path / "poster.bmp")
    with pytest.raises(VideoError, match="99 s of a match of 10 s"):
        write_poster(film, tmp_path / "poster.png", 99.0)


def test_teams_keep_their_colours_in_the_overlay(battle: Record) -> None:
    colors = Film(battle, small()).hud.colors
    own = [of_seat(seat) for seat in range(3)]
    assert all(max(bright) == max(plain) for bright, plain in zip(colors, own, strict=True))
