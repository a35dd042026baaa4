"""The manifest of a submission, ``submission.toml``: its fields, and what is allowed in each.

``wildscav.sdk`` reads of it only what it needs to start an agent, because agents come without pydantic.
"""

import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from wildscav.errors import UserError

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
    "interface": '"numbers" (the default), "words" or "keys"',
    "pictures": "true or false",
    "model": "true or false",
    "author": "text of at most 200 characters",
    "authors": "a list of 1 to 50 texts of at most 200 characters",
    "description": "text of at most 2,000 characters",
    "license": "text of at most 200 characters",
    "url": "text of at most 500 characters that begins with https:// or http://",
}


Interface = Literal["numbers", "words", "keys"]
DRAWN_BY = ("width", "height", "shadows", "quality")  # options of a screen that do not widen what it shows

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
    interface: Interface = "numbers"
    pictures: bool = False  # whether a seat of words has a camera
    model: bool = False  # whether it plays only where it may ask a language model
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


class SubmissionError(UserError):
    """A submission's folder or one of its files is not valid."""

    def __init__(self, message: str) -> None:
        super().__init__(message, exit_code=2)


def read_manifest(path: Path) -> Manifest:
    """Read and check a manifest.

    Raises:
        SubmissionError: It is not valid; one line says which field, and what is allowed.
    """
    return _parse(path, _read_toml(path))


def check_plays_numbers(path: Path, manifest: Manifest) -> None:
    """Raise a SubmissionError if a submission plays by words or keys, or asks a model."""
    if manifest.interface != "numbers":
        raise SubmissionError(
            f"{path}: interface: is {manifest.interface!r}; here, agents must play by numbers (`wildscav "
            "play` and evaluations take all)"
        )
    if manifest.model:
        raise SubmissionError(f"{path}: model: is true; here, agents cannot ask a language model")


def _read_toml(path: Path) -> dict[str, Any]:
    try:
        size = path.stat().st_size
        if size > LARGEST_MANIFEST:
            raise SubmissionError(f"{path} has {size:,} bytes, may have {LARGEST_MANIFEST:,} at most")
        return tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise SubmissionError(f"cannot read {path}: {error.strerror}") from None
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
    if problem := _problem_of_interface(manifest):
        raise SubmissionError(f"{path}: {problem}")
    return manifest


def _problem_of_interface(manifest: Manifest) -> str:
    """Return what a manifest asks for that its interface does not have; an empty text if nothing."""
    if manifest.pictures and manifest.interface != "words":
        return 'pictures: is for interface = "words"; others name a sensor'
    if manifest.interface == "words" and manifest.sensors:
        return "sensors: a seat of words has its own; it may only have a camera: pictures = true"
    if manifest.interface != "keys":
        return ""
    others = [name for name in manifest.sensors if name != "screen"]
    if others:
        return f"sensors.{others[0]}: a seat of keys has its screen alone"
    wide = [option for option in manifest.sensors.get("screen", ()) if option not in DRAWN_BY]
    if wide:
        return f"sensors.screen.{wide[0]}: of a seat of keys, only {', '.join(DRAWN_BY)} may be chosen"
    return ""


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
