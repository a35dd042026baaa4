"""The identity of an evaluation: everything that its scores depend on. It is saved with the results.

An evaluation is continued only if its identity is the same.
"""

from collections.abc import Iterable
from hashlib import blake2b
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field

from wildscav.errors import UserError
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.thinking import ClockChoice
from wildscav_evaluator.bounds import MAX_ROUNDS
from wildscav_evaluator.output.json_files import FileModel, FileModelError, WithOptionalFields
from wildscav_evaluator.output.layout import IDENTITY_FILE
from wildscav_evaluator.output.results import (
    KeptLimits,
    ModelTerms,
    OtherInterface,
    TournamentSettings,
    Versions,
)


class Entrant(WithOptionalFields):
    """A submission that is evaluated."""

    omitted = ("interface",)

    name: str
    version: str
    digest: str  # of the submission's folder
    tracks: tuple[str, ...]  # the evaluation's tracks that it plays
    interface: OtherInterface | None = None  # by which it plays; omitted for numbers


class Identity(WithOptionalFields):
    """Everything that the results of an evaluation depend on, and so not how many matches run at once."""

    omitted = ("tournament", "clock", "model")

    format: Literal[2] = 2
    versions: Versions
    suite: str
    seed: str  # or the beginning of the commitment, if it is hidden
    commitment: str | None = None  # of a hidden seed, in full
    rounds: Annotated[int, Field(ge=1, le=MAX_ROUNDS)] = 1  # of the suite, each with the next seed
    tracks: tuple[str, ...]
    matches: str  # digest of the specs of all matches
    submissions: tuple[Entrant, ...]
    sandbox: str  # the name of the sandbox in which agents run
    limits: dict[str, KeptLimits]  # of each agent in it, by track
    key: str | None = None  # public key of the organizer who signs the ledger, 64 hexadecimal digits
    model: ModelTerms | None = None  # that seats may ask; omitted if there is none
    tournament: TournamentSettings | None = None  # omitted if submissions are evaluated one by one
    clock: ClockChoice | None = None  # of all matches; omitted if they have the suite's own


def digest_of(specs: Iterable[MatchSpec]) -> str:
    """Return a digest of some matches, 32 hexadecimal digits."""
    digest = blake2b(digest_size=16)
    for spec in specs:
        digest.update(spec.model_dump_json().encode() + b"\n")
    return digest.hexdigest()


def read_identity(folder: Path) -> Identity | None:
    """Return the identity of the evaluation in an output folder; None if it has none.

    UserError if it is not of this version of Wildscav.
    """
    path = folder / IDENTITY_FILE
    try:
        return Identity.read(path)
    except FileNotFoundError:
        return None
    except FileModelError as error:
        raise UserError(
            f"{path} is not of this version of Wildscav ({error}): name another --out, or start over with "
            "--fresh"
        ) from error


def write_identity(identity: Identity, folder: Path) -> None:
    """Write the identity of the evaluation into its output folder."""
    identity.write(folder / IDENTITY_FILE)


def difference(old: Identity, new: Identity) -> str:
    """Return the first difference between two evaluations in a few words; an empty text if they agree."""
    for field in Identity.model_fields:
        was, wanted = getattr(old, field), getattr(new, field)
        if was == wanted:
            continue
        if field == "submissions":
            return _difference_of_submissions(was, wanted)
        if field == "limits":
            return _difference_of_limits(was, wanted)
        if field == "matches":
            return "its matches are different"
        if field == "versions":
            return f"it was begun by {was}, and this is {wanted}"
        if field == "tournament":
            return _difference_of_tournaments(was, wanted)
        if field == "model":
            return _difference_of_models(was, wanted)
        if field == "key":
            return f"it is {_signed(was)}, not {_signed(wanted)}"
        verb = "are" if field in ("tracks", "rounds") else "is"
        return f"its {field.replace('_', ' ')} {verb} {_listed(was)}, not {_listed(wanted)}"
    return ""


def _difference_of_submissions(old: tuple[Entrant, ...], new: tuple[Entrant, ...]) -> str:
    before, after = [one.name for one in old], [one.name for one in new]
    if before != after:
        return f"it is of {', '.join(before)}, not of {', '.join(after)}"
    was, wanted = next((a, b) for a, b in zip(old, new, strict=True) if a != b)
    if was.version != wanted.version:
        return f"it is of {was.name} {was.version}, not {wanted.version}"
    if was.digest != wanted.digest:
        return f"the files of {was.name} have changed since"
    return f"{was.name} plays {', '.join(was.tracks)}, not {', '.join(wanted.tracks)}"


def _difference_of_tournaments(old: TournamentSettings | None, new: TournamentSettings | None) -> str:
    if old is None or new is None:
        return "it is no tournament" if old is None else "it is a tournament"
    name, was, wanted = _other_field(old, new)
    return f"its {name.replace('_', ' ')} is {_listed(was) or 'none'}, not {_listed(wanted) or 'none'}"


def _difference_of_models(old: ModelTerms | None, new: ModelTerms | None) -> str:
    if old is None or new is None:
        return "its agents may ask no model" if old is None else "its agents may ask a model"
    name, was, wanted = _other_field(old, new)
    return f"its model's {name.replace('_', ' ')} is {was}, not {wanted}"


def _signed(key: str | None) -> str:
    return "unsigned" if key is None else f"signed with the key {key}"


def _difference_of_limits(old: dict[str, KeptLimits], new: dict[str, KeptLimits]) -> str:
    if old.keys() != new.keys():
        return "its limits are of other tracks"
    track = next(track for track in new if new[track] != old[track])
    name, was, wanted = _other_field(old[track], new[track])
    return f"its limit of {name} on {track} is {_limit(was)}, not {_limit(wanted)}"


def _other_field(old: FileModel, new: FileModel) -> tuple[str, Any, Any]:
    """Return the first field in which two models differ, with its value in each."""
    return next((name, was, one) for name, one in new if (was := getattr(old, name)) != one)


def _limit(value: float | None) -> str:
    return "none" if value is None else f"{value:,.15g}"


def _listed(value: object) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)
