"""Submissions arrive on another machine as they were sent."""

from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav.errors import UserError
from wildscav_evaluator.executors.cluster import submission_archives
from wildscav_evaluator.executors.cluster.submission_archives import arrived, pack
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_server.hosting.manifest import SubmissionError


@pytest.fixture
def folder(submit: Submit, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """A submission with all that a folder may have."""
    monkeypatch.setenv("WILDSCAV_CACHE_DIR", str(tmp_path / "node's cache"))
    folder = submit("walker", WALKER).folder
    (folder / "weights" / "empty").mkdir(parents=True)
    (folder / "weights" / "large.bin").write_bytes(bytes(range(256)) * 1000)
    (folder / "current").symlink_to("weights/large.bin")
    (folder / "play.sh").write_text("#!/bin/sh\n")
    (folder / "play.sh").chmod(0o755)
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__" / "agent.pyc").touch()
    return folder


def test_a_submission_arrives_with_the_same_digest_and_all_of_its_files(folder: Path) -> None:
    sent = load_submission(folder)

    there = arrived(pack(folder), sent.digest)

    assert load_submission(there).digest == sent.digest
    assert (there / "current").read_bytes() == (there / "weights" / "large.bin").read_bytes()
    assert not (there / "current").is_symlink()
    assert (there / "play.sh").stat().st_mode & 0o100
    assert not (there / "__pycache__").exists()
    assert there.stat().st_mode & 0o005 == 0o005  # agents run as another user


def test_a_submission_is_packed_into_the_same_bytes_whenever_it_was_written(folder: Path) -> None:
    before = pack(folder)
    (folder / "play.sh").touch()
    assert pack(folder) == before


def test_a_copy_that_was_changed_on_the_node_is_not_used_again(folder: Path) -> None:
    digest = load_submission(folder).digest
    first = arrived(pack(folder), digest)
    assert arrived(pack(folder), digest) == first
    (first / "agent.py").write_text("something else")

    again = arrived(pack(folder), digest)

    assert again != first
    assert load_submission(again).digest == digest


def test_another_submission_than_expected_is_refused(folder: Path) -> None:
    with pytest.raises(SubmissionError, match="arrived with other content"):
        arrived(pack(folder), "0" * 32)


def test_a_submission_that_is_too_large_to_send_is_refused(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(submission_archives, "LARGEST_CONTENT", 100_000)
    with pytest.raises(UserError, match="build an image of it on every node"):
        pack(folder)
