"""Packing a folder into the archive that is handed in."""

import os
import tarfile
from pathlib import Path

import pytest
from tests.leaderboard.agents import write_agent
from tests.leaderboard.seasons_made import make_season

from wildscav.errors import UserError
from wildscav_leaderboard.seasons.refusals import InvalidError
from wildscav_leaderboard.submissions.archives import check_archive
from wildscav_leaderboard.submissions.packing import pack


def packed(folder: Path) -> Path:
    archive = folder.with_name(f"{folder.name}.tar.gz")
    pack(folder, archive)
    return archive


def test_equal_folders_give_equal_archives_whatever_their_times_and_what_tools_left(tmp_path: Path) -> None:
    one, other = (write_agent(tmp_path / name, "walker") for name in ("one", "other"))
    os.utime(other / "agent.py", (1.0, 1.0))
    (other / ".git").mkdir()
    (other / ".git" / "config").write_text("secrets of mine")
    (other / "agent.py").rename(other / "real.py")
    (other / "real.py").rename(other / "agent.py")

    assert packed(one).read_bytes() == packed(other).read_bytes()


def test_programs_stay_programs_and_links_to_files_become_files(tmp_path: Path) -> None:
    folder = write_agent(tmp_path, "walker")
    (folder / "run.sh").write_text("#!/bin/sh\n")
    (folder / "run.sh").chmod(0o700)
    (folder / "again.sh").symlink_to("run.sh")

    with tarfile.open(packed(folder)) as archive:
        found = {info.name: (info.isreg(), info.mode) for info in archive}

    assert found["run.sh"] == found["again.sh"] == (True, 0o755)
    assert found["agent.py"] == (True, 0o644)


def test_a_link_to_a_folder_is_refused_and_nothing_is_left(tmp_path: Path) -> None:
    folder = write_agent(tmp_path, "walker")
    (folder / "lib").symlink_to(".")
    with pytest.raises(UserError, match="is a link to a folder, which no submission may have"):
        packed(folder)
    assert [path.name for path in tmp_path.iterdir()] == ["walker"]


def test_packing_ends_where_the_archive_becomes_too_large(tmp_path: Path) -> None:
    folder = write_agent(tmp_path, "walker")
    (folder / "zeros.bin").write_bytes(bytes(8 << 20))
    pack(folder, tmp_path / "small.tar.gz", largest=1)  # what counts is the archive
    (folder / "noise.bin").write_bytes(os.urandom(9 << 20))
    with pytest.raises(UserError, match=r"more than 1 MiB.* largest file is noise\.bin \(9 MiB\)"):
        pack(folder, tmp_path / "large.tar.gz", largest=1)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["small.tar.gz", "walker"]


def test_what_is_no_archive_is_not_named_by_the_seasons_own_name_for_it(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season")
    path = tmp_path / "submission.zip"
    path.write_bytes(b"no archive")
    with pytest.raises(InvalidError, match=r"^the archive cannot be unpacked: File is not a zip file$"):
        check_archive(path, season)
