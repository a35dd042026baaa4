"""A policy that looks at the pixels of its screen alone and answers with keys, in a sandbox."""

from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.sample_agents import Command, Submit
from tests.evaluator.small_matches import need

from wildscav_evaluator.output.results import read_results
from wildscav_training.datasets.from_records import RecordedEpisodes

SUITE = """
name = "open"
map = { size = 60, houses = 0, vegetation = 0.0 }
[tracks.navigation]
maps = 2
match = { time_limit = 20, rules = "fair" }
"""
# Turns until the mark of the compass is ahead, and walks.
READER = """
from wildscav import Agent
from wildscav.policy.keys import Keys

GOLD = (0xFF, 0xCC, 0x33)


class Player(Agent):
    def reset(self, match):
        self.match = match

    def act(self, observation):
        compass = observation.sensor("screen")[9:18]
        _, columns = (compass == GOLD).all(axis=2).nonzero()
        away = (columns.mean() - 79.0) * 130.0 / 80.0  # degrees
        return Keys(forward=abs(away) < 30.0, mouse_x=50.0 * away).action(observation, self.match)
"""


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_it_reaches_its_targets_and_its_record_gives_its_screens_and_keys(
    wildscav: Command, submit: Submit, tmp_path: Path
) -> None:
    need("bubblewrap")
    sensors = {"screen": {"quality": "fast"}}
    folder = submit("reader", code=READER, more='\n[sensors.screen]\nquality = "fast"\n').folder
    (tmp_path / "open.toml").write_text(SUITE)
    arguments = ("--suite", tmp_path / "open.toml", "--sandbox=bubblewrap", "--replays=none")

    done = wildscav("evaluate", folder, *arguments, "--out", tmp_path / "out")

    assert done.returncode == 0, done.stderr
    (evaluation,) = read_results(tmp_path / "out" / "results.json").evaluations
    assert [row.status for row in evaluation.matches] == ["finished"] * 2
    records = sorted((tmp_path / "out" / "records").glob("*.wsr"))
    for (episode,) in RecordedEpisodes(records, {"sensors": sensors, "action_mode": "keys"}):
        assert episode.about["metrics"]["success"] == 1.0
        walked = []
        for screen in episode.observations["screen"][:-1, 9:18]:
            _, columns = (screen == (0xFF, 0xCC, 0x33)).all(axis=2).nonzero()
            walked.append(abs(columns.mean() - 79.0) * 130.0 / 80.0 < 30.0)
        np.testing.assert_array_equal(episode.actions["forward"], walked)
