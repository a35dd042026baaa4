"""``wildscav map`` as its user meets it."""

import json
from functools import partial
from pathlib import Path

import pytest
from PIL import Image
from tests.commands import Run, run_command

SMALL = ("--seed", 3, "--size", 60, "--houses", 2)
NAME = "seed-3-size-60-houses-2"  # what it is called


@pytest.fixture
def wildscav_map(tmp_path: Path) -> Run:
    """Runs the command in this process, which has the engine loaded, with the temporary folder as its own."""
    return partial(run_command, "map", cwd=tmp_path, columns=200)


def test_show_names_its_picture_for_what_it_shows_and_says_what_it_replaces(
    wildscav_map: Run, tmp_path: Path
) -> None:
    views = ((), ("--storey", 1, "--locations"), ("--center", 3, -4, "--span", 20))
    for options in views:
        done = wildscav_map("show", *SMALL, "--width", 300, *options)
        assert (done.returncode, done.stderr) == (0, "")
        with Image.open(tmp_path / done.stdout.partition(": ")[0]) as picture:
            assert (picture.format, picture.width) == ("PNG", 300)
    assert {path.name for path in tmp_path.iterdir()} == {
        f"{NAME}{part}.png" for part in ("", "-storey-1-locations", "-center-3--4-span-20")
    }
    tmp_path.joinpath(f"{NAME}.png").write_bytes(b"older")
    done = wildscav_map("show", *SMALL, "--width", 300)
    assert done.stdout.endswith(" pixels, replacing the file that was there\n")
    assert tmp_path.joinpath(f"{NAME}.png").read_bytes() != b"older"


def test_export_writes_meshes_locations_and_the_spec(wildscav_map: Run, tmp_path: Path) -> None:
    done = wildscav_map("export", *SMALL, "--storeys", "2-3", "-o", tmp_path / "deep" / "folder")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == len(list((tmp_path / "deep" / "folder").iterdir())) == 5
    described = json.loads((tmp_path / "deep" / "folder" / "map.json").read_text())
    assert described["spec"]["seed"] == 3
    assert described["spec"]["config"]["storeys"] == [2, 3]


def test_info_prints_the_figures(wildscav_map: Run, tmp_path: Path) -> None:
    config = {"size": 60, "houses": 0, "vegetation": 0, "water": 0}
    (tmp_path / "bare.json").write_text(json.dumps({"config": config, "seed": 7}))
    done = wildscav_map("info", "--config", tmp_path / "bare.json")
    assert (done.returncode, done.stderr) == (0, "")
    lines = [line.split(maxsplit=1) for line in done.stdout.splitlines() if line.strip()]
    figures = dict(line for line in lines if len(line) == 2)
    assert figures["size"].strip() == "60 × 60 m"
    assert figures["seed"].strip() == "7"
    assert figures["houses"].strip() == "none"
    assert figures["water"].strip() == "0.0 % of the area"
    assert len(figures["digest"].strip()) == 16


def test_options_stand_over_the_file_and_a_file_may_be_toml(wildscav_map: Run, tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text(
        'size = 80\nwater = 0\nhouses = 1\n[[placements]]\nkind = "rock"\nlocation = [10, 10]\n'
    )
    done = wildscav_map("export", "--config", "own.toml", "--houses", 0, "--seed", 5)
    assert (done.returncode, done.stderr) == (0, "")
    spec = json.loads((tmp_path / "map-own-houses-0-seed-5" / "map.json").read_text())["spec"]
    assert (spec["seed"], spec["config"]["size"], spec["config"]["houses"]) == (5, 80, 0)
    assert spec["config"]["placements"][0]["kind"] == "rock"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["show"], "a map is named by its ID, or by --seed, --config and the fields of a config"),
        (["show", "14", "--seed", "1"], "not both"),
        (["info", "1000"], "ID is 1000, must be 1 to 999"),
        (["info", "0"], "ID is 0, must be 1 to 999"),
        (["show", "-54"], "ID is -54, must be 1 to 999"),
        (["export", "-54"], "ID is -54, must be 1 to 999"),
        (["show", "--seed", "-1"], "seed: Input should be greater than or equal to 0, not -1"),
        (["show", "--size", "30"], "size: Input should be greater than or equal to 40, not 30"),
        (["show", "--density", "medium"], "density: Input should be 'low' or 'high', not 'medium'"),
        (["show", "--storeys", "many"], "storeys is 'many', must be a number from 1 to 4, or a range such"),
        (
            ["show", "--storeys", "3-2"],
            "storeys is (3, 2): the first number must not be above the second",
        ),
        (["info", "--size", "60", "--houses", "200"], "houses is 200"),
        (["show", *map(str, SMALL), "--storey", "9"], "storey is 9, must be 1 to"),
        (["show", *map(str, SMALL), "--width", "9"], "width is 9, must be 300 to 8000 pixels"),
        (["show", *map(str, SMALL), "-o", "map.gif"], "map.gif must end in one of .png"),
        (["info", "--config", "broken.toml"], "broken.toml: "),
        (["info", "--config", "list.json"], "list.json must hold the fields of a MapConfig"),
        (["info", "--config", "unknown.json"], "colour: Extra inputs are not permitted"),
    ],
)
def test_what_cannot_be_is_one_line_with_the_field_and_its_range(
    wildscav_map: Run, tmp_path: Path, arguments: list[str], message: str
) -> None:
    (tmp_path / "broken.toml").write_text("size = = 3")
    (tmp_path / "list.json").write_text("[1]")
    (tmp_path / "unknown.json").write_text('{"colour": 3}')
    done = wildscav_map(*arguments)
    assert (done.returncode, done.stderr.count("\n")) == (2, 1), done.stderr
    assert done.stderr.startswith("wildscav: ")
    assert message in done.stderr


def test_a_folder_that_is_missing_is_named(wildscav_map: Run, tmp_path: Path) -> None:
    for arguments in (
        ("show", "--width", 300, "-o", tmp_path / "none" / "a.png"),
        ("info", "--config", tmp_path / "none.json"),
    ):
        done = wildscav_map(arguments[0], *SMALL, *arguments[1:])
        assert (done.returncode, done.stderr.count("\n")) == (1, 1)
        assert "none" in done.stderr
        assert "No such file or directory" in done.stderr
