"""Every rule of the game that an organizer may change between matches.

Body and motion limits are not here. They are constants of the engine (``body.py``), because the reachable
places of a map depend on them.
"""

from enum import IntEnum
from typing import Annotated, Any, Literal, NamedTuple

from pydantic import BeforeValidator, Field, PlainSerializer, TypeAdapter

from wildscav_engine.compilation.kernel import kernel

FRAMES_PER_SECOND = 50
FRAME = 1.0 / FRAMES_PER_SECOND  # s
AT_ONCE = 180.0 * FRAMES_PER_SECOND  # degrees/s, a turn that faces any direction in one frame


class Senses(IntEnum):
    """What agents are told about other agents and supply boxes, apart from what their images show."""

    ORIGINAL = 0  # agents in sight with velocity, health and invincibility; boxes nearby, behind walls too
    SIGHTED = 1  # agents and boxes in sight, without velocity and health
    PIXELS = 2  # neither


def _senses_by_name(value: Any) -> Any:
    names = [senses.name.lower() for senses in Senses]
    if isinstance(value, Senses) or (type(value) is int and 0 <= value < len(names)):
        return int(value)
    if value not in names:
        raise ValueError(f"{value!r} are no senses; the senses are {', '.join(names)}")
    return names.index(value)


class Rules(NamedTuple):
    """The rules that an organizer may change between matches."""

    # Motion:
    water_speed_factor: Annotated[float, Field(gt=0, le=1)] = 0.5
    # Body:
    start_health: Annotated[int, Field(ge=1, le=10_000)] = 100  # hp
    respawn_time: Annotated[float, Field(gt=0, le=600)] = 10.0  # s
    invincible_time: Annotated[float, Field(ge=0, le=600)] = 10.0  # s, after a respawn
    # Weapon:
    clip_size: Annotated[int, Field(ge=1, le=1000)] = 15
    spare_ammo: Annotated[int, Field(ge=0, le=100_000)] = 60
    shot_damage: Annotated[int, Field(ge=0, le=10_000)] = 20  # hp
    fire_interval: Annotated[float, Field(gt=0, le=60)] = 0.2  # s
    reload_time: Annotated[float, Field(gt=0, le=60)] = 2.0  # s
    bullet_range: Annotated[float, Field(gt=0, le=2000)] = 200.0  # m
    # Supplies:
    pick_up_distance: Annotated[float, Field(gt=0, le=20)] = 1.5  # m, from the soles to the box
    supply_loss: Annotated[float, Field(ge=0, le=1)] = 0.5  # share dropped on death
    # Sight:
    supply_sight: Annotated[float, Field(ge=0, le=200)] = 20.0  # m, no occlusion
    target_sight: Annotated[float, Field(ge=0, le=200)] = 20.0  # m, within which a hidden target is found
    view_angle: Annotated[float, Field(gt=0, lt=180)] = 90.0  # degrees horizontally, 9/16 of that vertically
    # Goals:
    target_distance: Annotated[float, Field(gt=0, le=20)] = 1.0  # m, from the soles to the target
    # Added after the first release: a spec contains these only where they differ from the defaults.
    senses: Annotated[int, BeforeValidator(_senses_by_name)] = int(Senses.ORIGINAL)  # in specs by name
    turn_speed: Annotated[float, Field(gt=0, le=AT_ONCE)] = AT_ONCE  # degrees/s, of yaw and of pitch
    spread: Annotated[float, Field(ge=0, le=45)] = 0.0  # degrees a shot is off at most, standing still
    recoil: Annotated[float, Field(ge=0, le=45)] = 0.0  # degrees a shot raises the view, standing still
    walking_sway: Annotated[float, Field(ge=0, le=100)] = 0.0  # how many times more of both at 10 m/s
    turning_sway: Annotated[float, Field(ge=0, le=100)] = 0.0  # how many times more of both at 100 °/s
    bounty: Annotated[int, Field(ge=0, le=10_000)] = 0  # supplies that a kill brings besides what is dropped


ADDED = Rules._fields[Rules._fields.index("senses") :]
# Rules by name. They stay as they are: other ones get another name.
NAMED = {
    "original": Rules(),
    # An eye instead of lists through walls, a body that turns in half a second, and shots that go where they
    # are aimed only if the agent slows down: what a person and a camera can do as well.
    "fair": Rules(
        senses=int(Senses.SIGHTED),
        turn_speed=360.0,
        spread=0.5,
        recoil=0.5,
        walking_sway=9.0,
        turning_sway=2.0,
    ),
}
RulesName = Literal["original", "fair"]


def _from_mapping(value: Any) -> Any:
    """Accept the name of rules, and a table that holds only the rules that differ from the defaults."""
    if isinstance(value, str):
        if value not in NAMED:
            raise ValueError(f"no rules are called {value!r}; allowed are {', '.join(NAMED)}, or a table")
        return NAMED[value]
    if isinstance(value, dict):
        unknown = sorted(set(value) - set(Rules._fields))
        if unknown:
            rules = ", ".join(Rules._fields)
            raise ValueError(f"no rule is called {', '.join(unknown)}; the rules are {rules}")
        return Rules(**value)
    return value


def _to_mapping(rules: Rules) -> dict[str, Any]:
    """Return all rules of the first release, and those added later that differ from their defaults.

    So the specs, digests and records of matches without them are what they were.
    """
    table: dict[str, Any] = rules._asdict()
    for name in ADDED:
        if table[name] == Rules._field_defaults[name]:
            del table[name]
    return table | ({"senses": Senses(rules.senses).name.lower()} if "senses" in table else {})


# Rules as a field of a spec: a table in TOML and JSON, a NamedTuple in the kernels.
RulesField = Annotated[Rules, BeforeValidator(_from_mapping), PlainSerializer(_to_mapping)]
RULES = TypeAdapter(RulesField)


@kernel
def frames(seconds: float) -> int:
    """Return a duration as the nearest whole number of frames, at least one."""
    return max(1, int(seconds * FRAMES_PER_SECOND + 0.5))
