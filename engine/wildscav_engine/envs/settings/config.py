"""All options of an environment in one immutable object."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, Field, ValidationError, field_validator, model_validator

from wildscav_engine.envs.registry import VERSION, Version
from wildscav_engine.envs.settings.functions import checked_observers, checked_rewards
from wildscav_engine.envs.settings.players import ActionMode, Player, Sampler, read_entry, seat_entry
from wildscav_engine.maps.levels import Level
from wildscav_engine.maps.pools import Split
from wildscav_engine.sensors import Sensor, allowed_sensors, parse_sensors
from wildscav_engine.sensors.base import StateSensor
from wildscav_engine.specs.actions import Field as ActionField
from wildscav_engine.specs.base import Spec
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import SUBMISSION, MatchSpec, Position
from wildscav_engine.specs.rules import Rules, RulesField, Senses
from wildscav_engine.specs.supply_config import SupplyConfig
from wildscav_engine.specs.validation import did_you_mean, one_line
from wildscav_engine.specs.zone_config import ZoneConfig
from wildscav_engine.tracks import TRACKS
from wildscav_engine.tracks.rewards import RewardSum

RenderMode = Literal["rgb_array", "depth_array", "human", "rerun"]
RenderView = Literal["eyes", "behind", "top"]
Width = Annotated[int, Field(ge=16, le=1920)]  # pixels
Height = Annotated[int, Field(ge=16, le=1080)]  # pixels
Maps = int | tuple[int, ...] | MapSpec | MapConfig
PlayerEntry = Annotated[Any, AfterValidator(read_entry)]  # becomes a ``Player`` or a ``Sampler``
# By name; see ``settings/functions.py``.
RewardFunctions = Annotated[dict[str, Any], AfterValidator(checked_rewards)]
Observers = Annotated[dict[str, Any], AfterValidator(checked_observers)]

MAX_TEAMMATES = 7  # in the default observations of a learner, the nearest ones


class EnvConfig(Spec):
    """The options of an environment: map, players, duration, rules, observations, actions and rewards."""

    track: str  # by name
    map: Maps | None = None  # numbers, a MapSpec, or a MapConfig for random ones; None: of the level
    level: Level = "normal"  # how hard random maps are, from "easy" to "expert"
    split: Split = "train"  # which seeds to use: "train" or "test"
    random_maps: Annotated[int, Field(ge=1, le=100_000)] = 64  # their number; each episode is played on one
    unseen: bool = False  # random maps of the split "test" hold only pieces that those of "train" lack
    start: Position | None = None  # x, y, z in m, of the first seat; None: a random place
    starts: tuple[Position | None, ...] | None = None  # x, y, z in m, of every seat; None: random places
    start_range: Annotated[float, Field(ge=0, le=2000)] | None = None  # m, distance of starts from the target
    target: Position | None = None  # x, y, z in m; None: a random place
    # Seats: learners first, then the others on their team, then opponents; see ``settings/players.py``.
    agents: Annotated[int, Field(ge=1, le=1000)] = 1  # number of learners; they have the first seats
    teammates: tuple[PlayerEntry, ...] = ()  # who else is on the learners' team, an entry for each seat
    opponents: tuple[PlayerEntry, ...] | None = None  # who plays against the learners; None: as in the track
    teams: tuple[int, ...] | None = None  # None: one a seat; learners share one in capture or with teammates
    # Duration and rules.
    time_limit: Annotated[float, Field(gt=0, le=86_400)] | None = None  # s of game time; None: the track's
    frames_per_action: Annotated[int, Field(ge=1, le=50)] = 5  # frames of 1/50 s for which an action is held
    rules: RulesField = Rules()  # those that differ from the default, or their name: "original" or "fair"
    supplies: SupplyConfig | None = None  # as in a MatchSpec; None: the default of the map or the track
    supply_goal: Annotated[int, Field(ge=1, le=1_000_000)] | None = None  # supplies with which a team wins
    zone: ZoneConfig | None = None  # as in a MatchSpec; None: the track's default
    # Observations, actions and rewards.
    version: Version = VERSION  # of the observations: the number after v in ids
    sensors: dict[str, dict[str, Any]] | None = None  # by name, with options; None: the track's default
    rewards: dict[str, float] | None = None  # weights by the names of terms; None: the track's default
    reward_functions: RewardFunctions = Field(default_factory=dict)  # terms of your own, by name
    observers: Observers = Field(default_factory=dict)  # observations of your own, by name
    action_mode: ActionMode = "dict"  # the format of actions
    flat: bool = False  # rows of numbers, each divided by its usual magnitude; values in infos are arrays
    all_metrics: bool = False  # in infos: also those that take long to measure, such as SPL
    # Rendering and execution.
    render_mode: RenderMode | None = None  # "human": a window; "rerun": a live view in 3D
    render_view: RenderView = "eyes"  # of the first learner; "behind" it; or the map from the "top"
    render_size: tuple[Width, Height] | None = None  # pixels; None: 320 × 180, of a window 960 × 540
    threads: Annotated[int, Field(ge=1, le=1024)] = 1  # for large batches and images; results stay equal

    @field_validator("teammates", "opponents", mode="before")
    @classmethod
    def _is_list_of_players(cls, value: object) -> object:
        if value is None or isinstance(value, list | tuple):
            return value
        raise ValueError(f"{value!r} is not a list with an entry for each seat, such as ('fighter',) * 3")

    @field_validator("map", mode="before")
    @classmethod
    def _is_map(cls, value: object) -> object:
        if value is None or isinstance(value, int | list | tuple | dict | MapSpec | MapConfig):
            return value
        raise ValueError(f"{value!r} is no map; allowed are a number, several, a MapSpec and a MapConfig")

    @model_validator(mode="after")
    def _is_consistent(self) -> Self:
        if self.track not in TRACKS:
            raise ValueError(f"track is {self.track!r}; the tracks are {', '.join(TRACKS)}")
        self.match_spec()
        self.read_sensors()
        RewardSum(self.reward_weights)
        return self

    @property
    def all_opponents(self) -> tuple[Player | Sampler, ...]:
        """The opponents of the learners."""
        if self.opponents is not None:
            return self.opponents
        # Robots fill the seats that further learners would fill.
        missing = TRACKS[self.track].opponents + 1 - self.agents - len(self.teammates)
        return (TRACKS[self.track].robot,) * max(0, missing)

    @property
    def players(self) -> tuple[Player | Sampler, ...]:
        """What plays in each seat behind the learners'."""
        return self.teammates + self.all_opponents

    @property
    def seats(self) -> tuple[str, ...]:
        """What fills each seat, as in the spec of a match: policies count as submissions."""
        return (SUBMISSION,) * self.agents + tuple(map(seat_entry, self.players))

    @property
    def team_of_seats(self) -> tuple[int, ...] | None:
        """The team of each seat; None for the track's default.

        With teammates, and in cooperative tracks, the learners form one team and each opponent is a team of
        its own. Otherwise, each seat is a team of its own.
        """
        if self.teams is not None:
            return self.teams
        together = self.agents + len(self.teammates)
        is_competitive = TRACKS[self.track].teams(2) == (0, 1)
        if is_competitive and not self.teammates:
            return None
        return (0,) * together + tuple(range(1, 1 + len(self.all_opponents)))

    @property
    def reward_weights(self) -> Mapping[str, float]:
        """The weight of each reward term."""
        return TRACKS[self.track].rewards if self.rewards is None else self.rewards

    @property
    def fields(self) -> tuple[ActionField, ...]:
        """The action set of the track, in order."""
        return tuple(field for field in ActionField if field in TRACKS[self.track].fields)

    def read_sensors(self) -> dict[str, Sensor]:
        """Return the sensors by name."""
        senses = self.rules.senses
        if self.sensors is not None:
            chosen = allowed_sensors(parse_sensors(self.sensors), self.rules)
            if senses == Senses.PIXELS and (lists := sorted(set(chosen) - set(_without_lists(chosen)))):
                raise ValueError(
                    f"sensors.{lists[0]} lists what is in sight, which the senses 'pixels' never tell"
                )
            return chosen
        teams = self.match_spec().team_of_seats
        mates = max(teams.count(teams[seat]) for seat in range(self.agents)) - 1
        additional: dict[str, dict[str, Any]] = {"hot_spot": {}} if self._has_hot_spot() else {}
        if mates:
            additional["teammates"] = {"limit": min(mates, MAX_TEAMMATES)}
        default = parse_sensors(TRACKS[self.track].sensors | additional)
        return _without_lists(default) if senses == Senses.PIXELS else default

    def _has_hot_spot(self) -> bool:
        """Return whether there is a hot spot in the environment's matches."""
        spec = self.match_spec()
        if isinstance(self.map, MapSpec | MapConfig):
            chosen = self.map if isinstance(self.map, MapSpec) else MapSpec(config=self.map)
            spec = spec.model_copy(update={"map": chosen})
        supplies = TRACKS[self.track].supplies(spec)
        return supplies is not None and supplies.hot_spot is not None

    def match_spec(self) -> MatchSpec:
        """Return the spec of the match, without its map and its seed."""
        return MatchSpec(
            teams=self.team_of_seats,
            time_limit=TRACKS[self.track].time_limit if self.time_limit is None else self.time_limit,
            **{name: getattr(self, name) for name in OF_MATCHES},
        )


def _without_lists(sensors: Mapping[str, Sensor]) -> dict[str, Sensor]:
    """Return the sensors that need no list of what is in sight."""
    return {
        name: sensor
        for name, sensor in sensors.items()
        if not isinstance(sensor, StateSensor) or sensor.sight == "none"
    }


# What the spec of a match has as it is here.
OF_MATCHES = (
    *("track", "seats", "frames_per_action", "start", "starts", "start_range", "target"),
    *("supplies", "supply_goal", "zone", "rules"),
)

# What ``set_options`` may change from the next episode on: neither spaces, nor players, nor rules.
CHANGEABLE = (
    *("map", "level", "split", "random_maps", "unseen", "start", "starts", "start_range", "target"),
    *("time_limit", "supplies", "supply_goal", "zone", "rewards"),
)
ONCE = ("start", "start_range", "target", "map")  # what the options of a reset set for one episode


def change_config(config: EnvConfig, changes: Mapping[str, Any]) -> EnvConfig:
    """Return the options of an environment with changes that it can make between episodes.

    Terms of the reward that are not named get the weight 0. The errors are those of ``read_config``.
    """
    if fixed := sorted(changes.keys() - set(CHANGEABLE)):
        hint = "" if fixed[0] in EnvConfig.model_fields else did_you_mean(fixed[0], CHANGEABLE)
        raise ValueError(
            f"{fixed[0]} cannot change between episodes{hint}; these options can: {', '.join(CHANGEABLE)}"
        )
    changed = with_changes(config, changes)
    if changed.level != config.level and changed.map is not None and "map" not in changes:
        raise ValueError(
            "level has no effect with a map; a ladder's level is chosen where the environment is made"
        )
    if changed.read_sensors() != config.read_sensors():
        raise ValueError(
            "a hot spot that comes or goes would change what is observed by default: name the sensors where "
            "the environment is made, with hot_spot among them"
        )
    terms, weights = config.reward_weights, changed.reward_weights
    if missing := sorted(weights.keys() - terms.keys()):
        raise ValueError(
            f"rewards: {missing[0]!r} is not among the terms with which the environment was made "
            f"({', '.join(terms)}): name it there, with the weight 0"
        )
    return changed.model_copy(update={"rewards": {term: weights.get(term, 0.0) for term in terms}})


def config_of_episode(config: EnvConfig, options: Mapping[str, Any]) -> EnvConfig:
    """Return the options of one episode: an environment's, apart from what a reset sets."""
    check_reset(options, ONCE)
    changed = with_changes(config, {**options, **({"starts": None} if "start" in options else {})})
    is_random = changed.map is None or isinstance(changed.map, MapConfig)
    return changed.model_copy(update={"unseen": config.unseen and is_random})


def check_reset(options: Any, known: Sequence[str]) -> None:
    """Refuse options of a reset that are no dictionary of known ones, in one line that names these."""
    if not isinstance(options, Mapping):
        raise ValueError(f"options is {options!r}, must be a dictionary with some of {', '.join(known)}")
    if unknown := sorted(map(str, options.keys() - set(known))):
        hint = did_you_mean(unknown[0], known)
        raise ValueError(f"a reset has no option {unknown[0]!r}{hint}; its options are {', '.join(known)}")


def with_changes(config: EnvConfig, changes: Mapping[str, Any]) -> EnvConfig:
    """Return validated options with changes of any of them; the errors are those of ``read_config``."""
    return read_config(config.track, {**options_of(config), **changes})


def options_of(config: EnvConfig) -> dict[str, Any]:
    """Return the options that make an environment as it is now, those of its preset among them."""
    return {name: getattr(config, name) for name in EnvConfig.model_fields if name != "track"}


def read_config(track: str, options: Mapping[str, Any], **defaults: Any) -> EnvConfig:
    """Return the validated options of an environment.

    Args:
        options: Values by the names of the fields of ``EnvConfig``; ``preset`` names a preset to start from.
        defaults: Values of options that neither ``options`` nor the preset sets.

    Raises:
        ValueError: An option is invalid; the message is one line that says which and what is allowed.
        TypeError: There is no such option.
    """
    from wildscav_engine.envs.settings.presets import preset_options

    given = dict(options)
    preset = given.pop("preset", None)
    base = {} if preset is None else preset_options(preset, track, given.get("level", "normal"))
    unknown = sorted(given.keys() - set(EnvConfig.model_fields))
    if unknown:
        known = ["preset", *(name for name in EnvConfig.model_fields if name != "track")]
        hint = did_you_mean(unknown[0], known)
        # The message is Python's own, because some trainers probe which arguments an environment accepts.
        raise TypeError(
            f"unexpected keyword argument {unknown[0]!r}{hint}; the options are {', '.join(known)}"
        )
    try:
        return EnvConfig(**{**defaults, **base, **given, "track": track})
    except ValidationError as error:
        raise ValueError(one_line(error)) from None
