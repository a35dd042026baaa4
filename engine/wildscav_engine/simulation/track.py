"""The base class of tracks: action set, teams, goals, default rewards and metrics."""

import inspect
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

from wildscav_engine.extensions import Registry
from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.zone_config import ZoneConfig

if TYPE_CHECKING:
    from wildscav_engine.simulation.match_view import MatchView

MOVES = frozenset({Field.WALK_DIRECTION, Field.WALK_SPEED, Field.TURN, Field.LOOK, Field.JUMP})

NO_ZONE = ZoneConfig()
Sensors = dict[str, dict[str, Any]]  # the options of sensors by name
PAPER_DEPTH: Sensors = {"depth": {"width": 10, "height": 10}}
SUPPLIES_SEEN: Sensors = {"nearby_supplies": {"limit": 8}}
AGENTS_SEEN: Sensors = {"visible_agents": {"limit": 8}}


class Metric(NamedTuple):
    """One metric of a seat's result."""

    name: str
    title: str
    unit: str
    lower_is_better: bool


class Track(ABC):
    """Base class of tracks, the kinds of match."""

    name: ClassVar[str]  # used in specs, commands and files
    title: ClassVar[str]  # for people
    fields: ClassVar[frozenset[Field]]  # the action set; other fields of an action are ignored
    metrics: ClassVar[tuple[Metric, ...]]  # the first is the score
    # Metrics that take long to measure: every result has them, environments only on request.
    slow_metrics: ClassVar[tuple[Metric, ...]] = ()
    rewards: ClassVar[Mapping[str, float]]  # default weights of the reward terms
    # Defaults of environments:
    robot: ClassVar[str]  # the robot that fills the other seats
    learners: ClassVar[int]  # in environments with several learners
    opponents: ClassVar[int] = 0  # robots against a single learner
    time_limit: ClassVar[float] = 120.0  # s
    sensors: ClassVar[Sensors] = PAPER_DEPTH
    # Rules:
    has_target: ClassVar[bool] = False  # whether reaching the target ends the match
    hides_target: ClassVar[bool] = False  # whether the target must be found first
    has_supplies: ClassVar[bool] = False  # whether there are supply boxes
    has_supply_goal: ClassVar[bool] = False  # whether a spec may set a supply goal
    has_zone: ClassVar[bool] = False  # whether there is a safe zone
    respawns: ClassVar[bool] = True  # whether agents respawn

    def teams(self, seats: int) -> tuple[int, ...]:
        """Return the default team of each seat: every seat has its own team."""
        return tuple(range(seats))

    def supplies(self, spec: MatchSpec) -> SupplyConfig | None:  # noqa: ARG002
        """Return the supplies of a match; None for tracks without supplies."""
        return None

    def zone(self, spec: MatchSpec) -> ZoneConfig:  # noqa: ARG002
        """Return the schedule of the safe zone, which has no phases on tracks without a zone."""
        return NO_ZONE

    @abstractmethod
    def measure(self, match: "MatchView", seat: int) -> Mapping[str, float]:
        """Return the value of every metric of a seat, at the end of the match or so far."""

    def measure_slow(self, match: "MatchView", seat: int) -> Mapping[str, float]:  # noqa: ARG002
        """Return the value of every slow metric of a seat, at the end of the match or so far."""
        return {}


class Measure(ABC):
    """A metric of a seat's result in addition to those of the track.

    A match measures it if ``MatchSpec.metrics`` contains its name.
    """

    metric: ClassVar[Metric]

    @abstractmethod
    def measure(self, match: "MatchView", seat: int) -> float:
        """Return a seat's value, at the end of the match or so far."""


def make_track(name: str, kind: Any) -> Track:
    """Return the track of a class that an entry point names; ValueError if it is not valid."""
    track: Track = _instance(
        kind, Track, ("name", "title", "fields", "metrics", "rewards", "robot", "learners")
    )
    if track.name != name:
        raise ValueError(f"its class is called {track.name!r}")
    if not track.metrics:
        raise ValueError("it has no metrics, so it has no score")
    return track


def make_metric(name: str, kind: Any) -> Measure:
    """Return the metric of a class that an entry point names; ValueError if it is not valid."""
    measure: Measure = _instance(kind, Measure, ("metric",))
    if measure.metric.name != name:
        raise ValueError(f"its metric is called {measure.metric.name!r}")
    return measure


def _instance(kind: Any, base: type, attributes: tuple[str, ...]) -> Any:
    """Return an instance of a class that has everything that its base class requires."""
    if not isinstance(kind, type) or not issubclass(kind, base):
        raise ValueError(f"it is no class that derives from {base.__name__}")
    missing = [attribute for attribute in attributes if not hasattr(kind, attribute)]
    if missing or inspect.isabstract(kind):
        missing += sorted(getattr(kind, "__abstractmethods__", ()))
        raise ValueError(f"its class {kind.__name__} has no {', '.join(missing)}")
    return kind()


TRACKS: Registry[Track] = Registry("wildscav.tracks")
MEASURES: Registry[Measure] = Registry("wildscav.metrics")


def metrics_of(track: str, more: Iterable[str] = ()) -> tuple[Metric, ...]:
    """Return the metrics of the seats of a match; the first is the score. ``more`` are those of its spec."""
    own = TRACKS[track].metrics + TRACKS[track].slow_metrics
    return own + tuple(MEASURES[name].metric for name in more)


def measured(match: "MatchView", seat: int) -> dict[str, float]:
    """Return a seat's value of every metric of its match."""
    spec = match.spec
    track = TRACKS[spec.track]
    values = {**track.measure(match, seat), **track.measure_slow(match, seat)}
    return values | {name: float(MEASURES[name].measure(match, seat)) for name in spec.metrics}


def carried_by_team(match: "MatchView", seat: int) -> float:
    """Return the number of supplies that a seat's team carries."""
    agents = match.state.agents
    of_team = agents.team[0] == agents.team[0, seat]
    return float(agents.supplies[0, of_team].sum())
