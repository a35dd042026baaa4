"""The archive that a submission is handed in as."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.submissions.archives import SUFFIXES, is_archive
from wildscav_evaluator.submissions.submission import Submission

FOLDER_SUFFIX = ".tar.gz"


@contextmanager
def archive_of(named: Path, submission: Submission, largest: int) -> Iterator[tuple[Path, str]]:
    """Give the archive of a submission and its suffix; a folder is packed for as long as it is needed.

    Args:
        named: What the user named: a folder, an archive or a baseline.
        submission: The submission in it.
        largest: MiB that the archive may have.

    Raises:
        UserError: It is an image, which only its own machine has, or too large.
        OSError: It cannot be packed.
    """
    from wildscav_leaderboard.submissions.packing import pack

    if submission.image is not None:
        raise UserError(f"{named} is an image on this machine: submit a folder or an archive", exit_code=2)
    if named.is_file() and is_archive(named):
        if named.stat().st_size > largest << 20:
            raise UserError(f"{named} has more than {largest} MiB, which is the most that the season takes")
        yield named, next(suffix for suffix in SUFFIXES if named.name.lower().endswith(suffix))
        return
    with tempfile.TemporaryDirectory(prefix="wildscav-") as folder:
        archive = Path(folder) / f"submission{FOLDER_SUFFIX}"
        pack(submission.folder, archive, largest)
        yield archive, FOLDER_SUFFIX
