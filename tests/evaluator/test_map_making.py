"""Maps that are made in advance are those that environments and evaluations play."""

import re
import shlex
from pathlib import Path

import pytest
from tests.end_to_end.pages import ROOT, blocks
from tests.evaluator.sample_agents import Command

from wildscav.errors import UserError
from wildscav_engine.maps import cache, generate_map
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.map_making import choices_of_pool, choices_of_suite, make_maps, missing_maps
from wildscav_evaluator.suites.suite import SUITES

PAGE = ROOT / "docs" / "maps.md"


@pytest.fixture(autouse=True)
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The folder of cached maps."""
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "maps")
    return tmp_path / "maps"


def no_generator(config: MapConfig, seed: int) -> None:
    raise AssertionError("the map should have been made in advance")


def test_a_pool_that_was_made_is_the_pool_of_environments(monkeypatch: pytest.MonkeyPatch) -> None:
    choices = choices_of_pool("easy", "train", 5, 3)
    made = list(make_maps(choices, LocalExecutor(1)))

    assert missing_maps(choices) == []
    monkeypatch.setattr(cache, "generate_map", no_generator)
    cache.map_of.cache_clear()
    pool = random_maps("easy", "train", 5, 3)
    assert [pool[number].spec for number in range(3)] == [one.spec for one in made]


def test_a_suite_needs_each_of_its_maps_once() -> None:
    choices = choices_of_suite(SUITES["official"], ["navigation", "battle"], 0)
    assert len(choices) == 20  # ten of each track
    assert {spec.config.size for (spec,) in choices} == {500}


def test_a_map_whose_first_seeds_do_not_fit_is_the_first_that_does() -> None:
    full = MapConfig(size=40, houses=200)
    fits = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
    (made,) = make_maps([(MapSpec(config=full, seed=1), fits)], LocalExecutor(1))

    assert made.spec == fits
    again = cache.load_cached(fits)
    assert again is not None
    assert again.digest == generate_map(fits.config, fits.seed).digest


def test_a_map_that_cannot_be_made_is_told() -> None:
    with pytest.raises(UserError, match="map with seed 1: houses is 200"):
        list(make_maps([(MapSpec(config=MapConfig(size=40, houses=200), seed=1),)], LocalExecutor(1)))


def test_maps_that_do_not_fit_into_the_cache_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(cache.LIMIT, "1")
    choices = choices_of_pool("easy", "train", 0, 9)
    with pytest.raises(UserError, match=f"more than 1 MB.*set {cache.LIMIT}"):
        list(make_maps(choices, LocalExecutor(1)))


@pytest.mark.slow
def test_the_commands_of_the_page_make_maps_and_only_those_that_are_missing(wildscav: Command) -> None:
    (lines,) = (block for block in blocks(PAGE, "console") if "map make" in block)
    for line in lines.splitlines():
        arguments = shlex.split(line, comments=True)[1:]
        made = wildscav(*arguments)
        assert made.returncode == 0, made.stderr
        again = wildscav(*arguments)
        assert re.search(r"(\d+) of \1 maps were cached before", again.stdout)
        assert "made 0 maps" in again.stdout


@pytest.mark.parametrize(
    ("arguments", "named"),
    [
        ((), "name either --level, for environments, or --suite, for evaluations"),
        (("--suite", "quick", "--count", "3"), "--count is for pools"),
        (("--suite", "quick", "--split", "test"), "--split is for pools"),
        (("--suite", "quick", "--unseen"), "--unseen is for pools"),
        (("--level", "easy", "--track", "battle"), "--track is for suites"),
    ],
)
def test_options_of_the_other_way_are_refused_and_not_ignored(
    wildscav: Command, arguments: tuple[str, ...], named: str
) -> None:
    refused = wildscav("map", "make", *arguments)
    assert (refused.returncode, refused.stderr.count("\n")) == (2, 1)
    assert named in refused.stderr
