"""The page about seats of words: its code runs, and it tells every tool, argument and reason."""

import asyncio
import re
from pathlib import Path
from typing import Any

import pytest
from tests.end_to_end.pages import ROOT, blocks, run_code
from tests.platform.wildscav.harness.played_seats import PlayedSeat
from tests.platform.wildscav.skills.observations import match_info
from tests.scripted_model import ScriptedModel, called, in_turn

from wildscav.bridge import LONGEST_REQUEST
from wildscav.harness.spending import Ending
from wildscav.sdk.run import INTERFACE_VARIABLE
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.bridge.seat import MOST_IDLE
from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.submissions.submission import load_submission
from wildscav_language.perception import LIMIT
from wildscav_language.phrases import NAME_LIMIT
from wildscav_language.player import REFUSAL_TIME, Player

PAGE = ROOT / "docs" / "language.md"


def test_its_match_is_played(tmp_path: Path) -> None:
    code = (ROOT / "docs" / "examples" / "words_seat.py").read_text("utf-8")

    said = run_code(code, tmp_path)

    assert "Target: " in said
    assert "'success': 1.0" in said


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("interface", ["words", "keys"])
def test_its_submissions_play(interface: str, tmp_path: Path) -> None:
    (manifest,), (words, keys, _) = blocks(PAGE, "toml"), blocks(PAGE, "python")
    (tmp_path / "agent.py").write_text(words if interface == "words" else keys)
    if interface == "keys":
        manifest = (
            manifest.replace("words", "keys", 1).replace("Explorer", "Walker").replace("true ", "false ")
        )
    (tmp_path / "submission.toml").write_text(manifest)
    small = MapSpec(config=MapConfig(size=40, houses=0, vegetation=0.0), seed=3)
    spec = MatchSpec(track="navigation", map=small, seed=1, time_limit=5.0)

    seating = MatchAssignment(spec, (load_submission(tmp_path),), (tmp_path / "log",))
    played = asyncio.run(play_match(seating))

    assert played.seats[0].status == "finished", played.seats[0]


def test_its_model_plays() -> None:
    *_, code = blocks(PAGE, "python")
    with ScriptedModel(in_turn(called("go"))) as model:
        names: dict[str, Any] = {"seat": PlayedSeat(), "rules": lambda _: PlayedSeat.rules}
        exec(code.replace("http://127.0.0.1:8000/v1", model.url), names)  # noqa: S102

    assert names["course"].ending == Ending.MATCH_OVER


def test_it_tells_every_request_and_the_bounds() -> None:
    text = PAGE.read_text("utf-8")

    told = re.findall(r"^\| `(\w+)` \| (?:both|words|keys) \|", text, re.MULTILINE)
    assert told == ["hello", "observe", "call", "picture", "look", "press"]
    assert f"{LONGEST_REQUEST:,} bytes" in text
    assert f"{MOST_IDLE} requests in a row" in text
    assert f"`{INTERFACE_VARIABLE}`" in text


def test_it_tells_which_tools_are_on_which_tracks() -> None:
    table = PAGE.read_text("utf-8").partition("| on tracks | tools |")[2].partition("\n\n")[0]
    rows = [set(re.findall(r"`(\w+)`", row)) for row in table.splitlines()[2:]]
    everywhere, with_others, with_supplies, with_weapons = rows

    def tools(track: str, seats: int) -> set[str]:
        return {tool.name for tool in Player(match_info(track=track, seats=seats)).tools}

    assert tools("navigation", 1) == everywhere
    assert tools("navigation", 2) == everywhere | with_others
    assert tools("gathering", 1) == everywhere | with_supplies
    assert tools("royale", 2) == everywhere | with_others | with_supplies | with_weapons


def test_it_tells_the_limits() -> None:
    text = PAGE.read_text("utf-8")

    assert f"{LIMIT:,} bytes" in text
    assert f"{NAME_LIMIT} characters" in text
    assert f"They cost {REFUSAL_TIME:g} s" in text
