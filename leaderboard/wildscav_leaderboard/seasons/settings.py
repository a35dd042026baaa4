"""The settings of a season: the file ``season.toml``, checked as a whole before anything starts."""

import tomllib
from collections.abc import Iterator
from datetime import UTC, datetime
from ipaddress import ip_network
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, ValidationError, model_validator

from wildscav.errors import UserError, describe
from wildscav.terminal.console import command
from wildscav.terminal.suggestions import did_you_mean
from wildscav_evaluator.model_gateway.settings import ModelSettings

SETTINGS_FILE = "season.toml"
LARGEST = 1 << 20  # bytes
SIMPLE = (str, int, float, bool)  # values that an error shows

Seconds = Annotated[float, Field(gt=0.0, le=7 * 86_400.0)]
Mode = Literal["suite", "ladder"]


class SettingsError(UserError):
    """A season's settings are not valid."""

    def __init__(self, message: str) -> None:
        super().__init__(message, exit_code=2)


def _in_utc(moment: datetime) -> datetime:
    """Return a moment with its time zone, which is UTC unless it says otherwise."""
    return moment.replace(tzinfo=UTC) if moment.tzinfo is None else moment.astimezone(UTC)


Moment = Annotated[datetime, AfterValidator(_in_utc)]


class _Part(BaseModel):
    model_config = ConfigDict(frozen=True, extra="forbid")


class Quotas(_Part):
    """How much each team may submit."""

    per_day: Annotated[int, Field(ge=1, le=1000)] = 5  # submissions in a day of UTC
    active: Annotated[int, Field(ge=1, le=100)] = 2  # submissions that take part at once, on each track
    members: Annotated[int, Field(ge=1, le=100)] = 5  # accounts of a team
    archive: Annotated[int, Field(ge=1, le=256)] = 100  # MiB of an archive


class Deadlines(_Part):
    """After how long a piece of work that has not ended counts as lost."""

    building: Seconds = 900.0
    validating: Seconds = 900.0
    attempts: Annotated[int, Field(ge=1, le=10)] = 3  # at work that the platform broke

    @model_validator(mode="before")
    @classmethod
    def _has_none_of_matches(cls, given: Any) -> Any:
        if isinstance(given, dict) and "match" in given:
            raise ValueError(
                "match is no setting any more: a match may last as long as its agents' budgets and banks "
                "allow, and wall_clock of a track, such as tracks.battle.wall_clock, makes it shorter"
            )
        return given


class Execution(_Part):
    """Where agents run."""

    executor: str = "local"  # or ray
    address: str | None = None  # of a Ray cluster
    matches: Annotated[int | None, Field(ge=1, le=10_000)] = None  # at once; None: as many as there are cores
    validations: Annotated[int, Field(ge=1, le=1000)] = 2  # of submissions at once, beside the matches
    sandbox: str | None = None  # None: the strongest that works here; never process, which isolates nothing


class Web(_Part):
    """Where the web site is."""

    host: str = "127.0.0.1"
    port: Annotated[int, Field(ge=0, le=65_535)] = 8000
    url: Annotated[str | None, Field(pattern=r"^https?://[^/\s]+/?$")] = None  # as people write it
    certificate: Path | None = None  # PEM file, for TLS; with its key
    key: Path | None = None
    proxies: tuple[str, ...] = ()  # addresses of reverse proxies, whose X-Forwarded headers are believed
    requests_per_minute: Annotated[int, Field(ge=1, le=1_000_000)] = 600  # of one address
    replays: Annotated[int, Field(ge=1, le=1_000_000)] = 2048  # MiB of rendered files that are kept
    metrics_port: Annotated[int | None, Field(ge=0, le=65_535)] = None  # on this machine, for Prometheus

    @model_validator(mode="after")
    def _complete(self) -> "Web":
        if (self.certificate is None) != (self.key is None):
            raise ValueError("certificate and key belong together: give both or none")
        for proxy in self.proxies:
            ip_network(proxy, strict=False)
        return self

    @property
    def address(self) -> str:
        """The address at which people find the season, whatever a request says."""
        if self.url is not None:
            return self.url.rstrip("/")
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{'http' if self.certificate is None else 'https'}://{host}:{self.port}"


class Play(_Part):
    """Matches of people against submissions, on the site. Nothing of them counts for boards."""

    enabled: bool = False
    who: Literal["accounts", "anybody"] = "accounts"
    tables: Annotated[int, Field(ge=1, le=50)] = 2  # at once; each person has one at most
    people: Annotated[int, Field(ge=1, le=8)] = 1  # with a seat at a table: whoever opened it, and guests
    tracks: tuple[str, ...] = ()  # on which people play; none: all tracks of the season
    match: Annotated[float, Field(ge=10.0, le=3600.0)] = 180.0  # s of game time that a match takes at most
    session: Annotated[float, Field(ge=10.0, le=86_400.0)] = 1800.0  # s after which a table ends
    idle: Annotated[float, Field(ge=5.0, le=3600.0)] = 180.0  # s without any input after which it does


class Webhooks(_Part):
    """Messages to teams' own addresses."""

    enabled: bool = True
    private_addresses: bool = False  # whether they may lead into private networks


class TrackSettings(_Part):
    """What is played on a track, and how it is ranked."""

    mode: Mode
    suite: str = "official"  # or a path of an organizer's own suite, relative to the season's folder
    rounds: Annotated[int, Field(ge=1, le=1000)] = 1  # of the suite, in mode suite
    # s, the longest time of all steps of a match; None: as the suite says
    wall_clock: Annotated[float | None, Field(gt=0, le=604_800)] = None
    # In mode ladder:
    seats: Annotated[int, Field(ge=2, le=100)] = 4  # entrants in a match
    robots: tuple[str, ...] = ()  # robots that take part as entrants, whose ratings anchor the scale
    interval: Annotated[float, Field(gt=0.0, le=10_000.0)] = 200.0  # at whose width a rating is settled
    matches: Annotated[int, Field(ge=1, le=100_000)] = 100  # after which a submission plays no more, anyhow
    waiting: Annotated[int, Field(ge=1, le=10_000)] = 8  # matches that are made in advance, at most


# The settings that each mode would ignore.
IGNORED: dict[Mode, tuple[str, ...]] = {
    "suite": ("seats", "robots", "interval", "matches", "waiting"),
    "ladder": ("rounds",),
}


class SeasonSettings(_Part):
    """Everything in ``season.toml``."""

    name: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9-]{1,39}$")]
    title: Annotated[str, Field(min_length=1, max_length=100)]
    opens: Moment  # submissions are accepted from here
    freezes: Moment | None = None  # the public boards stay as they are then
    closes: Moment  # submissions are accepted until here
    registration: Literal["open", "invited"] = "invited"
    database: str | None = None  # URL; None: a file of SQLite in the season's folder
    files: Path | None = None  # folder of archives and records; None: in the season's folder
    tracks: Annotated[dict[str, TrackSettings], Field(min_length=1)]
    quotas: Quotas = Quotas()
    deadlines: Deadlines = Deadlines()
    execution: Execution = Execution()
    web: Web = Web()
    webhooks: Webhooks = Webhooks()
    play: Play = Play()
    model: ModelSettings | None = None  # that submissions may ask in matches

    @model_validator(mode="after")
    def _fits(self) -> "SeasonSettings":
        if not self.opens < self.closes:
            raise ValueError("closes must be later than opens")
        if self.freezes is not None and not self.opens <= self.freezes <= self.closes:
            raise ValueError("freezes must be between opens and closes")
        if self.model is not None and self.model.key_file and not self.model.key_file.is_absolute():
            raise ValueError("model.key_file must be an absolute path")
        return self


def read_settings(folder: Path) -> SeasonSettings:
    """Read and check the settings of a season's folder.

    Raises:
        SettingsError: They are missing or not valid; one line says which field, and what is allowed.
    """
    path = folder / SETTINGS_FILE
    try:
        content = path.read_bytes()
    except FileNotFoundError:
        raise SettingsError(
            f"there is no {path}: `{command('wildscav', 'season', 'init', folder)}` makes a season's folder"
        ) from None
    except OSError as error:
        raise SettingsError(describe(error)) from error
    if len(content) > LARGEST:
        raise SettingsError(f"{path} has {len(content):,} bytes, may have {LARGEST:,} at most")
    return parse_settings(content.decode("utf-8", "replace"), path)


def parse_settings(text: str, path: Path) -> SeasonSettings:
    """Check the text of settings.

    Raises:
        SettingsError: They are not valid.
    """
    try:
        content = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise SettingsError(f"{path} is not valid TOML: {error}") from None
    try:
        settings = SeasonSettings.model_validate(content)
    except ValidationError as error:
        raise SettingsError(f"{path}: {_explained(error)}") from None
    for problem in _problems(settings):
        raise SettingsError(f"{path}: {problem}")
    return settings


def _explained(error: ValidationError) -> str:
    first: Any = error.errors(include_url=False)[0]
    field = ".".join(str(part) for part in first["loc"])
    message = str(first["ctx"]["error"]) if first["type"] == "value_error" else str(first["msg"])
    if first["type"] == "extra_forbidden":
        name = str(first["loc"][-1])
        message = f"is not a setting{did_you_mean(name, _names())}"
    elif first["type"] not in ("value_error", "missing") and isinstance(first["input"], SIMPLE):
        message = f"is {first['input']!r}; {message[:1].lower()}{message[1:]}"
    return f"{field}: {message}" if field else message


def _names() -> list[str]:
    """Return the names of all settings."""
    parts: list[type[_Part]] = _Part.__subclasses__()
    return sorted({name for part in parts for name in part.model_fields})


def _problems(settings: SeasonSettings) -> Iterator[str]:
    """Yield what does not fit to the installed tracks, suites, robots, executors and sandboxes."""
    from wildscav_engine.simulation.robots.decide import ROBOTS
    from wildscav_engine.tracks import TRACKS
    from wildscav_evaluator.executors import EXECUTORS
    from wildscav_evaluator.sandbox import SANDBOXES
    from wildscav_evaluator.tournaments.drawing import has_teams

    yield from _unknown("execution.executor", settings.execution.executor, EXECUTORS)
    if settings.execution.sandbox is not None:
        yield from _unknown("execution.sandbox", settings.execution.sandbox, SANDBOXES)
    if settings.execution.address is not None and settings.execution.executor != "ray":
        yield 'execution.address: it is of a Ray cluster, so it needs executor = "ray"'
    for name in settings.play.tracks:
        yield from _unknown("play.tracks", name, settings.tracks)
    for name, track in settings.tracks.items():
        yield from _unknown("tracks", name, TRACKS)
        for robot in track.robots:
            yield from _unknown(f"tracks.{name}.robots", robot, ROBOTS)
        for field in IGNORED[track.mode]:
            if getattr(track, field) != TrackSettings.model_fields[field].default:
                yield f"tracks.{name}.{field}: it means nothing in mode {track.mode}: leave it out"
        if track.mode == "ladder" and name in TRACKS and has_teams(name):
            yield f"tracks.{name}.mode: {name} is played by one team, so it has no ladder; allowed is suite"


def _unknown(field: str, name: str, known: Any) -> Iterator[str]:
    if name not in known:
        yield f"{field}: {name!r} is none of {', '.join(known)}{did_you_mean(name, known)}"
