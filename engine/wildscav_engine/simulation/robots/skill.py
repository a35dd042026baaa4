"""How well a robot plays: three levels, each a set of limits to what its kind can do."""

from typing import NamedTuple

from wildscav_engine.compilation.kernel import kernel


class Skill(NamedTuple):
    """The limits of a level."""

    wander_speed: float  # m/s
    speed: float  # m/s, towards what it wants
    turn_limit: float  # degrees a step
    aim_error: float  # degrees to each side, at most
    aimed: float  # degrees off the enemy at which it fires
    foresight: float  # s that it aims ahead, itself and a moving enemy
    patience: float  # steps without a box after which the one in sight counts as out of reach


LEVELS = ("easy", "normal", "hard")
EASY = Skill(3.0, 4.0, 12.0, 12.0, 6.0, 0.0, 60.0)
NORMAL = Skill(6.0, 8.0, 25.0, 3.0, 4.0, 0.0, 60.0)
HARD = Skill(7.0, 10.0, 60.0, 0.7, 4.0, 0.1, 50.0)


@kernel
def skill_of(robot: int) -> Skill:
    """Return the limits of a robot, by its number."""
    level = robot % 10
    if level == 0:
        return EASY
    return NORMAL if level == 1 else HARD
