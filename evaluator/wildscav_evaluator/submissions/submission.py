"""A submission: a folder with ``submission.toml`` and code, checked before any code runs."""

import hashlib
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from wildscav_evaluator.submission_files import (
    LEFT_OUT,
    SubmissionError,
    is_executable,
    submission_files,
)
from wildscav_evaluator.submissions.archives import SUFFIXES, is_archive, unpack

MANIFEST = "submission.toml"
LARGEST_MANIFEST = 16_384  # bytes; the most expensive one of this size takes 260 MB and half a second to read
LONGEST_SHOWN = 100  # characters of a value in an error

_NAME = r"^[a-z0-9][a-z0-9-]{1,39}$"
_ENTRY_POINT = r"^[A-Za-z_]\w*(\.[A-Za-z_]\w*)*:[A-Za-z_]\w*$"
# Hints for people, in place of pydantic's messages, which would show a pattern.
_HINTS = {
    "name": "2 to 40 of a-z, 0-9 and -, a letter or digit first",
    "version": 'text of 1 to 40 of A-Z, a-z, 0-9 and . + - _, a letter or digit first, such as "1.0.0"',
    "entry_point": 'text of the form "module:Class", such as "agent:MyAgent"',
    "command": 'a list of texts, such as ["node", "agent.js"]',
    "author": "text of at most 200 characters",
    "authors": "a list of 1 to 50 texts of at most 200 characters",
    "description": "text of at most 2,000 characters",
    "license": "text of at most 200 characters",
    "url": "text of at most 500 characters that begins with https:// or http://",
}


_Name = Annotated[str, Field(max_length=200)]
_Word = Annotated[str, Field(max_length=4096, pattern=r"^[^\x00]*$")]


class Manifest(BaseModel):
    """The content of ``submission.toml``."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    name: Annotated[str, Field(pattern=_NAME)]
    version: Annotated[str, Field(pattern=r"^[A-Za-z0-9][A-Za-z0-9.+_-]{0,39}$")]
    entry_point: Annotated[str | None, Field(pattern=_ENTRY_POINT)] = None  # for an agent in Python
    command: Annotated[tuple[_Word, ...] | None, Field(min_length=1, max_length=100)] = None  # for any other
    tracks: Annotated[tuple[str, ...], Field(min_length=1)]
    sensors: dict[str, dict[str, Any]] = {}
    # Fields for people only.
    author: Annotated[str | None, Field(max_length=200)] = None
    authors: Annotated[tuple[_Name, ...] | None, Field(min_length=1, max_length=50)] = None
    description: Annotated[str | None, Field(max_length=2000)] = None
    license: Annotated[str | None, Field(max_length=200)] = None
    url: Annotated[str | None, Field(max_length=500, pattern=r"^https?://\S+$")] = None

    @field_validator("tracks")
    @classmethod
    def _tracks_exist(cls, tracks: tuple[str, ...]) -> tuple[str, ...]:
        from wildscav_engine.tracks import TRACKS

        for track in tracks:
            if track not in TRACKS:
                raise ValueError(f"there is no track {track!r}; the tracks are {', '.join(TRACKS)}")
        if len(set(tracks)) < len(tracks):
            raise ValueError(f"a track is named twice: {', '.join(tracks)}")
        return tracks

    @field_validator("sensors")
    @classmethod
    def _sensors_are_understood(cls, sensors: dict[str, dict[str, Any]]) -> dict[str, dict[str, Any]]:
        from wildscav_engine.sensors import parse_sensors

        parse_sensors(sensors)
        return sensors


@dataclass(frozen=True)
class Submission:
    """A submission that may be played."""

    folder: Path  # absolute
    manifest: Manifest
    digest: str  # of the submission's files, or of the image; 32 hexadecimal digits
    content: str = ""  # digest of what plays: without the labels in the manifest; empty for an image
    image: str | None = None  # the image that it was built into or is
    entered_as: str | None = None  # another name for it, where several submissions have its name

    @property
    def name(self) -> str:
        """Its name, as the manifest gives it unless it is entered under another one."""
        return self.entered_as or self.manifest.name


def load_submission(folder: Path) -> Submission:
    """Read and check a submission: a folder, or an archive of one. None of its code runs.

    Raises:
        SubmissionError: It is not valid; one line says which file and field, and what is allowed.
    """
    if folder.is_file() and is_archive(folder):
        folder = unpack(folder)
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
    return Submission(folder.resolve(), manifest, _digest_of(files), _digest_of(_content(files, manifest)))


def read_manifest(path: Path) -> Manifest:
    """Read and check a manifest.

    Raises:
        SubmissionError: It is not valid; one line says which field, and what is allowed.
    """
    return _parse(path, _read_toml(path))


def _read_toml(path: Path) -> dict[str, Any]:
    if path.stat().st_size > LARGEST_MANIFEST:
        raise SubmissionError(
            f"{path} has {path.stat().st_size:,} bytes, may have {LARGEST_MANIFEST:,} at most"
        )
    try:
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except RecursionError:
        raise SubmissionError(f"{path} is not valid TOML: it is nested too deeply") from None
    except ValueError as error:  # invalid TOML or UTF-8, or a number with thousands of digits
        raise SubmissionError(f"{path} is not valid TOML: {error}") from error


def _parse(path: Path, content: Mapping[str, Any]) -> Manifest:
    try:
        manifest = Manifest.model_validate(content)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        field = ".".join(str(part) for part in first["loc"])
        raise SubmissionError(f"{path}: {field}: {_explain(first)}") from error
    if manifest.entry_point is None and manifest.command is None:
        raise SubmissionError(
            f"{path}: entry_point: is missing: {_HINTS['entry_point']}; or, for a program in another "
            f"language, command: {_HINTS['command']}"
        )
    if manifest.entry_point is not None and manifest.command is not None:
        raise SubmissionError(
            f"{path}: command: excludes entry_point: give entry_point for an agent in Python, or "
            "command for any other program"
        )
    return manifest


def _explain(error: Any) -> str:
    """Return what is wrong with a field, and what is allowed."""
    field = str(error["loc"][0])
    match error["type"]:
        case "missing":
            hint = f": {_HINTS[field]}" if field in _HINTS else ""
            return f"is missing{hint}"
        case "extra_forbidden":
            return f"is not a field; the fields are {', '.join(Manifest.model_fields)}"
        case "value_error":
            return str(error["ctx"]["error"])
        case _ if field in _HINTS:
            return f"is {_shown(error['input'])}, must be {_HINTS[field]}"
        case _:
            return f"is {_shown(error['input'])}: {error['msg']}"


def _shown(value: object) -> str:
    """Return a value for an error message, shortened if it is too long."""
    try:
        text = repr(value)
    except RecursionError:
        return "nested too deeply"
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


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
    """Return a digest of the files of a submission: their paths, their contents, and which are executable.

    Raises:
        SubmissionError: See ``submission_files``.
    """
    return _digest_of(dict(_hashed_files(folder)))


def _digest_of(files: Mapping[bytes, str]) -> str:
    digest = hashlib.blake2b(digest_size=16)
    for name, content in files.items():
        digest.update(name + f"\0{content}\n".encode())
    return digest.hexdigest()


def _content(files: Mapping[bytes, str], manifest: Manifest) -> dict[bytes, str]:
    """Return the digests of a submission's files; of its manifest, only fields that change how it plays."""
    plays = manifest.model_dump_json(include={"entry_point", "command", "sensors"})
    return {**files, MANIFEST.encode(): plays}


def _hashed_files(folder: Path) -> Iterator[tuple[bytes, str]]:
    """Yield the path of each file of a submission, and a digest that says whether it is executable."""
    for path in submission_files(folder):
        with path.open("rb") as file:
            content = hashlib.file_digest(file, "blake2b").hexdigest()
        mark = "\0executable" if is_executable(path) else ""
        yield os.fsencode(path.relative_to(folder).as_posix()), f"{content}{mark}"  # a name need not be UTF-8
