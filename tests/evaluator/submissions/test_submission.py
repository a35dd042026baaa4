"""What a submission's folder must look like, and what its author is told where it does not."""

import os
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import pytest

from wildscav_evaluator.submissions.submission import check_unchanged, folder_digest, load_submission
from wildscav_server.hosting.manifest import SubmissionError

GOOD = """
name = "walker"
version = "1.0.0"
entry_point = "agent:Walker"
tracks = ["navigation"]
"""


def make(folder: Path, manifest: str = GOOD) -> Path:
    (folder / "submission.toml").write_text(manifest)
    (folder / "agent.py").write_text("class Walker: ...")
    return folder


def test_a_good_folder_is_read_whole(tmp_path: Path) -> None:
    submission = load_submission(make(tmp_path, GOOD + "[sensors.depth]\nwidth = 64\nheight = 36\nfar = 200"))

    assert submission.name == "walker"
    assert submission.manifest.tracks == ("navigation",)
    assert submission.manifest.sensors == {"depth": {"width": 64, "height": 36, "far": 200}}
    assert submission.folder.is_absolute()


@pytest.mark.parametrize(
    "edit",
    [
        lambda folder: (folder / "agent.py").write_text("class Walker: pass"),
        lambda folder: (folder / "agent.py").chmod(0o755),
        lambda folder: (folder / "agent.py").unlink(),
    ],
    ids=["changed", "executable", "removed"],
)
def test_files_that_change_after_they_were_read_are_found_but_new_ones_may_come(
    tmp_path: Path, edit: Callable[[Path], object]
) -> None:
    submission = load_submission(make(tmp_path))
    (tmp_path / "notes").write_text("written by the agent")
    check_unchanged(submission)
    edit(tmp_path)
    with pytest.raises(SubmissionError, match=r"agent\.py was changed while 'walker' was being played"):
        check_unchanged(submission)


@pytest.mark.parametrize(
    ("more", "seated"),
    [
        ('interface = "words"', {"zone", "teammates", "lidar", "segmentation", "depth"}),
        (
            'interface = "words"\npictures = true',
            {"zone", "teammates", "lidar", "segmentation", "depth", "camera"},
        ),
        ('interface = "keys"', {"screen"}),
        ('interface = "keys"\n[sensors.screen]\nwidth = 64\nquality = "fast"', {"screen"}),
        ("[sensors.depth]", {"depth"}),
    ],
)
def test_the_interface_gives_a_seat_its_sensors(tmp_path: Path, more: str, seated: set[str]) -> None:
    assert load_submission(make(tmp_path, GOOD + more)).sensors.keys() == seated


def test_a_manifest_may_say_who_made_it_and_where_it_comes_from(tmp_path: Path) -> None:
    more = """
author = "Ann"
authors = ["Ann", "Bob"]
description = "walks"
license = "MIT"
url = "https://example.org/walker"
"""
    manifest = load_submission(make(tmp_path, GOOD + more)).manifest

    assert (manifest.author, manifest.authors, manifest.license) == ("Ann", ("Ann", "Bob"), "MIT")


def test_a_program_in_any_language_may_be_the_agent(tmp_path: Path) -> None:
    folder = make(tmp_path, GOOD.replace('entry_point = "agent:Walker"', 'command = ["./go", "--fast"]'))
    (folder / "go").write_text("#!/bin/sh\n")
    (folder / "go").chmod(0o755)

    manifest = load_submission(folder).manifest

    assert manifest.command == ("./go", "--fast")
    assert manifest.entry_point is None


@pytest.mark.parametrize(
    ("was", "becomes", "says"),
    [
        ('name = "walker"', "", "name: is missing: 2 to 40 of a-z, 0-9 and -"),
        ('name = "walker"', 'name = "W"', "name: is 'W', must be 2 to 40 of a-z"),
        ('name = "walker"', 'name = "../up"', "name: is '../up', must be"),
        ('name = "walker"', "name = 7", "name: is 7, must be"),
        ('version = "1.0.0"', "version = 1.0", "version: is 1.0, must be text"),
        ('"1.0.0"', '"[/]"', "version: is '[/]', must be text of 1 to 40 of A-Z, a-z"),
        (
            '"agent:Walker"',
            '"agent.py"',
            "entry_point: is 'agent.py', must be text of the form \"module:Class\"",
        ),
        ('entry_point = "agent:Walker"', "", "entry_point: is missing: text of the form"),
        ("\n", "\ncommand = 'node'\n", "command: is 'node', must be a list of texts"),
        ("\n", "\ncommand = []\n", "command: is [], must be a list of texts"),
        ("\n", "\ncommand = ['node']\n", "command: excludes entry_point: give entry_point for"),
        ('entry_point = "agent:Walker"', 'command = [""]', "command: is '', must name a program"),
        ('entry_point = "agent:Walker"', 'command = ["./go"]', "command: is './go', but there is no file"),
        ('entry_point = "agent:Walker"', 'command = ["../go"]', "command: is '../go', but there is no file"),
        ('entry_point = "agent:Walker"', 'command = ["./agent.py"]', "agent.py is not executable: chmod +x"),
        (
            'entry_point = "agent:Walker"',
            'command = [".venv/bin/go"]',
            ".venv, __pycache__ are not part of a",
        ),
        ('"agent:Walker"', '"__pycache__.agent:Walker"', "__pycache__ are not part of"),
        ("\n", "\nauthor = ['Ann']\n", "author: is ['Ann'], must be text of at most 200 characters"),
        ("\n", "\nurl = 'ftp://ann'\n", "url: is 'ftp://ann', must be text of at most 500"),
        ('"agent:Walker"', '"brain:Walker"', "entry_point: is 'brain:Walker', but there is no file"),
        ('["navigation"]', '["fishing"]', "tracks: there is no track 'fishing'; the tracks are navigation"),
        ('["navigation"]', "[]", "tracks: is []"),
        ('["navigation"]', '["battle", "battle"]', "tracks: a track is named twice"),
        ('["navigation"]', '"navigation"', "tracks: is 'navigation'"),
        ("\n", "\nlicence = 1\n", "licence: is not a field; the fields are name, version"),
        (
            '["navigation"]',
            '["navigation"]\n[sensors.nose]',
            "sensors: there is no sensor 'nose'; the sensors are depth",
        ),
        (
            '["navigation"]',
            '["navigation"]\n[sensors.depth]\nwidht = 5',
            "sensors: .*widht.*options are width",
        ),
        ('["navigation"]', '["navigation"]\n[sensors.depth]\nwidth = -5', "sensors: .*width"),
        ("\n", "\ninterface = 'ears'\n", 'interface: is \'ears\', must be "numbers" .*, "words" or "keys"'),
        ("\n", "\npictures = 'many'\n", "pictures: is 'many', must be true or false"),
        ("\n", "\nmodel = 'any'\n", "model: is 'any', must be true or false"),
        ("\n", "\npictures = true\n", 'pictures: is for interface = "words"'),
        (
            '["navigation"]',
            '["navigation"]\ninterface = "words"\n[sensors.depth]',
            "sensors: a seat of words has its own; it may only have a camera: pictures = true",
        ),
        (
            '["navigation"]',
            '["navigation"]\ninterface = "keys"\n[sensors.depth]',
            "sensors.depth: a seat of keys has its screen alone",
        ),
        (
            '["navigation"]',
            '["navigation"]\ninterface = "keys"\n[sensors.screen]\nfield_of_view = 170',
            "sensors.screen.field_of_view: of a seat of keys, only width, height, shadows, quality may be",
        ),
        ('name = "walker"', "name = walker", "is not valid TOML: .*line 2"),
    ],
)
def test_a_wrong_manifest_gets_one_line_with_file_and_field(
    tmp_path: Path, was: str, becomes: str, says: str
) -> None:
    make(tmp_path, GOOD.replace(was, becomes, 1))
    for left_out in (".venv/bin/go", "__pycache__/agent.py"):
        (tmp_path / left_out).parent.mkdir(parents=True)
        (tmp_path / left_out).touch(0o755)

    with pytest.raises(SubmissionError) as caught:
        load_submission(tmp_path)

    line = str(caught.value)
    assert str(tmp_path / "submission.toml") in line
    assert re.search(says if ".*" in says else re.escape(says), line), line
    assert "\n" not in line
    assert caught.value.exit_code == 2


def test_a_missing_folder_file_or_manifest_is_named(tmp_path: Path) -> None:
    with pytest.raises(SubmissionError, match="nowhere does not exist"):
        load_submission(tmp_path / "nowhere")
    with pytest.raises(SubmissionError, match=r"submission\.toml is missing"):
        load_submission(tmp_path)
    (tmp_path / "file").touch()
    with pytest.raises(SubmissionError, match="is a file, not a folder"):
        load_submission(tmp_path / "file")


def test_the_digest_is_of_paths_and_contents_and_of_nothing_else(tmp_path: Path) -> None:
    first, second = tmp_path / "a", tmp_path / "b"
    for folder in (first, second):
        folder.mkdir()
        make(folder)
    assert folder_digest(first) == folder_digest(second)

    (first / "__pycache__").mkdir()
    (first / "__pycache__" / "agent.pyc").write_bytes(b"left behind")
    assert folder_digest(first) == folder_digest(second)

    (second / "agent.py").write_text("class Walker: pass")
    assert folder_digest(first) != folder_digest(second)
    make(second)
    (second / "agent.py").rename(second / "other.py")
    assert folder_digest(first) != folder_digest(second)


@pytest.mark.parametrize(
    ("manifest", "says"),
    [
        (GOOD + "a" + ".a" * 8000 + " = 1", "a: is not a field"),
        ("name" + ".a" * 8000 + " = 1", "name: is"),
        ("a" + ".a" * 50_000 + " = 1", "may have 16,384 at most"),
        ("a = " + "[" * 10_000, "is not valid TOML: it is nested too deeply"),
        ("a = " + "9" * 5000, "is not valid TOML: Exceeds the limit"),
        (GOOD.replace('"walker"', '"' + "w" * 9000 + '"'), "name: is 'www"),
    ],
    ids=["deep keys", "deep value", "too large", "nested", "digits", "long"],
)
def test_a_manifest_that_would_eat_time_or_memory_is_refused_in_a_line(
    tmp_path: Path, manifest: str, says: str
) -> None:
    with pytest.raises(SubmissionError) as caught:
        load_submission(make(tmp_path, manifest))
    assert says in str(caught.value)
    assert len(str(caught.value)) < 600


@pytest.mark.parametrize(
    ("make_odd", "says"),
    [
        *(
            (partial(os.symlink, target), "is a link that leads out of the submission's folder")
            for target in ("/proc/self/stat", "/etc", "../other")
        ),
        (partial(os.symlink, "odd"), "is a link that leads in a circle"),
        (os.mkfifo, "is a pipe, a socket or a device: a submission may"),
    ],
)
def test_what_is_no_file_of_the_folder_is_refused(
    tmp_path: Path, make_odd: Callable[[Path], None], says: str
) -> None:
    folder = tmp_path / "mine"
    folder.mkdir()
    (tmp_path / "other").touch()
    make_odd(make(folder) / "odd")
    with pytest.raises(SubmissionError, match=f"odd {says}"):
        load_submission(folder)


def test_a_link_within_the_folder_is_as_good_as_its_file(tmp_path: Path) -> None:
    (make(tmp_path) / "link.py").symlink_to("agent.py")
    assert load_submission(tmp_path).name == "walker"


def test_a_file_may_have_a_name_that_is_no_text(tmp_path: Path) -> None:
    make(tmp_path)
    before = folder_digest(tmp_path)
    Path(os.fsdecode(os.fsencode(tmp_path) + b"/\xff.bin")).touch()
    assert folder_digest(tmp_path) != before


def test_labels_in_the_manifest_are_not_part_of_the_content(tmp_path: Path) -> None:
    make(tmp_path)
    manifest, first = tmp_path / "submission.toml", load_submission(tmp_path)
    text = manifest.read_text()

    manifest.write_text(text.replace(f'version = "{first.manifest.version}"', 'version = "9"') + "\n# new\n")
    again = load_submission(tmp_path)
    assert (again.manifest.version, again.content) == ("9", first.content)
    assert again.digest != first.digest

    manifest.write_text(text + "\n[sensors.lidar]\n")
    assert load_submission(tmp_path).content != first.content
