"""An organizer's own suite: a TOML file that describes which maps and matches a suite draws.

It may set every field of a ``MapConfig`` and a ``MatchSpec``: either to one value for all maps or matches, or
to a list of values from which each map or match draws one.
"""

import tomllib
from collections.abc import Callable, Iterator, Mapping
from copy import deepcopy
from hashlib import blake2b
from itertools import pairwise, product
from math import prod
from pathlib import Path
from typing import Annotated, Any, Self, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationError,
    field_validator,
    model_validator,
)

from wildscav.errors import UserError, describe
from wildscav.terminal.suggestions import did_you_mean
from wildscav_engine.arithmetic.random_numbers import RandomStream
from wildscav_engine.maps import MapError
from wildscav_engine.maps.catalogue import map_spec
from wildscav_engine.record import RecordError, check_recordable
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec
from wildscav_engine.specs.validation import one_line
from wildscav_engine.storage.files import read_limited
from wildscav_engine.tracks import TRACKS
from wildscav_evaluator.bounds import MAX_MATCHES
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS, Limits
from wildscav_evaluator.seats import shuffled
from wildscav_evaluator.suites.match_drawing import choose
from wildscav_evaluator.suites.suite import SUITES, Suite, TrackSettings
from wildscav_inspect.config_files import LARGEST, read_config
from wildscav_server.time_limits import Clock

SUFFIX = ".toml"
MAX_COMBINATIONS = 2_000  # of the choices of one section that are all checked
SET_BY_SUITE = ("track", "map", "seed")  # fields of a match that the file may not set

AnySpec = TypeVar("AnySpec", bound=Spec)
Count = Annotated[int, Field(ge=1, le=10_000)]
Maps = Annotated[
    Annotated[Count, Tag("count")]
    | Annotated[list[int], Field(min_length=1, max_length=10_000), Tag("numbers")],
    Discriminator(lambda given: "numbers" if isinstance(given, list) else "count"),
]
Fields = dict[str, Any]
Choices = dict[str, Annotated[list[Any], Field(min_length=1)]]  # by the field's path, with dots


class Section(BaseModel):
    """Base of the models of the file and its parts."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)


class MapSection(Section):
    """The maps to draw."""

    fields: Fields = {}
    choose: Choices = {}


class TrackSection(Section):
    """The matches of one track."""

    maps: Maps  # how many to draw, or the numbers of known ones
    episodes: Count = 1  # on each map
    shuffle: bool = True  # whether to shuffle the seats of each match
    match: Fields = {}
    choose: Choices = {}
    limits: Limits = DEFAULT_LIMITS  # of agents

    @model_validator(mode="after")
    def _has_an_end(self) -> Self:
        maps = len(self.maps) if isinstance(self.maps, list) else self.maps
        if maps * self.episodes > MAX_MATCHES:
            raise ValueError(
                f"{maps} maps with {self.episodes} episodes are more than {MAX_MATCHES:,} matches"
            )
        return self

    @field_validator("match", "choose")
    @classmethod
    def _leaves_the_rest(cls, fields: Fields) -> Fields:
        for name in fields:
            if name.partition(".")[0] in SET_BY_SUITE:
                raise ValueError(f"{name} is set by the suite itself")
        return fields

    @field_validator("choose")
    @classmethod
    def _measures_all_alike(cls, choices: Choices) -> Choices:
        if any(path.partition(".")[0] == "metrics" for path in choices):
            raise ValueError("metrics must be the same in all matches of a track: give them in its match")
        return choices


class SuiteFile(Section):
    """An organizer's suite."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{1,39}$")]
    title: str = ""
    map: MapSection = MapSection()
    tracks: Annotated[dict[str, TrackSection], Field(min_length=1)]

    @field_validator("name")
    @classmethod
    def _is_new(cls, name: str) -> str:
        if name in SUITES:
            owner = SUITES.origin(name)
            of = f"the package {owner}" if owner else "Wildscav"
            raise ValueError(f"{name!r} is a suite of {of}: choose another name")
        return name

    @field_validator("tracks")
    @classmethod
    def _tracks_exist(cls, tracks: dict[str, TrackSection]) -> dict[str, TrackSection]:
        for name in tracks:
            if name not in TRACKS:
                raise ValueError(f"there is no track {name!r}; the tracks are {', '.join(TRACKS)}")
        return tracks


def find_suite(name: str) -> Suite:
    """Return the suite with a name, or from a TOML file; UserError if there is none, or it is not valid."""
    if name in SUITES:
        return SUITES[name]
    if not name.endswith(SUFFIX):
        raise UserError(
            f"there is no suite {name!r}{did_you_mean(name, SUITES)}; the suites are {', '.join(SUITES)}, or "
            f"name a file whose name ends in {SUFFIX}",
            2,
        )
    return read_suite(Path(name))


def read_suite(path: Path) -> Suite:
    """Read an organizer's own suite, and check every value that it may draw.

    UserError if it is not valid; one line says which field is wrong, and how.
    """
    try:
        source = read_config(path, f"{__name__}:try_suite")
    except OSError as error:
        raise UserError(f"the suite {describe(error)}", 2) from error
    return parse_suite(path, source)


def try_suite(path: str) -> None:
    """Read a suite's file in the calling process; UserError if it is not valid."""
    parse_suite(Path(path), read_limited(Path(path), LARGEST))


def parse_suite(path: Path, source: bytes) -> Suite:
    """Return the suite that the content of a file describes; UserError, with its path, if it is not valid."""
    try:
        content = tomllib.loads(source.decode())
    except RecursionError:
        raise UserError(f"{path} is not valid TOML: it is nested too deeply", 2) from None
    except ValueError as error:  # invalid TOML or UTF-8, or a number with thousands of digits
        raise UserError(f"{path} is not valid TOML: {error}", 2) from error
    try:
        return _suite(SuiteFile.model_validate(_grouped(content)), source)
    except ValidationError as error:
        raise UserError(f"{path}: {one_line(error)}", 2) from error
    except RecursionError:
        raise UserError(f"{path}: a value in it is nested too deeply", 2) from None
    except (ValueError, MapError) as error:
        raise UserError(f"{path}: {error}", 2) from error


def _grouped(content: Fields) -> Fields:
    """Return a file's content with the map's fields separated from its choices, as in a ``MapSection``."""
    fields = content.get("map")
    if not isinstance(fields, dict):
        return content
    plain = {name: value for name, value in fields.items() if name != "choose"}
    return {**content, "map": {"fields": plain, "choose": fields.get("choose", {})}}


def _suite(file: SuiteFile, source: bytes) -> Suite:
    config = _drawer(MapConfig, file.map.fields, file.map.choose, "map")
    tracks = {name: _track_settings(name, file.tracks[name]) for name in TRACKS if name in file.tracks}
    limits = {track: part.limits for track, part in file.tracks.items()}
    fingerprints = {track: _fingerprint(file, part) for track, part in file.tracks.items()}
    return Suite(file.name, file.title, config, tracks, source, limits, fingerprints=fingerprints)


def _fingerprint(file: SuiteFile, part: TrackSection) -> str:
    said = f"{file.name}\n{file.map.model_dump_json()}\n{part.model_dump_json()}"
    return blake2b(said.encode(), digest_size=16).hexdigest()


def _track_settings(track: str, part: TrackSection) -> TrackSettings:
    fields, where = {"track": track, **part.match}, f"tracks.{track}"
    draw_fields = _drawer(MatchSpec, fields, part.choose, where)
    _check_longest(fields, part, where)

    def draw(dice: RandomStream) -> MatchSpec:
        spec = draw_fields(dice)
        return spec.model_copy(update={"seats": shuffled(dice, spec.seats)}) if part.shuffle else spec

    known = tuple(map_spec(number) for number in part.maps) if isinstance(part.maps, list) else ()
    count = len(known) if isinstance(part.maps, list) else part.maps
    return TrackSettings(count, part.episodes, draw, known)


def _check_longest(fields: Fields, part: TrackSection, where: str) -> None:
    """Check that even the match with the most steps can end within the longest time, or ValueError."""
    chosen = {path: values[0] for path, values in part.choose.items()}
    for path, worst in (("time_limit", max), ("frames_per_action", min)):
        if path in chosen:
            chosen[path] = worst(part.choose[path])
    try:
        Clock(longest=part.limits.wall_clock).fitted(_made(MatchSpec, fields, chosen, where))
    except ValueError as error:
        raise ValueError(f"{where}.limits.wall_clock: {error}") from None


def _drawer(
    kind: type[AnySpec], fields: Fields, choices: Mapping[str, list[Any]], where: str
) -> Callable[[RandomStream], AnySpec]:
    """Return a function that draws specs of some kind, after checking what it may draw.

    It raises UserError for a combination of values that was not checked and is not valid.
    """
    for chosen in _combinations(choices):
        _made(kind, fields, chosen, where)

    def draw(dice: RandomStream) -> AnySpec:
        chosen = {path: choose(dice, tuple(values)) for path, values in choices.items()}
        try:
            return _made(kind, fields, chosen, where)
        except ValueError as error:
            raise UserError(f"the suite draws what is not valid: {error}", 2) from error

    return draw


def _combinations(choices: Mapping[str, list[Any]]) -> Iterator[Fields]:
    """Yield every combination of choices; of too many, every choice beside the first ones of the others."""
    if prod(map(len, choices.values())) <= MAX_COMBINATIONS:
        yield from (dict(zip(choices, chosen, strict=True)) for chosen in product(*choices.values()))
        return
    first = {path: values[0] for path, values in choices.items()}
    yield from ({**first, path: value} for path, values in choices.items() for value in values)


def _made(kind: type[AnySpec], fields: Fields, chosen: Fields, where: str) -> AnySpec:
    whole = deepcopy(fields)
    for path, value in chosen.items():
        _put(whole, path, value, where)
    try:
        spec = kind.model_validate(whole)
    except ValidationError as error:
        raise ValueError(f"{where}: {one_line(error)}{_allowed(kind, error)}") from error
    if isinstance(spec, MatchSpec) and SUBMISSION not in spec.seats:
        raise ValueError(f"{where}: no seat is filled by {SUBMISSION!r}")
    if isinstance(spec, MatchSpec):
        try:
            check_recordable(spec)
        except RecordError as error:
            raise ValueError(f"{where}: {error}") from error
    return spec


def _allowed(kind: type[AnySpec], error: ValidationError) -> str:
    """Return the list of known fields if the error is an unknown field; otherwise an empty text."""
    if not any(fault["type"] == "extra_forbidden" and len(fault["loc"]) == 1 for fault in error.errors()):
        return ""
    return f"; its fields are {', '.join(name for name in kind.model_fields if name not in SET_BY_SUITE)}"


def _put(fields: Fields, path: str, value: Any, where: str) -> None:
    """Set a field by its path, such as ``supplies.waves.0.radius``; ValueError if there is no such field."""
    names = path.split(".")
    last = names[-1]
    place: Any = fields
    try:
        for name, following in pairwise(names):
            # A missing list becomes an empty one, in which no index exists.
            missing: Any = [] if following.isdecimal() else {}
            place = place[int(name)] if isinstance(place, list) else place.setdefault(name, missing)
        place[int(last) if isinstance(place, list) else last] = value
    except (IndexError, ValueError, TypeError, AttributeError) as error:
        raise ValueError(f"{where}.choose: there is no {path!r} among the fields that are given") from error
