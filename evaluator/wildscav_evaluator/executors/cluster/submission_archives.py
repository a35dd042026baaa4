"""Submissions as archives that travel to nodes: packed once, and unpacked with the same digest.

Unlike archives of competitors (``submissions/archives.py``), these come from this program itself, after it
has checked the submission.
"""

import contextlib
import io
import tarfile
import tempfile
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.cache import cache_folder, is_kept, prune
from wildscav_evaluator.submission_files import add_files, submission_files
from wildscav_evaluator.submissions.archives import LARGEST_CONTENT
from wildscav_evaluator.submissions.submission import folder_digest
from wildscav_server import leftovers
from wildscav_server.hosting.manifest import SubmissionError

KEPT = "shipped-submissions"  # the folder in a node's cache


def pack(folder: Path) -> bytes:
    """Return an archive of a submission's files; UserError if they are too large to be sent."""
    size = sum(path.stat().st_size for path in submission_files(folder))
    if size > LARGEST_CONTENT:
        raise UserError(
            f"{folder} has {size >> 20:,} MiB of files, and a cluster gets {LARGEST_CONTENT >> 20:,} MiB of "
            "each submission at most: build an image of it on every node, and name that as image:NAME"
        )
    buffer = io.BytesIO()
    with tarfile.open(fileobj=buffer, mode="w", format=tarfile.PAX_FORMAT) as archive:
        add_files(archive, folder)
    return buffer.getvalue()


def arrived(archive: bytes, digest: str) -> Path:
    """Return a folder with the content of an archive, from this machine's cache if it is there unchanged.

    SubmissionError if it has another digest than the folder that was packed.
    """
    target = cache_folder(KEPT) / digest
    if not is_kept(target):
        _unpack_new(archive, target)
    if _is_intact(target, digest):
        return target
    # An agent without a sandbox may have written into the shared copy.
    own = Path(tempfile.mkdtemp(prefix="submission-", dir=leftovers.own_folder()))
    _unpack(archive, own)
    if not _is_intact(own, digest):
        raise SubmissionError(f"a submission arrived with other content than {digest}")
    return own


def _unpack_new(archive: bytes, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    prune(target.parent)
    with leftovers.temporary_folder_in(target.parent, "unpacking-") as fresh:
        _unpack(archive, fresh)
        with contextlib.suppress(OSError):  # another process was quicker
            fresh.rename(target)


def _unpack(archive: bytes, folder: Path) -> None:
    folder.chmod(0o755)
    try:
        with tarfile.open(fileobj=io.BytesIO(archive)) as file:
            file.extractall(folder, filter="data")
    except tarfile.TarError as error:
        raise SubmissionError(f"a submission could not be unpacked: {error}") from None


def _is_intact(folder: Path, digest: str) -> bool:
    with contextlib.suppress(SubmissionError, OSError):
        return folder_digest(folder) == digest
    return False
