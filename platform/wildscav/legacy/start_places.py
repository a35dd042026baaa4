"""The starts and targets that a client requests, moved to usable places."""

from typing import TYPE_CHECKING

import numpy as np

from wildscav.legacy.episode import Episode

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.specs.match_spec import MatchSpec, Position


def with_usable_places(episode: Episode, game_map: "GameMap") -> "tuple[MatchSpec, list[str]]":
    """Return the spec of an episode with usable starts and target, and a log line for each that was moved.

    The client's default start is the middle of the map, whatever is there, and the original refused no place.
    So a place where no agent can stand, or that it cannot leave, is replaced by the nearest valid location.
    """
    spec, moved = episode.spec, []

    def usable_or_none(place: "Position | None", name: str, reach: float | None) -> "Position | None":
        if place is None:
            return None
        usable = _nearest_usable(game_map, place, reach)
        if usable != place:
            moved.append(f"{name} {_text(place)} is not usable: {_text(usable)} is used instead")
        return usable

    starts = [
        usable_or_none(place, f"start_location of agent {agent}", None)
        for place, agent in zip(spec.start_of_seats, episode.ids, strict=True)
    ]
    target = usable_or_none(spec.target, "target_location", spec.rules.target_distance)
    if not moved:
        return spec, moved
    return spec.model_copy(update={"starts": tuple(starts), "target": target}), moved


def _nearest_usable(game_map: "GameMap", place: "Position", reach: float | None) -> "Position":
    """Return a place if it is usable, else the nearest of the map's locations that is."""
    from wildscav_engine.simulation.setup.starts import usable_place

    if (usable := usable_place(game_map, place, reach)) == place:
        return place
    locations = np.concatenate([game_map.indoor, game_map.outdoor])
    offsets = locations - np.array(place)
    for x, y, z in locations[np.argsort((offsets * offsets).sum(axis=1), kind="stable")].tolist():
        if usable_place(game_map, (x, y, z), reach) == (x, y, z):
            return x, y, z
    return usable


def _text(place: "Position") -> str:
    return f"({', '.join(f'{number:.2f}' for number in place)})"
