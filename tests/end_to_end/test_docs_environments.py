"""What the page of environments says is true."""

import re
from pathlib import Path

import pytest
from tests.end_to_end.pages import run_code

from wildscav_engine.envs.registry import VERSION, env_id, zoo_id
from wildscav_engine.envs.settings.config import EnvConfig
from wildscav_engine.envs.settings.presets import PRESETS
from wildscav_engine.envs.spaces.columns import groups_of
from wildscav_engine.tracks import TRACKS

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "docs" / "environments.md").read_text("utf-8")


@pytest.mark.slow
def test_the_code_of_the_page_works(tmp_path: Path) -> None:
    code = "\n".join(re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL))
    assert run_code(code, tmp_path).splitlines() == [
        "['body', 'depth', 'position', 'target', 'time', 'to_target', 'velocity', 'view'] (10, 10)",
        "(8, 1) (8,)",
        "(8, 10, 10) (8,)",
        "['agent_0', 'agent_1', 'agent_2', 'agent_3'] (1, 13)",
        "(4, 48) ('submission', 'submission', 'submission', 'submission', 'fighter')",
        "True bytes",
    ]


def test_the_page_tells_every_option() -> None:
    options = TEXT.partition("## Options")[2].partition("\n## ")[0]
    assert set(EnvConfig.model_fields) - {"track"} <= set(re.findall(r"`(\w+)", options))
    for preset in PRESETS:
        assert f"`{preset}`" in TEXT


def test_the_page_tells_every_track() -> None:
    for track in TRACKS:
        ids = rf"`{env_id(track)}` \| `{zoo_id(track)}`"
        row = rf"^\| `{track}` \| {ids} \| {TRACKS[track].learners} \| {TRACKS[track].opponents} "
        assert re.search(row, TEXT, re.MULTILINE), track


def test_the_page_tells_every_part_of_an_observation() -> None:
    observations = TEXT.partition("## Observations")[2].partition("\n## ")[0]
    for group in groups_of(VERSION).values():
        assert f"`{group.name}`" in observations
