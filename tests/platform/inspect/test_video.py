"""``wildscav replay --video``, run as its users run it."""

from pathlib import Path

import av
import pytest
from PIL import Image
from typer.testing import CliRunner

from wildscav.cli.main import app
from wildscav.errors import UserError

SMALL = ("--size", "160x90", "--fps", "5", "--end", "1")


def run(*arguments: str) -> str:
    result = CliRunner().invoke(app, ["replay", "--video", *arguments])
    if result.exception is not None:
        raise result.exception
    return result.output


@pytest.mark.parametrize("view", ["", "--seat 1", "--view behind", "--view above", "--view grid"])
def test_a_video_is_written_beside_its_record(record: Path, view: str) -> None:
    said = run(str(record), *view.split(), *SMALL)
    path = record.with_suffix(".mp4")
    with av.open(str(path)) as container:
        assert sum(1 for _ in container.decode(video=0)) == 6
    assert "battle.mp4" in said
    assert "1 s of the match" in said
    assert {each.suffix for each in record.parent.iterdir()} == {".wsr", ".mp4"}
    path.unlink()


def test_the_name_chooses_the_format(record: Path, tmp_path: Path) -> None:
    run(str(record), "--out", str(tmp_path / "match.gif"), *SMALL)
    with Image.open(tmp_path / "match.gif") as animation:
        assert animation.format == "GIF"


def test_a_poster_is_one_picture(record: Path, tmp_path: Path) -> None:
    run(str(record), "--poster", str(tmp_path / "poster.png"), "--start", "1", "--size", "320x180")
    with Image.open(tmp_path / "poster.png") as picture:
        assert (picture.format, picture.size) == ("PNG", (320, 180))


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (("--seat", "1", "--view", "above"), "--seat and --view above exclude each other"),
        (("--seat", "7"), "--seat is 7; the match has seats 0 to 2"),
        (("--out", "match.avi"), "--out is match.avi: its name must end in .mp4, .gif, .webp"),
        (("--poster", "a.mp4"), "--poster is a.mp4: its name must end in .png, .webp, .jpg, .jpeg"),
        (("--poster", "a.png", "--fps", "5"), "--poster is one picture"),
        (("--size", "big"), "--size is 'big', must be a width and a height such as 1280x720"),
        (("--size", "9x9"), "the size is 9x9, must be from 160x90 to 1920x1080 pixels"),
        (("--detail", "7"), "the detail is 7, must be 0.2 to 1"),
        (("--detail", "0"), "the detail is 0, must be 0.2 to 1"),
        (("--fps", "0"), "the pictures a second are 0, must be 1 to 60"),
        (("--start", "5"), "from 5 s to 2 s of a match of 2 s"),
        (("--season", "http://127.0.0.1"), "--season is for the number of a match"),
    ],
)
def test_what_is_wrong_is_said(record: Path, options: tuple[str, ...], why: str) -> None:
    with pytest.raises(UserError) as told:
        run(str(record), *options)
    assert why in str(told.value)


def test_a_file_that_is_no_record_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "notes.wsr"
    path.write_text("not a record")
    with pytest.raises(UserError, match="notes"):
        run(str(path), *SMALL)
