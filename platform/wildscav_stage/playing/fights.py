"""The scores of all, and what they did to each other, for the table at the end of a match."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.actions import Field

if TYPE_CHECKING:
    from wildscav_engine.simulation.match import Match

COLUMNS = (("kills", ""), ("deaths", ""), ("dealt", "hp"), ("taken", "hp"), ("accuracy", "%"))


class Fights:
    """Adds up the damage of a match, frame by frame, from its start."""

    def __init__(self, match: "Match") -> None:
        self._match, self._noted = match, match.frame
        self._health = match.state.agents.health[0].copy()
        self._dealt, self._taken = np.zeros_like(self._health), np.zeros_like(self._health)

    def note(self) -> None:
        """Note a frame that was played; it may be called several times."""
        agents = self._match.state.agents
        if self._match.frame == self._noted:
            return
        self._noted = self._match.frame
        lost = np.maximum(0, self._health - agents.health[0])  # health only grows by a respawn
        self._taken += lost
        self._health[:] = agents.health[0]
        shooters = np.flatnonzero(agents.hit_seat[0] != NOBODY)
        victims = agents.hit_seat[0, shooters]
        # A hit that kills counts what was left. Two in one frame count the same health twice.
        self._dealt[shooters] += np.minimum(agents.shot_damage[0, shooters], lost[victims])

    def columns(self, titles: list[dict[str, str]]) -> list[dict[str, str]]:
        """Return the title and unit of each figure that has none of some titles; none if nobody shoots."""
        if Field.SHOOT not in self._match.track.fields:
            return []
        known = {title["title"] for title in titles}
        return [{"title": title, "unit": unit} for title, unit in COLUMNS if title not in known]

    def figure(self, seat: int, title: str) -> int | None:
        """Return a figure of a seat; None is the accuracy of who has not fired."""
        agents = self._match.state.agents
        shots, hits = int(agents.shots[0, seat]), int(agents.hits[0, seat])
        figures: dict[str, Any] = {
            "kills": agents.kills[0, seat],
            "deaths": agents.deaths[0, seat],
            "dealt": self._dealt[seat],
            "taken": self._taken[seat],
            "accuracy": round(100 * hits / shots) if shots else None,
        }
        return None if figures[title] is None else int(figures[title])


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
