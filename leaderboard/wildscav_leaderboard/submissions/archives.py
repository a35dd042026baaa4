"""The archives that teams hand in: checked before anything of them is stored, and kept by their digest."""

import hashlib
import os
from dataclasses import dataclass
from pathlib import Path

from wildscav.errors import UserError
from wildscav_evaluator.submissions.archives import SUFFIXES, unpack
from wildscav_evaluator.submissions.submission import NO_MODEL, Submission, load_submission
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.seasons.refusals import InvalidError, TooLargeError
from wildscav_server.hosting.manifest import Manifest

UNPACKED = 10  # times the largest archive; the content of one may be as large


@dataclass(frozen=True)
class CheckedArchive:
    """An archive with a valid submission in it. None of its code has run."""

    path: Path
    suffix: str
    manifest: Manifest
    tracks: list[str]  # of the season that its manifest names
    digest: str  # of the folder's content
    content: str  # digest of what plays: without the version and the other labels in the manifest
    sha256: str  # of the archive
    size: int  # bytes


def checked_suffix(suffix: str) -> str:
    """Return the suffix of an archive.

    Raises:
        InvalidError: It is of no kind of archive that is allowed.
    """
    if suffix not in SUFFIXES:
        raise InvalidError(f"an archive must be one of {', '.join(SUFFIXES)}")
    return suffix


def check_archive(path: Path, season: Season) -> CheckedArchive:
    """Check an archive that was uploaded into a folder of its own, where it is unpacked, too.

    Raises:
        RefusalError: It is too large, not an archive, or holds no submission for the tracks of the season; it
            says so in one line.
    """
    size, largest = path.stat().st_size, season.settings.quotas.archive << 20
    if size > largest:
        raise TooLargeError(
            f"the archive has {size / (1 << 20):,.1f} MiB, may have {season.settings.quotas.archive} at most"
        )
    try:
        submission = load_submission(unpack(path, path.parent / "unpacked", UNPACKED * largest))
    except UserError as error:
        raise InvalidError(_without_folders(str(error), path)) from None
    tracks = [track for track in season.settings.tracks if track in submission.manifest.tracks]
    if not tracks:
        raise InvalidError(
            f"the submission plays {', '.join(submission.manifest.tracks)}, and the season has only "
            f"{', '.join(season.settings.tracks)}"
        )
    if submission.manifest.model and season.settings.model is None:
        raise InvalidError(NO_MODEL)
    suffix = next(suffix for suffix in SUFFIXES if path.name.endswith(suffix))
    with path.open("rb") as file:
        sha256 = hashlib.file_digest(file, "sha256").hexdigest()
    digests = submission.digest, submission.content
    return CheckedArchive(path, suffix, submission.manifest, tracks, *digests, sha256, size)


def _without_folders(text: str, path: Path) -> str:
    """Return an error without the paths of our machine, which are nothing to a competitor."""
    text = text.replace(str(path), "the archive")
    for folder in (path.parent / "unpacked").glob("*"):
        text = text.replace(f"{folder}{os.sep}", "")
    return text


def archive_name(archive: CheckedArchive) -> str:
    """Return the name of an archive's file in the season's files."""
    return f"{archive.sha256}{archive.suffix}"


def store_archive(archive: CheckedArchive, season: Season) -> None:
    """Move an archive into the season's files, on whose disk it is, whole or not at all.

    Raises:
        OSError: The disk cannot be written.
    """
    season.archives.mkdir(parents=True, exist_ok=True)
    with archive.path.open("rb") as file:
        os.fsync(file.fileno())
    archive.path.replace(season.archives / archive_name(archive))


def load_archive(season: Season, name: str, entrant: str) -> Submission:
    """Return the submission in a stored archive, ready to be played under its name in the season.

    Raises:
        UserError: The archive is missing, or cannot be unpacked here.
    """
    from dataclasses import replace

    path = season.archives / name
    if not path.is_file():
        raise UserError(f"the archive {path} is missing")
    return replace(load_submission(path), entered_as=entrant)
