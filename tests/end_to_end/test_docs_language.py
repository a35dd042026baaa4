"""The page about seats of words: its code runs, and it tells every tool, argument and reason."""

import re
from pathlib import Path

from tests.end_to_end.pages import ROOT, blocks, run_code
from tests.platform.wildscav.skills.observations import match_info

from wildscav_language.calls import Reason
from wildscav_language.perception import LIMIT
from wildscav_language.phrases import NAME_LIMIT
from wildscav_language.player import REFUSAL_TIME, Player

PAGE = ROOT / "docs" / "language.md"


def test_its_match_is_played(tmp_path: Path) -> None:
    (code,) = blocks(PAGE, "python")

    said = run_code(code, tmp_path)

    assert "Target: " in said
    assert "'success': 1.0" in said


def test_it_tells_every_tool_with_its_arguments() -> None:
    rows = re.findall(r"^\| `(\w+)` \| (.*?) \|", PAGE.read_text("utf-8"), re.MULTILINE)
    told = {name: set(re.findall(r"`(\w+)`", arguments)) for name, arguments in rows}

    tools = Player(match_info(track="royale")).tools

    assert {tool.name: set(tool.order.model_fields) for tool in tools}.items() <= told.items()


def test_it_tells_every_reason_and_the_limits() -> None:
    text = PAGE.read_text("utf-8")

    assert all(f"`{reason.value}`" in text for reason in Reason)
    assert f"{LIMIT:,} bytes" in text
    assert f"{NAME_LIMIT} characters" in text
    assert f"They cost {REFUSAL_TIME:g} s" in text
