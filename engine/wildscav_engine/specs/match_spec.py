"""The spec of a match: everything that determines it, apart from its actions."""

from functools import cache
from typing import Annotated, Any, Literal, NamedTuple, Protocol, Self

from pydantic import Field, SerializerFunctionWrapHandler, model_serializer, model_validator

from wildscav_engine.extensions import Registry
from wildscav_engine.specs.base import Seed, Spec
from wildscav_engine.specs.map_spec import MapSpec
from wildscav_engine.specs.rules import FRAMES_PER_SECOND, Rules, RulesField
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.thinking import ClockName, ThinkingPrice, check_price
from wildscav_engine.specs.zone_config import ZoneConfig

Position = tuple[float, float, float]  # x, y, z in m

SUBMISSION = "submission"  # in MatchSpec.seats: an agent process fills the seat


class Equipment(Spec):
    """The equipment of one seat at the start and after each respawn; None: as the rules say for all seats."""

    health: Annotated[int, Field(ge=1, le=10_000)] | None = None  # hp
    clip_size: Annotated[int, Field(ge=0, le=1000)] | None = None  # rounds; 0: a weapon that never fires
    spare_ammo: Annotated[int, Field(ge=0, le=100_000)] | None = None  # rounds
    shot_damage: Annotated[int, Field(ge=0, le=10_000)] | None = None  # hp per hit


class SeatEquipment(NamedTuple):
    """The complete equipment of one seat."""

    health: int  # hp
    clip_size: int  # rounds
    spare_ammo: int  # rounds
    shot_damage: int  # hp per hit


class Named(Protocol):
    """What a spec needs to know about a metric or a robot; it is in a lower layer and imports neither."""

    @property
    def name(self) -> str:
        """The name in a spec."""


class TrackRules(Protocol):
    """What a spec needs to know about its track; see ``simulation/track.py``."""

    has_target: bool
    has_supplies: bool
    has_supply_goal: bool
    has_zone: bool
    metrics: tuple[Named, ...]
    slow_metrics: tuple[Named, ...]

    def teams(self, seats: int) -> tuple[int, ...]:
        """Return the default team of each seat."""


_TRACKS: Registry[TrackRules] = Registry("wildscav.tracks")
_METRICS: Registry[object] = Registry("wildscav.metrics")
_ROBOTS: Registry[tuple[Named, ...]] = Registry("wildscav.robots")


@cache
def _robot_names() -> tuple[str, ...]:
    return tuple(robot.name for levels in _ROBOTS.values() for robot in levels)


class MatchSpec(Spec):
    """One match. This spec and the actions of all seats determine everything that happens in it."""

    track: str  # a name in wildscav_engine.tracks.TRACKS
    map: MapSpec = MapSpec()
    seed: Seed = 0
    # What fills each seat: "submission" or a robot's name.
    seats: Annotated[tuple[str, ...], Field(min_length=1, max_length=1000)] = (SUBMISSION,)
    # The team of each seat, counted from 0; None: the track's default (one team per seat, or one for all).
    teams: tuple[Annotated[int, Field(ge=0, lt=1000)], ...] | None = None
    time_limit: Annotated[float, Field(gt=0, le=86_400)] = 120.0  # s of game time
    frames_per_action: Annotated[int, Field(ge=1, le=50)] = 5
    start: Position | None = None  # m, of the first seat; None: a random outdoor location
    starts: tuple[Position | None, ...] | None = None  # m, of each seat; replaces ``start``
    # m, the approximate distance of random starts from where the target can be reached; None: any
    start_range: Annotated[float, Field(ge=0, le=2000)] | None = None
    target: Position | None = None  # m; None: a random outdoor location (navigation)
    # The equipment of each seat that differs from the rules; None: no seat's does.
    equipment: tuple[Equipment | None, ...] | None = None
    # Where agents respawn: at a random place, or where they started unless another agent stands there.
    respawn_at: Literal["random", "start"] = "random"
    supplies: SupplyConfig | None = None  # None: the track's default
    # Gathering: the supplies that a team must carry to end the match; None: only the time limit ends it.
    supply_goal: Annotated[int, Field(ge=1, le=1_000_000)] | None = None
    zone: ZoneConfig | None = None  # royale; None: the track's default
    rules: RulesField = Rules()
    # Metrics from packages, by name, that are measured in addition to those of the track.
    metrics: Annotated[tuple[str, ...], Field(max_length=20)] = ()
    clock: ClockName = "bank"
    thinking: ThinkingPrice = ThinkingPrice()

    @model_serializer(mode="wrap")
    def _omit_later_defaults(self, serialize: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Omit later fields that have no effect, so that records and digests of older specs do not change."""
        fields: dict[str, Any] = serialize(self)
        for name in ("metrics", "clock", "thinking"):
            if getattr(self, name) == MatchSpec.model_fields[name].default:
                fields.pop(name, None)
        return fields

    @property
    def frame_limit(self) -> int:
        """The maximum number of frames of the match."""
        return max(1, round(self.time_limit * FRAMES_PER_SECOND))

    @property
    def step_time(self) -> float:
        """Game time of one step, s."""
        return self.frames_per_action / FRAMES_PER_SECOND

    @property
    def step_limit(self) -> int:
        """The maximum number of steps of the match."""
        return -(-self.frame_limit // self.frames_per_action)

    @property
    def start_of_seats(self) -> tuple[Position | None, ...]:
        """Where each seat starts, in m; None: a random place."""
        return self.starts if self.starts is not None else (self.start, *(None,) * (len(self.seats) - 1))

    def equipment_of(self, seat: int) -> SeatEquipment:
        """Return the equipment of a seat: its own where the spec gives it, otherwise that of the rules."""
        rules = self.rules
        equipment = SeatEquipment(rules.start_health, rules.clip_size, rules.spare_ammo, rules.shot_damage)
        own = self.equipment[seat] if self.equipment is not None else None
        return equipment if own is None else equipment._replace(**own.model_dump(exclude_none=True))

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
        robots = _robot_names()
        for seat, name in enumerate(self.seats):
            if name != SUBMISSION and name not in robots:
                allowed = ", ".join([SUBMISSION, *robots])
                raise ValueError(f"seat {seat} is filled by {name!r}; allowed are {allowed}")
        return self

    @model_validator(mode="after")
    def _metrics_exist(self) -> Self:
        track = _TRACKS[self.track]
        own = [metric.name for metric in track.metrics + track.slow_metrics] if self.metrics else []
        for name in self.metrics:
            if name not in _METRICS:
                installed = f"; installed are {', '.join(_METRICS)}" if _METRICS else "; none is installed"
                raise ValueError(f"there is no additional metric {name!r}{installed}")
            if name in own:
                raise ValueError(f"metric {name!r} is already one of the track {self.track}")
        if len(set(self.metrics)) < len(self.metrics):
            raise ValueError("metrics lists a metric twice")
        return self

    @model_validator(mode="after")
    def _price_is_of_the_clock(self) -> Self:
        check_price(self.clock, self.thinking)
        return self

    @model_validator(mode="after")
    def _lists_fit_the_seats(self) -> Self:
        if self.start is not None and self.starts is not None:
            raise ValueError("start and starts are both given; starts includes the start of the first seat")
        for name in ("starts", "teams", "equipment"):
            given = getattr(self, name)
            if given is not None and len(given) != len(self.seats):
                raise ValueError(f"{name} has {len(given)} entries for {len(self.seats)} seats")
        teams = set(self.teams or ())
        if missing := sorted(set(range(max(teams, default=0))) - teams):
            raise ValueError(f"team {missing[0]} has no seat; teams must be numbered from 0 without gaps")
        return self
