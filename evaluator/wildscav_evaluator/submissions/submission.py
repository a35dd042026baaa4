"""A submission: a folder with ``submission.toml`` and code, checked before any code runs."""

import hashlib
import os
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, Literal

from wildscav.sdk.submission_folder import MANIFEST
from wildscav_evaluator.submission_files import (
    LEFT_OUT,
    is_executable,
    submission_files,
)
from wildscav_evaluator.submissions.archives import SUFFIXES, is_archive, unpack
from wildscav_server.hosting.manifest import Manifest, SubmissionError, read_manifest

NO_MODEL = "the submission asks a language model, and the season offers none"


@dataclass(frozen=True)
class Submission:
    """A submission that may be played."""

    folder: Path  # absolute
    manifest: Manifest
    digest: str  # of the submission's files, or of the image; 32 hexadecimal digits
    content: str = ""  # digest of what plays: without the labels in the manifest; empty for an image
    image: str | None = None  # the image that it was built into or is
    entered_as: str | None = None  # another name for it, where several submissions have its name
    files: Mapping[bytes, str] = field(default_factory=dict, repr=False, compare=False)  # digests by path

    @property
    def name(self) -> str:
        """Its name, as the manifest gives it unless it is entered under another one."""
        return self.entered_as or self.manifest.name

    @property
    def interface(self) -> Literal["words", "keys"] | None:
        """The interface by which it plays; None for numbers."""
        return None if self.manifest.interface == "numbers" else self.manifest.interface

    @property
    def sensors(self) -> dict[str, dict[str, Any]]:
        """The sensors of its seat, with their options."""
        if self.interface is None:
            return self.manifest.sensors
        if self.interface == "keys":
            return self.manifest.sensors or {"screen": {}}
        from wildscav_language.senses import sensors  # loads NumPy, which most commands can do without

        return sensors(pictures=self.manifest.pictures)


def load_submission(folder: Path) -> Submission:
    """Read and check a submission: a folder, or an archive of one. None of its code runs.

    SubmissionError if it is not valid; one line says which file and field, and what is allowed.
    """
    if folder.is_file() and is_archive(folder):
        return _load_archive(folder)
    if not folder.is_dir():
        what = "is a file, not a folder" if folder.exists() else "does not exist"
        allowed = f"give a folder with a {MANIFEST} in it, or one as {', '.join(SUFFIXES)}"
        raise SubmissionError(f"submission {folder} {what}: {allowed}")
    path = folder / MANIFEST
    if not path.is_file():
        raise SubmissionError(f"{path} is missing: `wildscav init DIR` makes a folder with one")
    manifest = read_manifest(path)
    _check_program(path, manifest, submission_files(folder))
    files = dict(_hashed_files(folder))
    content = _digest_of(_content(files, manifest))
    return Submission(folder.resolve(), manifest, _digest_of(files), content, files=files)


def check_unchanged(submission: Submission) -> None:
    """SubmissionError if a file of a submission is no longer as it was read.

    New files are not looked at: agents without a sandbox may write some.
    """
    for name, digest in submission.files.items():
        path = submission.folder / os.fsdecode(name)
        try:
            is_same = _file_digest(path) == digest
        except OSError:
            is_same = False
        if not is_same:
            raise SubmissionError(
                f"{path} was changed while {submission.name!r} was being played: put it back and run the "
                "same command again to play the rest, or start over with --fresh"
            )


def _load_archive(archive: Path) -> Submission:
    """Read and check a submission in an archive, whose path stands in errors for that of its folder."""
    folder = unpack(archive)
    if not (folder / MANIFEST).is_file():
        raise SubmissionError(f"{archive} has no {MANIFEST} at its top or in its single folder")
    try:
        return load_submission(folder)
    except SubmissionError as error:
        raise SubmissionError(str(error).replace(str(folder), str(archive))) from error


def _check_program(path: Path, manifest: Manifest, files: Sequence[Path]) -> None:
    """Refuse a manifest whose program is not among the files of its submission."""
    if manifest.entry_point is not None:
        module, _, _ = manifest.entry_point.partition(":")
        base = path.parent.joinpath(*module.split("."))
        file = base.with_suffix(".py")
        if file not in files and base / "__init__.py" not in files:
            reason = _missing(file, path.parent)
            raise SubmissionError(f"{path}: entry_point: is {manifest.entry_point!r}, but {reason}")
    elif manifest.command is not None:
        _check_command(path, manifest.command[0], files)


def _missing(file: Path, folder: Path) -> str:
    if LEFT_OUT.isdisjoint(file.relative_to(folder).parts):
        return f"there is no file {file}"
    return f"{', '.join(sorted(LEFT_OUT))} are not part of a submission"


def _check_command(path: Path, program: str, files: Sequence[Path]) -> None:
    """Refuse a relative path that is not an executable file of the submission.

    A name without a slash is looked up in the PATH of the sandbox.
    """
    if not program:
        raise SubmissionError(f"{path}: command: is {program!r}, must name a program")
    if "/" not in program or PurePosixPath(program).is_absolute():
        return
    file = path.parent / program
    if file not in files:
        raise SubmissionError(f"{path}: command: is {program!r}, but {_missing(file, path.parent)}")
    if not is_executable(file):
        raise SubmissionError(f"{path}: command: {file} is not executable: chmod +x {file}")


def folder_digest(folder: Path) -> str:
    """Return a digest of the files of a submission: their paths, their contents, and which are executable."""
    return _digest_of(dict(_hashed_files(folder)))


def _digest_of(files: Mapping[bytes, str]) -> str:
    digest = hashlib.blake2b(digest_size=16)
    for name, content in files.items():
        digest.update(name + f"\0{content}\n".encode())
    return digest.hexdigest()


def _content(files: Mapping[bytes, str], manifest: Manifest) -> dict[bytes, str]:
    """Return the digests of a submission's files; of its manifest, only fields that change how it plays."""
    fields = {"entry_point", "command", "sensors"}
    if manifest.interface != "numbers":  # so that digests of others stay as they were
        fields |= {"interface", "pictures"}
    plays = manifest.model_dump_json(include=fields)
    return {**files, MANIFEST.encode(): plays}


def _hashed_files(folder: Path) -> Iterator[tuple[bytes, str]]:
    """Yield the path of each file of a submission, and a digest that says whether it is executable."""
    for path in submission_files(folder):
        yield os.fsencode(path.relative_to(folder).as_posix()), _file_digest(path)  # a name need not be UTF-8


def _file_digest(path: Path) -> str:
    with path.open("rb") as file:
        content = hashlib.file_digest(file, "blake2b").hexdigest()
    return content + ("\0executable" if is_executable(path) else "")
