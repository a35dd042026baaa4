"""Entrants of known, different strength come out of a tournament in their order."""

import shutil
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Command

from wildscav.baselines import baseline_folder
from wildscav_evaluator.tournaments.tournament_file import Tournament

# Six of the same agent, each walking slower than the one before, m/s.
SPEEDS = (10.0, 6.0, 3.6, 2.2, 1.3, 0.8)
SUITE = """
name = "meadow"
map = { size = 60, houses = 0, relief = 0.2, ruggedness = 0.0, water = 0.0, vegetation = 0.0 }
[tracks.gathering]
maps = 4
[tracks.gathering.match]
time_limit = 12
supplies = { waves = [{ center = [0, 0], radius = 40, outdoor_richness = 30 }], spacing = 2 }
"""


@pytest.mark.slow
def test_six_agents_of_different_speed_come_out_in_the_order_of_their_speed(
    tmp_path: Path, wildscav: Command
) -> None:
    folders = [tmp_path / f"walks-{speed:04.1f}".replace(".", "-") for speed in SPEEDS]
    for folder, speed in zip(folders, SPEEDS, strict=True):
        shutil.copytree(baseline_folder("homing"), folder)
        for file, old, new in (
            ("agent.py", "FULL_SPEED = 10.0", f"FULL_SPEED = {speed}"),
            ("submission.toml", 'name = "homing"', f'name = "{folder.name}"'),
        ):
            text = (folder / file).read_text()
            assert old in text
            (folder / file).write_text(text.replace(old, new))
    (tmp_path / "meadow.toml").write_text(SUITE)
    options = ["--track=gathering", f"--suite={tmp_path / 'meadow.toml'}", "--seats=6", "--rounds=7"]
    out = tmp_path / "out"
    done = wildscav(
        "tournament",
        *(folders[place] for place in (3, 0, 1, 5, 2, 4)),
        *options,
        "--sandbox=process",
        "--replays=none",
        "--workers=1",
        f"--out={out}",
    )
    assert done.returncode == 0, done.stderr
    ratings = Tournament.read(out / "tournament.json").ratings
    assert [one.entrant for one in ratings.standings] == [folder.name for folder in folders]
    assert len(ratings.bands) > 2, "the fast ones are told apart from the slow ones"
