"""The tables of the environments' pages are those of the real spaces."""

import re

import numpy as np
import pytest
from gymnasium.spaces import Dict

from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.presets import PRESETS
from wildscav_engine.envs.spaces.observation import observation_space, readings_space
from wildscav_engine.tracks import TRACKS
from wildscav_engine.tracks.rewards import REWARD_TERMS
from wildscav_website.environments import Environment, environments, page
from wildscav_website.observed import observation_rows

CASES = [
    pytest.param(one, config, id=f"{one.name}-{config.agents}")
    for one in environments()
    for config in (one.single, one.several)
]


def bounds(space: Dict) -> tuple[np.ndarray, np.ndarray]:
    """The bounds of all numbers of an observation, in the order of a flat row."""
    boxes = space.spaces.values()
    return (
        np.concatenate([box.low.reshape(-1) for box in boxes]),  # type: ignore[attr-defined]
        np.concatenate([box.high.reshape(-1) for box in boxes]),  # type: ignore[attr-defined]
    )


def test_every_track_and_every_preset_has_a_page() -> None:
    assert {one.name for one in environments()} == {*TRACKS, *PRESETS}


@pytest.mark.parametrize(("one", "config"), CASES)
def test_the_rows_tell_every_number_of_the_observation_once(one: Environment, config: EnvConfig) -> None:
    rows = observation_rows(config)
    told = sorted(index for row in rows for index in row.indexes)
    flat = observation_space(config.model_copy(update={"flat": True}))
    assert told == list(range(flat.shape[0]))  # type: ignore[index]


@pytest.mark.parametrize(("one", "config"), CASES)
def test_the_rows_have_the_bounds_of_the_space(one: Environment, config: EnvConfig) -> None:
    low, high = bounds(readings_space(config))
    for row in observation_rows(config):
        indexes = list(row.indexes)
        assert (low[indexes] == np.float32(row.column.low)).all(), row
        assert (high[indexes] == np.float32(row.column.high)).all(), row


@pytest.mark.parametrize("one", environments(), ids=lambda one: one.name)
def test_the_page_shows_every_row_and_every_argument(one: Environment) -> None:
    text = page(one)
    for row in (*observation_rows(one.single), *observation_rows(one.several)):
        assert f"`{row.part}[{row.place}]`" in text
    for term, weight in one.single.reward_weights.items():
        assert f"| `{term}` | {weight:g} | {REWARD_TERMS[term].title} |" in text
    for term in REWARD_TERMS.keys() - one.single.reward_weights.keys():
        assert f"    | `{term}` | {REWARD_TERMS[term].title} |" in text
    arguments = dict(re.findall(r"^\| `(\w+)` \| .+ \| (.*) \|$", text.partition("## Arguments")[2], re.M))
    assert all(arguments.values()), "write what an option means beside it"
    assert set(arguments) == (set(EnvConfig.model_fields) - {"track"}) | {"preset"}
