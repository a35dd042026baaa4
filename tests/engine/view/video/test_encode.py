"""Videos as files."""

from pathlib import Path

import av
import pytest
from PIL import Image

from wildscav_engine.record import Record
from wildscav_engine.view.video import encode
from wildscav_engine.view.video.encode import LAST, Pace, times_of, write_video
from wildscav_engine.view.video.film import Film, Look, VideoError


@pytest.fixture(scope="module")
def film(battle: Record) -> Film:
    return Film(battle, Look("follow", width=160, height=90, detail=0.5))


def test_an_mp4_has_every_picture_in_its_time(film: Film, tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    path = tmp_path / "match.mp4"

    write_video(film, path, Pace(2.0, 4.0, fps=10.0), report=lambda done, count: told.append((done, count)))

    with av.open(str(path)) as container:
        (stream,) = container.streams.video
        shown = [frame.time for frame in container.decode(stream)]
        assert (stream.codec_context.name, stream.width, stream.height) == ("h264", 160, 90)
    assert shown == pytest.approx([index / 10 for index in range(21)])
    assert told == [(done, 21) for done in range(1, 22)]
    assert [each.name for each in tmp_path.iterdir()] == ["match.mp4"]


@pytest.mark.parametrize("name", ["match.gif", "match.webp"])
def test_animations_move_and_repeat(film: Film, tmp_path: Path, name: str) -> None:
    write_video(film, tmp_path / name, Pace(2.0, 3.0, fps=5.0))
    with Image.open(tmp_path / name) as animation:
        assert (animation.size, animation.n_frames, animation.info["loop"]) == ((160, 90), 6, 0)  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("pace", "pictures"),
    [
        (Pace(0.0, 10.0, 25.0), 251 + 62),  # of ten seconds, with the first and the last, and the outcome
        (Pace(0.0, 5.0, 25.0), 126),
        (Pace(0.0, 5.0, 25.0, speed=2.0), 63),
        (Pace(9.0, 99.0, 10.0), 11 + 25),
    ],
)
def test_how_many_pictures_there_are(pace: Pace, pictures: int) -> None:
    assert len(times_of(pace, 10.0)) == pictures
    assert LAST == 2.5


@pytest.mark.parametrize(
    ("pace", "why"),
    [
        (Pace(5.0, 4.0), "from 5 s to 4 s of a match of 10 s"),
        (Pace(11.0), "from 11 s to 10 s"),
        (Pace(fps=0.0), "pictures a second are 0, must be 1 to 60"),
        (Pace(fps=float("nan")), "pictures a second are nan"),
        (Pace(speed=99.0), "speed is 99, must be 0.05 to 50"),
    ],
)
def test_a_pace_that_cannot_be_is_refused(pace: Pace, why: str) -> None:
    with pytest.raises(VideoError, match=why):
        times_of(pace, 10.0)


def test_other_names_are_refused(film: Film, tmp_path: Path) -> None:
    with pytest.raises(VideoError, match=r"must end in \.mp4, \.gif, \.webp"):
        write_video(film, tmp_path / "match.avi")
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(VideoError, match="is not a file"):
        write_video(film, tmp_path / "folder.mp4")


def test_an_interrupted_video_leaves_the_older_file_and_nothing_else(film: Film, tmp_path: Path) -> None:
    path = tmp_path / "match.mp4"
    path.write_bytes(b"older")

    def interrupt(done: int, count: int) -> None:
        if done == 3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        write_video(film, path, Pace(0.0, 2.0), report=interrupt)

    assert path.read_bytes() == b"older"
    assert [each.name for each in tmp_path.iterdir()] == ["match.mp4"]


def test_without_pyav_an_mp4_is_refused_and_a_gif_is_not(
    film: Film, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(encode, "find_spec", lambda name: None)
    with pytest.raises(VideoError, match=r"pip install 'wildscav\[video\]'"):
        write_video(film, tmp_path / "match.mp4", Pace(0.0, 0.1))
    write_video(film, tmp_path / "match.gif", Pace(0.0, 0.1))
    assert [each.name for each in tmp_path.iterdir()] == ["match.gif"]
