"""Who plays against the learners of a run: robots, submissions, and copies of the policy itself."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import cycle, islice
from pathlib import Path
from typing import Any

from wildscav.baselines import is_baseline
from wildscav.errors import UserError
from wildscav_engine.simulation.robots.decide import KINDS, ROBOTS
from wildscav_engine.tracks import TRACKS
from wildscav_training.opponents import submission

SELF = "self"  # among the names: copies of the policy


@dataclass(frozen=True)
class Opposition:
    """The opponents of a run."""

    names: tuple[str, ...]  # robots, submissions and "self"
    seats: int  # that they fill in a match
    easy_first: bool = False  # whether robots begin with their easy level

    def as_json(self) -> dict[str, Any]:
        """Return it as values for JSON."""
        return {"names": list(self.names), "seats": self.seats, "easy_first": self.easy_first}

    @property
    def plays_itself(self) -> bool:
        """Whether copies of the policy are among them."""
        return SELF in self.names

    @property
    def robots(self) -> tuple[tuple[str, ...], ...]:
        """The levels of each robot that the learner meets one after the other; the last is the one named."""
        names = [name for name in self.names if name in ROBOTS]
        return tuple(_levels_to(name) if self.easy_first else (name,) for name in names)

    @property
    def submissions(self) -> tuple[str, ...]:
        """The submissions among them: names of baselines, or folders."""
        return tuple(name for name in self.names if name != SELF and name not in ROBOTS)


def _levels_to(name: str) -> tuple[str, ...]:
    """Return the levels of a robot, from the easy one to the one of this name."""
    kinds = ([robot.name for robot in levels] for levels in KINDS.values())
    names = next(names for names in kinds if name in names)
    return tuple(names[: names.index(name) + 1])


def read_opposition(
    text: str, track: str, options: Mapping[str, Any], seats: int | None, *, easy_first: bool
) -> Opposition:
    """Return the opponents that a command names.

    Args:
        text: Their names, separated by commas.
        seats: How many seats they fill; None: those that the track's own opponents would fill.

    Raises:
        UserError: There is no such opponent, or there is no seat for it.
    """
    names = tuple(name.strip() for name in text.split(",") if name.strip())
    if not names or len(set(names)) < len(names):
        raise UserError(f"--opponents is {text!r}, must be different names separated by commas", exit_code=2)
    for name in names:
        _check(name, track)
    learners = int(options.get("agents", 1)) + len(options.get("teammates", ()))
    free = TRACKS[track].opponents + 1 - learners if seats is None else seats
    if free < 1:
        raise UserError(
            f"--opponents: {learners} learners leave no seat in {track}; give --opponent-seats", exit_code=2
        )
    return Opposition(names, free, easy_first)


def _check(name: str, track: str) -> None:
    """Check that there is an opponent of a name, and that it plays a track."""
    if name == SELF or name in ROBOTS:
        return
    if not is_baseline(name) and not Path(name).is_dir():
        raise UserError(
            f"--opponents: there is no {name!r}; allowed are self, the folder or name of a submission, and "
            f"the robots {', '.join(ROBOTS)}",
            exit_code=2,
        )
    try:
        submission(name).check(track)
    except ValueError as error:
        raise UserError(f"--opponents: {error}", exit_code=2) from None


def fixed_opponents(opposition: Opposition) -> list[Any]:
    """Return who fills the opponents' seats when a policy is measured: everybody named but the policy itself.

    They take turns, robots at the level that was named. If only the policy itself was named, it is measured
    against ``fighter``.
    """
    players: list[Any] = [levels[-1] for levels in opposition.robots]
    players += [submission(name) for name in opposition.submissions]
    return list(islice(cycle(players or ["fighter"]), opposition.seats))
