"""Starts and targets as a client asks for them, moved to where they can be."""

from typing import TYPE_CHECKING

import numpy as np

from wildscav.legacy.episode import Episode

if TYPE_CHECKING:
    from wildscav_engine.maps import GameMap
    from wildscav_engine.specs.match_spec import MatchSpec, Position


def settle_places(episode: Episode, game_map: "GameMap") -> "tuple[MatchSpec, list[str]]":
    """Return the spec of an episode that can be played, and a line for each place that was moved for it.

    The client's default start is the middle of the map whatever is there, and the original refused no place.
    So one where nobody can stand, or from where there is no way, gives way to the nearest valid location.
    """
    spec, moved = episode.spec, []

    def settled(place: "Position | None", name: str, reach: float | None) -> "Position | None":
        if place is None:
            return None
        usable = _nearest_usable(game_map, place, reach)
        if usable != place:
            moved.append(f"{name} {_text(place)} is no place to be; it is {_text(usable)} instead")
        return usable

    starts = [
        settled(place, f"start_location of agent {agent}", None)
        for place, agent in zip(spec.start_of_seats, episode.ids, strict=True)
    ]
    target = settled(spec.target, "target_location", spec.rules.target_distance)
    if not moved:
        return spec, moved
    return spec.model_copy(update={"starts": tuple(starts), "target": target}), moved


def _nearest_usable(game_map: "GameMap", place: "Position", reach: float | None) -> "Position":
    """Return a place if one can be there, else the nearest of the map's locations where one can."""
    from wildscav_engine.simulation.setup.starts import usable_place

    if (usable := usable_place(game_map, place, reach)) == place:
        return place
    locations = np.concatenate([game_map.indoor, game_map.outdoor])
    ways = locations - np.array(place)
    for x, y, z in locations[np.argsort((ways * ways).sum(axis=1), kind="stable")].tolist():
        if usable_place(game_map, (x, y, z), reach) == (x, y, z):
            return x, y, z
    return usable


def _text(place: "Position") -> str:
    return f"({', '.join(f'{number:.2f}' for number in place)})"
