"""Types of houses: maps for training hold none of those that are kept for testing."""

import pytest

from wildscav_engine.maps.house import draw_house, draw_plan, is_unseen
from wildscav_engine.maps.levels import LEVELS
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.specs.map_spec import Country, MapConfig

STOREYS = (1, 3)


def test_seen_and_unseen_houses_are_of_different_types() -> None:
    for number in range(12):
        assert not is_unseen(draw_house("seen", 1, number, STOREYS))
        assert is_unseen(draw_house("unseen", 1, number, STOREYS))


def test_without_a_wish_houses_are_as_ever() -> None:
    assert all(draw_house("all", 1, number, STOREYS) == draw_plan(1, number, STOREYS) for number in range(6))
    assert {is_unseen(draw_plan(1, number, STOREYS)) for number in range(12)} == {True, False}


def test_a_pool_of_unseen_pieces_keeps_them_for_testing() -> None:
    def pieces(split: str, *, unseen: bool) -> str:
        return random_maps("expert", split, unseen=unseen).specs(0)[0].config.pieces

    assert (pieces("train", unseen=True), pieces("test", unseen=True)) == ("seen", "unseen")
    assert (pieces("train", unseen=False), pieces("test", unseen=False)) == ("all", "all")


@pytest.mark.parametrize("level", LEVELS)
def test_every_level_has_pieces_to_keep_for_testing(level: str) -> None:
    assert random_maps(level, "test", unseen=True).specs(0)[0].config.pieces == "unseen"


def test_maps_without_houses_have_unseen_pieces_only_in_towns() -> None:
    bare = MapConfig(houses=0, country=Country(towns=0))
    with pytest.raises(ValueError, match="no houses and no towns"):
        random_maps(bare, unseen=True)
    random_maps(bare.model_copy(update={"country": Country(towns=1)}), unseen=True)
