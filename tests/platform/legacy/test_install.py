"""``wildscav-legacy install``: what it writes, what it leaves alone, what it refuses."""

import subprocess
from functools import partial
from pathlib import Path

import pytest
from tests.commands import run_command

from wildscav.errors import UserError
from wildscav_legacy.commands import DEFAULT_MAPS, read_ids
from wildscav_legacy.install import install_engine, missing_maps, paths_of, write_map


@pytest.mark.parametrize(
    ("text", "ids"),
    [
        ("7", [7]),
        ("1,2,101-103", [1, 2, 101, 102, 103]),
        (" 5 , 3-4,4", [3, 4, 5]),
        ("014", [14]),
    ],
)
def test_maps_are_named_by_ids_and_ranges(text: str, ids: list[int]) -> None:
    assert read_ids(text) == ids


def test_the_default_are_60_maps() -> None:
    assert read_ids(DEFAULT_MAPS) == [*range(1, 21), *range(91, 131)]


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "--maps has '', must be ids and ranges such as 1,2,101-130"),
        ("1,,2", "--maps has ''"),
        ("a", "--maps has 'a'"),
        ("1-", "--maps has '1-'"),
        ("-5", "--maps has '-5'"),
        ("5-3", "--maps has '5-3', must be within 1 to 999 and ascending"),
        ("0", "--maps has '0', must be within 1 to 999"),
        ("1000", "--maps has '1000', must be within 1 to 999"),
    ],
)
def test_other_lists_are_refused(text: str, why: str) -> None:
    with pytest.raises(UserError, match=why) as refused:
        read_ids(text)
    assert refused.value.exit_code == 2


def test_the_program_can_be_run_from_anywhere_whatever_stands_in_pythonpath(tmp_path: Path) -> None:
    program = install_engine(tmp_path / "it's a folder" / "engine")
    (tmp_path / "wildscav.py").write_text("raise RuntimeError('not this one')\n")
    done = subprocess.run(
        [program], cwd=tmp_path, env={"PYTHONPATH": str(tmp_path)}, capture_output=True, text=True
    )
    assert done.returncode == 2
    assert "no port is given" in done.stderr


def test_only_what_is_missing_is_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    maps = tmp_path / "w" / "maps"
    maps.mkdir(parents=True)
    write_map(103, maps)
    written = paths_of(103, maps)[0].stat().st_mtime_ns
    wildscav = partial(run_command, "legacy", cwd=tmp_path, columns=200)
    done = wildscav("install", "w", "--maps", "103")
    assert done.returncode == 0, done.stderr
    assert "0 maps made, 1 there already" in done.stdout
    assert 'engine_dir="' in done.stdout
    assert paths_of(103, maps)[0].stat().st_mtime_ns == written
    assert (tmp_path / "w" / "engine" / "fps.x86_64").stat().st_mode & 0o111
    assert missing_maps([103, 104], maps) == [104]


def test_a_folder_that_cannot_be_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    wildscav = partial(run_command, "legacy", cwd=tmp_path, columns=200)
    done = wildscav("install", "file", "--maps", "103")
    assert done.returncode == 1
    renamed, error = done.stderr.splitlines()
    assert renamed.startswith("wildscav: `wildscav legacy` is called `wildscav-legacy` now")
    assert error.startswith("wildscav: file")
