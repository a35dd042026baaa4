"""Which files of a folder are a submission, and in which folder its agents run."""

from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav_evaluator.submission_files import stage, submission_files
from wildscav_evaluator.submissions.submission import folder_digest
from wildscav_server.hosting.manifest import SubmissionError

FILES = {"agent.py": 0o644, "lib/helper.py": 0o644, "lib/run.sh": 0o755}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A submission's folder with nothing else in it."""
    folder = tmp_path / "agent"
    (folder / "lib").mkdir(parents=True)
    for name, mode in FILES.items():
        (folder / name).write_text(name)
        (folder / name).chmod(mode)
    return folder


def as_left_by_tools(folder: Path) -> None:
    for name in ("__pycache__", ".git", "lib/__pycache__", ".venv/lib"):
        (folder / name).mkdir(parents=True)
        (folder / name / "helper.cpython-311.pyc").write_bytes(b"compiled")
    (folder / ".venv" / "lib64").symlink_to("/usr")


def test_a_folder_with_nothing_else_is_where_its_agents_run(folder: Path, tmp_path: Path) -> None:
    assert stage(folder, tmp_path / "private") == folder
    assert not (tmp_path / "private").exists()


@pytest.mark.parametrize(
    "spoil",
    [
        as_left_by_tools,
        lambda folder: (folder / "lib" / ".git").write_text("gitdir: elsewhere"),
        lambda folder: (folder / "lib" / "empty").mkdir(),
        lambda folder: (folder / "lib" / "nowhere").symlink_to("nothing"),
        lambda folder: (folder / "agent.py").chmod(0o600),
        lambda folder: (folder / "agent.py").chmod(0o645),  # only others could run it
        lambda folder: (folder / "lib" / "run.sh").chmod(0o744),
        lambda folder: (folder / "lib" / "run.sh").chmod(0o4755),  # would run as its owner
        lambda folder: (folder / "lib").chmod(0o700),
        lambda folder: folder.chmod(0o700),
    ],
    ids=["tools", "file", "empty", "link", "private", "others", "owner", "setuid", "closed", "closed root"],
)
def test_what_is_not_of_the_submission_changes_neither_its_digest_nor_what_runs(
    folder: Path, tmp_path: Path, spoil: Callable[[Path], object]
) -> None:
    digest = folder_digest(folder)
    spoil(folder)

    copy = stage(folder, tmp_path / "private")

    assert folder_digest(folder) == folder_digest(copy) == digest
    assert copy != folder
    modes = {str(path.relative_to(copy)): path.stat().st_mode & 0o7777 for path in copy.rglob("*")}
    assert modes == FILES | {"lib": 0o755}
    assert stage(copy, tmp_path) == copy


@pytest.mark.parametrize(
    "change",
    [
        lambda folder: (folder / "agent.py").chmod(0o755),
        lambda folder: (folder / "lib" / "run.sh").chmod(0o644),
        lambda folder: (folder / "agent.pyc").write_bytes(b"runs without a source"),
        lambda folder: (folder / "again.py").symlink_to("agent.py"),
    ],
    ids=["executable", "not executable", "compiled", "link"],
)
def test_what_can_change_what_an_agent_does_changes_the_digest(
    folder: Path, change: Callable[[Path], object]
) -> None:
    digest = folder_digest(folder)
    change(folder)
    assert folder_digest(folder) != digest


def test_a_link_counts_as_the_file_that_it_leads_to(folder: Path, tmp_path: Path) -> None:
    (folder / ".venv").mkdir()
    (folder / ".venv" / "real.py").write_text("linked")
    (folder / "linked.py").symlink_to(".venv/real.py")

    copy = stage(folder, tmp_path / "private")

    assert not (copy / "linked.py").is_symlink()
    assert (copy / "linked.py").read_text() == "linked"


def test_a_link_to_a_folder_is_refused(folder: Path) -> None:
    (folder / "other").symlink_to("lib")
    with pytest.raises(SubmissionError, match="other is a link to a folder, which no submission may have"):
        submission_files(folder)


def test_a_folder_that_cannot_be_read_is_not_passed_over(tmp_path: Path) -> None:
    with pytest.raises(SubmissionError, match="gone cannot be read: No such file or directory"):
        submission_files(tmp_path / "gone")
