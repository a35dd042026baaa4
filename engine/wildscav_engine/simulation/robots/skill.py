"""The skill levels of robots: each is a set of limits that all kinds share."""

from typing import NamedTuple

from wildscav_engine.compilation.kernel import kernel


class Skill(NamedTuple):
    """The limits of one level."""

    wander_speed: float  # m/s
    speed: float  # m/s, towards a goal
    turn_limit: float  # degrees per step
    aim_error: float  # degrees, maximum to each side
    aimed: float  # degrees off the enemy within which it fires
    foresight: float  # s for which it extrapolates its own motion and the enemy's
    patience: float  # steps without a box after which the box in sight counts as out of reach
    caution: float  # share of its health up to which it leaves fights with the stronger; 0: it never hides
    follows_obstacles: bool  # whether it feels its way around what is between it and its target
    # Half widths of an enemy over which its shots may be spread by its walk, where rules spread them.
    steadiness: float


LEVELS = ("easy", "normal", "hard")
EASY = Skill(3.0, 4.0, 12.0, 12.0, 6.0, 0.0, 60.0, 0.0, False, 4.0)
NORMAL = Skill(6.0, 8.0, 25.0, 3.0, 4.0, 0.0, 60.0, 0.0, False, 2.0)
HARD = Skill(7.0, 10.0, 60.0, 0.7, 4.0, 0.1, 50.0, 0.4, True, 1.0)


@kernel
def skill_of(robot: int) -> Skill:
    """Return the limits of a robot with a given number."""
    level = robot % 10
    if level == 0:
        return EASY
    return NORMAL if level == 1 else HARD
