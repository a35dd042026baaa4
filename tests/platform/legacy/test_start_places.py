"""Starts and targets that the client asks for, and where they are."""

from typing import Any

import numpy as np
import pytest
from tests.platform.legacy.helpers.commands import MAP, command, open_way, setup

from wildscav_engine.geometry.world import Kind
from wildscav_engine.maps import load_map
from wildscav_legacy.episode import Episode, read_episode
from wildscav_legacy.session import with_usable_places


def episode(start: Any, target: Any = None) -> Episode:
    return read_episode(command(agents=[setup(0, start)], target=open_way(12) if target is None else target))


@pytest.mark.parametrize("kind", ["indoor", "outdoor"])
def test_valid_locations_stay_as_they_are(kind: str) -> None:
    game_map = load_map(MAP)
    for place in getattr(game_map, kind)[::20].round(3).tolist():
        spec, moved = with_usable_places(episode(place), game_map)
        assert not moved
        assert spec.start_of_seats[0] == pytest.approx(place, abs=1e-5)


def test_what_is_in_a_wall_or_outside_the_map_gives_way_to_the_nearest_location() -> None:
    game_map = load_map(MAP)
    world = game_map.world
    wall = np.flatnonzero(world.solid_kind == Kind.WALL)[0]
    in_wall = ((world.solid_low[wall] + world.solid_high[wall]) / 2).round(3)
    everywhere = np.concatenate([game_map.indoor, game_map.outdoor])
    for place in (np.array([1000.0, 0.0, 0.0]), in_wall):
        spec, moved = with_usable_places(episode(place, target=place), game_map)
        nearest = np.linalg.norm(everywhere - place, axis=1).min()
        for settled in (spec.start_of_seats[0], spec.target):
            assert np.linalg.norm(np.subtract(settled, place)) <= nearest + 3
        assert [line.partition(" (")[0] for line in moved] == ["start_location of agent 0", "target_location"]


def test_places_that_are_not_given_are_drawn() -> None:
    asked = episode(open_way(12))
    asked = asked._replace(spec=asked.spec.model_copy(update={"starts": (None,), "target": None}))
    assert with_usable_places(asked, load_map(MAP)) == (asked.spec, [])
