"""What a page shows beside the picture: a person's own observation, and the scores of all."""

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from wildscav.agent import MatchInfo, Observation, Vector

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match


class Events:
    """What happened to a person since the last picture, because a picture may be of several steps."""

    def __init__(self) -> None:
        self._fired, self._hits, self._hurt, self._gained = False, 0, 0, 0

    def note(self, observation: Observation) -> None:
        """Note what happened in the last step."""
        self._fired |= observation.fired
        self._hits += observation.hit_seat is not None
        self._hurt += observation.hit_by_seat is not None
        self._gained += observation.gained

    def take(self) -> dict[str, Any]:
        """Return what happened, and forget it."""
        taken = {"fired": self._fired, "hits": self._hits, "hurt": self._hurt, "gained": self._gained}
        self._fired, self._hits, self._hurt, self._gained = False, 0, 0, 0
        return taken


# What the page shows of an observation as it is.
SHOWN = (
    *("time", "health", "alive", "respawn_in", "invincible_in", "clip", "spare_ammo", "reload_in"),
    *("supplies", "can_pick_up", "in_water", "yaw"),
)


def display_of(observation: Observation, match: MatchInfo) -> dict[str, Any]:
    """Return what the page shows of an observation, as JSON has it."""
    return {
        **{name: getattr(observation, name) for name in SHOWN},
        "left": max(0.0, match.time_limit - observation.time),
        "target": _bearing(observation.position, observation.target or match.target),
        "boxes": [_bearing(observation.position, box.position) for box in observation.supply_boxes[:8]],
    }


def _bearing(here: Vector, there: Vector | None) -> dict[str, float] | None:
    """Return the direction of a place, degrees by the compass, and its distance in m."""
    if there is None:
        return None
    east, north = there[0] - here[0], there[2] - here[2]
    return {"bearing": math.degrees(math.atan2(east, north)), "distance": math.hypot(east, north)}


def scores_of(match: "Match", names: Sequence[str]) -> list[dict[str, Any]]:
    """Return the track's metrics of every seat so far, the best first by the first metric."""
    metrics = match.track.metrics
    rows = []
    for seat, name in enumerate(names):
        values = match.track.measure(match, seat)
        rows.append({"seat": seat, "name": name, "values": [values[metric.name] for metric in metrics]})
    sign = 1.0 if metrics[0].lower_is_better else -1.0
    return sorted(rows, key=lambda row: sign * row["values"][0])


def metric_titles(match: "Match") -> list[dict[str, str]]:
    """Return the titles and units of the metrics in ``scores_of``."""
    return [{"title": metric.title, "unit": metric.unit} for metric in match.track.metrics]
