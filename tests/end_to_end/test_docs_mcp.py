"""What the page of MCP says is true: its client plays as it stands, and it tells every tool and limit."""

import json
import re
import sys
from pathlib import Path

import pytest

pytest.importorskip("mcp")

from tests.end_to_end.pages import ROOT, blocks, run_code

from wildscav_engine.record import read_record
from wildscav_language.mcp_server import hosting, matches, protocol, requests
from wildscav_language.mcp_server.desk import ACTS
from wildscav_language.mcp_server.matches import Bounds

PAGE = Path(__file__).parents[2] / "docs" / "mcp.md"
TEXT = PAGE.read_text("utf-8")


def test_the_page_tells_every_request() -> None:
    table = TEXT.partition("| for | tools |")[2].partition("\n\n")[0]
    assert set(re.findall(r"`(\w+)`", table)) == set(ACTS)


def test_the_page_tells_the_limits() -> None:
    limits = dict(re.findall(r"^\| ([a-zA-Z ]+) \| (.+) \|$", TEXT.partition("## Limits")[2], re.MULTILINE))
    assert limits["matches at one time"] == f"{Bounds().matches} (`--matches`)"
    assert limits["clients in a match"] == str(requests.MAX_CLIENTS)
    assert limits["others in a match"] == f"{requests.MAX_OTHERS}, of them {requests.MAX_BASELINES} baselines"
    assert limits["an answer"] == f"{protocol.LONGEST_ANSWER:,} bytes of text"
    assert limits["a picture"] == f"{protocol.LARGEST_PICTURE >> 20} MiB"
    assert limits["a request over HTTP"] == f"{protocol.LARGEST_REQUEST >> 10} KiB"
    assert limits["notes of a seat for replays"] == f"{matches.MOST_NOTES:,} bytes"
    assert f"({Bounds().idle_limit / 60:g} minutes;" in TEXT
    assert f"can end within {matches.CLOSING_TIME:g} s" in TEXT
    assert hosting.IDLE_LIMITS == 6, "as the page says"


def test_the_assistants_config_starts_the_command() -> None:
    (config,) = blocks(PAGE, "json")
    assert json.loads(config) == {"mcpServers": {"wildscav": {"command": "wildscav", "args": ["mcp"]}}}


@pytest.mark.slow
def test_the_client_of_the_page_reaches_the_target(tmp_path: Path) -> None:
    code = (ROOT / "docs" / "examples" / "mcp_client.py").read_text("utf-8")
    wildscav = str(Path(sys.executable).parent / "wildscav")

    said = run_code(code.replace('command="wildscav"', f"command={wildscav!r}"), tmp_path)

    assert "Target: " in said
    assert "success 1" in said
    (record,) = tmp_path.glob("matches/*/match.wsr")
    assert read_record(record).result.seats[0].metrics["success"] == 1.0
