"""Entrants of matches as people read them: a submission with its version and its team, or a robot."""

from typing import NamedTuple

from wildscav_evaluator.seats import ROBOT_ENTRANT


class EntrantNames(NamedTuple):
    """What people read of a submission that plays."""

    name: str  # its name and version
    team: str
    team_title: str


def titled(name: str, version: str) -> str:
    """Return a submission's name and version as people read them."""
    return f"{name} {version}"


def robot_name(entrant: str) -> str:
    """Return a robot's name as people read it."""
    return entrant.removeprefix(ROBOT_ENTRANT)
