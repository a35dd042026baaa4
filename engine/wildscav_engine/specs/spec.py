"""The specs: everything that a map and a match are functions of."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, Protocol, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from wildscav_engine.extensions import Registry
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, Rules, RulesField

if TYPE_CHECKING:
    from pydantic_core import ErrorDetails

Seed = Annotated[int, Field(ge=0, lt=2**64)]
Percent = Annotated[float, Field(ge=0, le=100)]

Place = tuple[float, float, float]

SUBMISSION = "submission"  # the word for a seat that an agent process fills

MOST_FAULTS = 1000  # of a value, to be looked at one by one
SHOWN_FAULTS = 8  # of them, in a line
LONGEST_SHOWN = 100  # characters of what was given


def one_line(error: ValidationError) -> str:
    """Say in one line what is wrong with a value: each field with its fault and what was given."""
    # Of values that an adversary wrote, there may be as many faults as fit into memory.
    if error.error_count() > MOST_FAULTS:
        return f"{error.error_count():,} of its values are not as they must be"
    faults = error.errors(include_url=False)
    parts = [_described(fault) for fault in faults[:SHOWN_FAULTS]]
    if len(faults) > SHOWN_FAULTS:
        parts.append(f"and {len(faults) - SHOWN_FAULTS:,} more faults")
    return "; ".join(parts)


def _described(fault: "ErrorDetails") -> str:
    """Return a field, its fault and what was given."""
    field = ".".join(_clipped(str(part)) for part in fault["loc"])
    message = fault["msg"].removeprefix("Value error, ")
    if fault["type"] not in {"missing", "extra_forbidden", "value_error"}:
        message += f", not {_shown(fault['input'])}"
    return f"{field}: {message}" if field else message


def _shown(value: object) -> str:
    try:
        return _clipped(repr(value))
    except (RecursionError, ValueError):  # nested too deeply, or an integer of thousands of digits
        return f"this {type(value).__name__}"


def _clipped(text: str) -> str:
    return text if len(text) <= LONGEST_SHOWN else f"{text[:LONGEST_SHOWN]}…"


class Spec(BaseModel):
    """Base of all specs: frozen, strict about names, equal by value."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)


class SupplyWave(Spec):
    """Supply boxes that appear at one moment, thickest around a centre."""

    time: Annotated[float, Field(ge=0, le=86_400)] = 0.0  # s; 0 is the start of the match
    center: tuple[float, float] | None = None  # x, z in m; None: a random indoor location
    radius: Annotated[float, Field(ge=1, le=1000)] = 50.0  # m, standard deviation of the heat map
    outdoor_richness: Annotated[float, Field(ge=0, le=50)] = 20.0  # % of outdoor grid points at the center
    indoor_richness: Percent = 70.0  # % of indoor points, which are 5 m apart


class SupplyConfig(Spec):
    """Where supply boxes lie and what they hold."""

    waves: tuple[SupplyWave, ...] = (SupplyWave(center=(0.0, 0.0)),)
    spacing: Annotated[float, Field(ge=1, le=100)] = 10.0  # m, of the outdoor grid
    outdoor_quantity: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(le=1000)]] = (1, 5)
    indoor_quantity: tuple[Annotated[int, Field(ge=1)], Annotated[int, Field(le=1000)]] = (10, 50)

    @model_validator(mode="after")
    def _quantities_ascend(self) -> Self:
        for name in ("outdoor_quantity", "indoor_quantity"):
            low, high = getattr(self, name)
            if low > high:
                raise ValueError(f"{name} is {(low, high)}: the first number must not be above the second")
        return self


class ZonePhase(Spec):
    """One shrinking of the safe zone: it waits, then draws in to a smaller circle inside itself."""

    wait: Annotated[float, Field(ge=0, le=86_400)]  # s before it begins to shrink
    shrink: Annotated[float, Field(gt=0, le=86_400)]  # s from then until it has its new radius
    share: Annotated[float, Field(ge=0, le=1)]  # the new radius over the old one
    damage: Annotated[int, Field(ge=0, le=10_000)]  # hp a second outside, from the start of the phase


class ZoneConfig(Spec):
    """The schedule of the safe zone, which begins as the circle around the whole map."""

    phases: Annotated[tuple[ZonePhase, ...], Field(max_length=16)] = ()


class Placement(Spec):
    """Something that is put at one place of a map by hand."""

    kind: Literal["house", "block", "tree", "bush", "rock"]
    location: tuple[float, float]  # x, z in m, of its middle
    area: tuple[Annotated[float, Field(gt=0, le=2000)], Annotated[float, Field(gt=0, le=2000)]] | None = None
    # m, across and along. A house or a block has this size (None: as the generator draws one); trees, bushes
    # and rocks fill it (None: a single one).
    orientation: Annotated[float, Field(ge=-360, le=360)] = 0.0  # degrees, the yaw that its front faces
    storeys: Annotated[int, Field(ge=1, le=4)] | None = None  # of a house; None: as the config says
    height: Annotated[float, Field(gt=0, le=30)] = 2.0  # m, of a block
    density: Annotated[float, Field(gt=0, le=1)] = 0.5  # of trees, bushes and rocks in an area; 1 is thick


class Equipment(Spec):
    """What one seat has at the start and after each return, where it is not what the rules give everyone."""

    health: Annotated[int, Field(ge=1, le=10_000)] | None = None  # hp
    clip_size: Annotated[int, Field(ge=0, le=1000)] | None = None  # 0: a weapon that never fires
    spare_ammo: Annotated[int, Field(ge=0, le=100_000)] | None = None
    shot_damage: Annotated[int, Field(ge=0, le=10_000)] | None = None  # hp that its shots cost others


class SeatEquipment(NamedTuple):
    """What a seat has at the start and after each return."""

    health: int  # hp
    clip_size: int  # rounds
    spare_ammo: int  # rounds
    shot_damage: int  # hp that its shots cost others


class MapConfig(Spec):
    """What kind of map to make. With a seed, it gives exactly one map."""

    size: Annotated[int, Field(ge=40, le=2000, multiple_of=2)] = 100  # m, of each side
    relief: Annotated[float, Field(ge=0, le=2)] = 1.0  # 0 flat, 1 hills, 2 mountains
    ruggedness: Annotated[float, Field(ge=0, le=1)] = 0.4  # 0 smooth downs and plains, 1 ridges and cliffs
    water: Annotated[float, Field(ge=0, le=0.4)] = 0.08  # share of the area under lakes, about
    houses: Annotated[int, Field(ge=0, le=200)] = 4  # beside those placed by hand
    density: Literal["low", "high"] = "low"  # houses scattered, or close together along streets
    storeys: tuple[Annotated[int, Field(ge=1, le=4)], Annotated[int, Field(ge=1, le=4)]] = (1, 2)
    vegetation: Annotated[float, Field(ge=0, le=1)] = 0.4  # 0 bare, 1 dense woods
    placements: Annotated[tuple[Placement, ...], Field(max_length=1000)] = ()
    # An imported height map or mesh that the map is made on, by its digest; None: generated ground.
    base: Annotated[str, Field(pattern="^[0-9a-f]{32}$")] | None = None
    # What matches on this map use where their own spec says nothing; None: the track's default.
    supplies: SupplyConfig | None = None

    @model_validator(mode="after")
    def _storeys_ascend(self) -> Self:
        if self.storeys[0] > self.storeys[1]:
            raise ValueError(f"storeys is {self.storeys}: the first number must not be above the second")
        return self


class MapSpec(Spec):
    """One map."""

    config: MapConfig = MapConfig()
    seed: Seed = 0


class TrackRules(Protocol):
    """What a spec has to know of its track; see ``simulation/track.py``."""

    has_target: bool
    has_supplies: bool
    has_supply_goal: bool
    has_zone: bool

    def teams(self, seats: int) -> tuple[int, ...]:
        """Return the team of each seat where the spec does not say."""


class RobotName(Protocol):
    """What a spec has to know of a robot; see ``simulation/robots/base.py``."""

    @property
    def name(self) -> str:
        """What fills a seat with it."""


_TRACKS: Registry[TrackRules] = Registry("wildscav.tracks", make=lambda track: track())
_ROBOTS: Registry[tuple[RobotName, ...]] = Registry("wildscav.robots")


class MatchSpec(Spec):
    """One match: with every action of every seat, all that happens in it is a function of this."""

    track: str  # a name in wildscav_engine.tracks.TRACKS
    map: MapSpec = MapSpec()
    seed: Seed = 0
    # Who fills each seat: "submission" or a robot's name.
    seats: Annotated[tuple[str, ...], Field(min_length=1, max_length=1000)] = (SUBMISSION,)
    # The team of each seat, counted from 0; None: the track's own (each seat alone, or all together).
    teams: tuple[Annotated[int, Field(ge=0, lt=1000)], ...] | None = None
    time_limit: Annotated[float, Field(gt=0, le=86_400)] = 120.0  # s of game time
    frames_per_action: Annotated[int, Field(ge=1, le=50)] = 5
    start: Place | None = None  # m, of the first seat; None: a random outdoor location
    starts: tuple[Place | None, ...] | None = None  # m, of each seat, instead of ``start``
    # m; starts that are not given lie about so far from where the target is reached; None: anywhere
    start_range: Annotated[float, Field(ge=0, le=2000)] | None = None
    target: Place | None = None  # m; None: a random outdoor location (navigation)
    # Of each seat, where it differs from the rules; None: of nobody.
    equipment: tuple[Equipment | None, ...] | None = None
    # Where the dead come back: at a random place, or where they started as long as nobody is there.
    respawn_at: Literal["random", "start"] = "random"
    supplies: SupplyConfig | None = None  # None: the track's default
    # Gathering: how many supplies a team has to carry to end the match; None: the time ends it.
    supply_goal: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    zone: ZoneConfig | None = None  # royale; None: the track's default
    rules: RulesField = Rules()

    @property
    def frame_limit(self) -> int:
        """Frames after which the match is over at the latest."""
        return max(1, round(self.time_limit * FRAMES_PER_SECOND))

    @property
    def step_limit(self) -> int:
        """Steps after which the match is over at the latest."""
        return -(-self.frame_limit // self.frames_per_action)

    @property
    def start_of_seats(self) -> tuple[Place | None, ...]:
        """Where each seat starts, in m; None: a random place."""
        return self.starts if self.starts is not None else (self.start, *(None,) * (len(self.seats) - 1))

    def varied(self, **changes: Any) -> Self:
        """Return this spec with some fields changed to values that are known to be valid: nothing is checked.

        It takes a tenth of the time that a new spec does, for environments that begin episode after episode.
        """
        spec = type(self).__new__(type(self))
        object.__setattr__(spec, "__dict__", {**self.__dict__, **changes})
        object.__setattr__(spec, "__pydantic_fields_set__", self.__pydantic_fields_set__ | changes.keys())
        object.__setattr__(spec, "__pydantic_extra__", None)
        object.__setattr__(spec, "__pydantic_private__", None)
        return spec

    def equipment_of(self, seat: int) -> SeatEquipment:
        """Return what a seat has at the start: its own, or what the rules give everyone."""
        own = (self.equipment[seat] if self.equipment is not None else None) or Equipment()
        rules = self.rules
        return SeatEquipment(
            health=rules.start_health if own.health is None else own.health,
            clip_size=rules.clip_size if own.clip_size is None else own.clip_size,
            spare_ammo=rules.spare_ammo if own.spare_ammo is None else own.spare_ammo,
            shot_damage=rules.shot_damage if own.shot_damage is None else own.shot_damage,
        )

    @property
    def team_of_seats(self) -> tuple[int, ...]:
        """The team of each seat."""
        return self.teams if self.teams is not None else _TRACKS[self.track].teams(len(self.seats))

    @model_validator(mode="after")
    def _names_exist(self) -> Self:
        if self.track not in _TRACKS:
            raise ValueError(f"track is {self.track!r}; the tracks are {', '.join(_TRACKS)}")
        track = _TRACKS[self.track]
        for field, has in (
            ("target", track.has_target),
            ("start_range", track.has_target),
            ("supplies", track.has_supplies),
            ("supply_goal", track.has_supply_goal),
            ("zone", track.has_zone),
        ):
            if getattr(self, field) is not None and not has:
                raise ValueError(f"{field} is given, but {self.track} has no {field.replace('_', ' ')}")
        robots = [robot.name for levels in _ROBOTS.values() for robot in levels]
        for seat, name in enumerate(self.seats):
            if name != SUBMISSION and name not in robots:
                allowed = ", ".join([SUBMISSION, *robots])
                raise ValueError(f"seat {seat} is filled by {name!r}; allowed are {allowed}")
        return self

    @model_validator(mode="after")
    def _starts_fit(self) -> Self:
        if self.starts is None:
            return self
        if self.start is not None:
            raise ValueError("start and starts are given; starts has the first seat's, too")
        if len(self.starts) != len(self.seats):
            raise ValueError(f"{len(self.starts)} starts are given for {len(self.seats)} seats")
        return self

    @model_validator(mode="after")
    def _equipment_fits(self) -> Self:
        if self.equipment is not None and len(self.equipment) != len(self.seats):
            raise ValueError(f"{len(self.equipment)} equipments are given for {len(self.seats)} seats")
        return self

    @model_validator(mode="after")
    def _teams_fit(self) -> Self:
        if self.teams is None:
            return self
        if len(self.teams) != len(self.seats):
            raise ValueError(f"{len(self.teams)} teams are given for {len(self.seats)} seats")
        missing = sorted(set(range(max(self.teams))) - set(self.teams))
        if missing:
            raise ValueError(f"nobody is in team {missing[0]}; teams are counted from 0 without a gap")
        return self
