"""What an agent is, what it senses and what it may do.

Units are metres, seconds and degrees. y is up, x east, z north; the middle of the map is (0, 0). Yaw 0
looks along +z and grows clockwise seen from above; positive pitch looks down.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, NamedTuple, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from wildscav.errors import AgentError

Vector: TypeAlias = tuple[float, float, float]  # (x, y, z), m or m/s


class LazyRecord:
    """Base of frozen dataclasses with slots, constructed with all fields or with ``read_by``.

    Such a record decodes each field of a message when it is first read. Most agents read only a few of the
    many fields. Decoding all of them takes 24 µs, and three times as long where ten agents share two cores
    and their caches are cold: a fifth of the processor time of an agent's step.
    """

    __slots__ = ("_read",)

    @classmethod
    def read_by(cls, read: Callable[[str], Any]) -> Self:
        """Return a record that calls ``read`` with the name of each field, once, when it is first read."""
        record = object.__new__(cls)
        object.__setattr__(record, "_read", read)
        return record

    if not TYPE_CHECKING:  # otherwise type checkers would accept a misspelt field

        def __getattr__(self, name: str) -> Any:
            """Decode a field. Python calls this for attributes that are not set."""
            if name not in self.__dataclass_fields__:
                kind = type(self).__name__
                raise AttributeError(f"{kind!r} object has no attribute {name!r}", name=name, obj=self)
            value = self._read(name)
            object.__setattr__(self, name, value)
            return value


@dataclass(frozen=True, slots=True)
class Action:
    """What an agent intends for one step. The default is "no action": stand still, hold everything.

    Numbers may be any real number (NumPy's too); flags are True or False. The server plays an action with
    a speed outside 0 to 10, or with a number that is not finite, as no action. Fields outside the track's
    action set are ignored.

    Raises:
        AgentError: A field is not of its type.
    """

    walk_direction: float = 0.0  # degrees, compass: 0 is north (+z), 90 is east (+x); any finite value
    walk_speed: float = 0.0  # m/s, 0 to 10
    turn: float = 0.0  # degrees a frame, added to the yaw; positive turns right
    look: float = 0.0  # degrees a frame, added to the pitch; positive looks down
    jump: bool = False  # up to 1.27 m high, from the ground; not in water
    pick_up: bool = False  # the supply boxes within reach; gathering, battle and royale
    shoot: bool = False  # where the agent looks, as often as the weapon can; battle and royale
    reload: bool = False  # the weapon; battle and royale

    def __post_init__(self) -> None:
        for name, kind in ACTION_FIELDS.items():
            value = getattr(self, name)
            if type(value) is not kind:
                object.__setattr__(self, name, (_number if kind is float else _flag)(name, value))


# The types of the fields by name, in the order of the engine's rows; the protocol has the same names.
ACTION_FIELDS: dict[str, type] = {field.name: type(field.default) for field in fields(Action)}


def _number(name: str, value: object) -> float:
    try:
        if isinstance(value, str | bytes):
            raise TypeError
        return float(value)  # type: ignore[arg-type]
    except (TypeError, ValueError):
        raise AgentError(f"Action: {name} is {value!r}, must be a number") from None
    except OverflowError:
        return math.inf


def _flag(name: str, value: object) -> bool:
    # An array of one element also counts as a flag, and so do the numbers 0 and 1.
    if isinstance(value, np.bool_ | np.ndarray | np.generic) and np.size(value) == 1:
        value = np.asarray(value).item()
    if isinstance(value, int | float) and value in (0, 1):
        return bool(value)
    raise AgentError(f"Action: {name} is {value!r}, must be True or False")


@dataclass(frozen=True, slots=True)
class SupplyWave:
    """Supply boxes that appear at one moment, most densely around a centre."""

    time: float  # s of game time; 0 is the start of the match
    center: tuple[float, float]  # x, z in m
    radius: float  # m, standard deviation of the heat map


@dataclass(frozen=True, slots=True)
class MatchInfo:
    """What an agent learns before the first step."""

    track: str  # its name, such as "navigation"; a package may add others
    seat: int  # own, 0 to seats - 1
    seats: int  # of the match, robots' included
    team: int  # own, from 0; seats of one team share what they win
    time_limit: float  # s of game time
    frames_per_action: int  # frames in a step
    map_size: float  # m, of each side; x and z are within half of it
    start: Vector  # m, soles of the feet
    target: Vector | None  # m, the place to reach (navigation); None if it has to be found (capture)
    supply_waves: tuple[SupplyWave, ...]  # by time; () in tracks without supplies
    seed: int  # private random seed; the same when the same submission plays the same match
    step_budget: float  # s to answer an observation without spending the time bank
    time_bank: float  # s for answers beyond the budget, in the whole match
    target_distance: float  # m, within which the target counts as reached
    pick_up_distance: float  # m, within which a box can be picked up
    supply_sight: float  # m, within which a box is seen
    clip_size: int  # rounds
    start_health: int  # hp
    respawns: bool = True  # whether the dead come back; if not, they are out of the match (royale)
    supply_goal: int = 0  # what a team must carry to end the match, 0 for no goal (gathering)
    frames_per_second: int = 50  # of game time
    senses: str = "original"  # what is told of others and boxes: "original", "sighted" or "pixels"
    turn_speed: float = 9000.0  # degrees/s, of yaw and of pitch at most; 9000: any turn in one frame
    spread: float = 0.0  # degrees a shot is off at most, for an agent that stands still
    recoil: float = 0.0  # degrees a shot raises the view, for an agent that stands still
    walking_sway: float = 0.0  # how many times more spread and recoil there are at 10 m/s
    turning_sway: float = 0.0  # how many times more spread and recoil there are at a turn of 100 degrees/s
    bounty: int = 0  # supplies that a kill brings besides what the dead drops
    clock: str = "bank"  # what thinking costs: "bank" or "paused" (time), "running" or "tokens" (game time)
    token_time: float = 0.0  # by the clock "tokens", s of game time for each token that a model writes
    processor_time: float = 0.0  # by the clock "tokens", s of game time for each s of a processor

    @property
    def step_time(self) -> float:
        """Game time of one step, s."""
        return self.frames_per_action / self.frames_per_second


class VisibleAgent(NamedTuple):
    """Another agent in sight."""

    seat: int  # 0 to seats - 1
    team: int  # an enemy's, if it is not one's own
    position: Vector  # m, soles of its feet
    velocity: Vector  # m/s; 0 if the senses are not "original"
    yaw: float  # degrees in (-180, 180]
    health: int  # hp, above 0; 0 if the senses are not "original"
    invincible: bool  # takes no damage, for a while after a respawn


class SupplyBox(NamedTuple):
    """A supply box nearby."""

    id: int  # never used twice in a match
    position: Vector  # m
    quantity: int  # supplies in it, above 0


@dataclass(frozen=True, slots=True)
class Observation(LazyRecord):
    """What an agent senses before a step."""

    step: int  # number of the step that an action is wanted for
    frame: int  # frames played so far
    time: float  # s of game time so far
    time_bank: float  # s of the agent's time bank left
    position: Vector  # m, soles of the feet
    velocity: Vector  # m/s
    yaw: float  # degrees in (-180, 180]; 0 is north (+z), positive is right of it
    pitch: float  # degrees in [-90, 90]; positive looks down
    on_ground: bool  # not in the air: it may jump
    in_water: bool  # wading, which is slower
    alive: bool  # if not, its actions have no effect
    health: int  # hp, 0 = dead
    clip: int  # rounds in the weapon
    spare_ammo: int  # rounds carried in addition to the clip
    reloading: bool  # the weapon, which cannot fire meanwhile
    fired: bool  # in the last step
    hit_seat: int | None  # the seat that it hit in the last step
    hit_by_seat: int | None  # the seat that hit it in the last step
    invincible: bool  # takes no damage, for a while after a respawn
    respawn_in: float  # s until a dead agent comes back, 0 for one alive
    can_pick_up: bool  # a supply box is within reach
    supplies: int  # carried
    gained: int  # supplies picked up in the last step
    target: Vector | None = None  # m, the place to reach, as soon as the agent's team knows it
    agents: tuple[VisibleAgent, ...] = ()  # in sight, nearest first, 16 at most
    supply_boxes: tuple[SupplyBox, ...] = ()  # within supply_sight, nearest first, 32 at most
    tensors: Mapping[str, NDArray[Any]] = field(default_factory=dict)  # sensor readings by name, read-only
    team_supplies: int = 0  # carried by the agent's team together
    reload_in: float = 0.0  # s until the weapon is reloaded, 0 if it is not being reloaded
    invincible_in: float = 0.0  # s until the agent can be hurt again, 0 if it can be now

    @property
    def depth(self) -> NDArray[np.float32]:
        """The depth map: (height, width) m, row 0 at the top, ``far`` where nothing is hit.

        Raises:
            AgentError: The submission did not ask for it.
        """
        return self.sensor("depth")

    def sensor(self, name: str) -> NDArray[Any]:
        """Return what a sensor of the ``submission.toml`` reads, by its name, as a read-only array.

        Raises:
            AgentError: The submission did not ask for it.
        """
        try:
            return self.tensors[name]
        except KeyError:
            asked = ", ".join(sorted(self.tensors)) or "none"
            raise AgentError(
                f"this agent did not ask for the sensor {name!r} (it has {asked}): "
                f"add a [sensors.{name}] table to its submission.toml"
            ) from None


class Agent:
    """Base of all agents: override ``act``, and ``reset`` if something must be set up before a match.

    One object plays one match. The time to import the module, construct the agent and ``reset`` it counts as
    start-up, which has its own limit.
    """

    def reset(self, match: MatchInfo) -> None:
        """Get ready for a match."""

    def act(self, observation: Observation) -> Action:
        """Return what to do in the next step.

        Args:
            observation: What the agent senses now. Dead agents are asked too; their actions have no effect.
        """
        raise NotImplementedError(f"{type(self).__name__} must have a method act(self, observation)")


def check_action(agent: object, answer: object) -> Action:
    """Return an agent's answer if it is an action.

    Raises:
        AgentError: It is not.
    """
    if isinstance(answer, Action):
        return answer
    raise AgentError(
        f"{type(agent).__name__}.act() must return an Action, such as Action(walk_speed=5.0), and returned "
        f"{_shown(answer)}"
    )


def _shown(value: object) -> str:
    if value is None:
        return "None (is a return missing?)"
    text = repr(value)
    return f"{text if len(text) <= 60 else text[:57] + '...'} of type {type(value).__name__}"
