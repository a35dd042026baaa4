"""The page on submitting tells the clock, the outcomes, the refusals and the checks as the code has them."""

import re
import tomllib
from pathlib import Path

import pytest
from tests.platform.helpers.hostile_client import REASONS

from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.thinking import HELD, USED
from wildscav_evaluator.submission_files import LEFT_OUT
from wildscav_server.hosting.manifest import Manifest
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "docs" / "submitting.md").read_text("utf-8")
PROTO = (REPOSITORY / "platform" / "wildscav" / "proto" / "match.proto").read_text("utf-8")


def section(title: str) -> str:
    return PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0]


def rows(title: str) -> list[list[str]]:
    """The cells of the table of a section, without its head."""
    lines = [line for line in section(title).splitlines() if line.startswith("|")]
    return [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_the_manifest_shown_is_one() -> None:
    content, command = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    manifest = tomllib.loads(content)
    assert Manifest.model_validate(manifest).name == "my-agent"
    del manifest["entry_point"]
    assert Manifest.model_validate(manifest | tomllib.loads(command)).command == ("node", "agent.js")


def test_every_outcome_is_told_with_its_fault() -> None:
    told = {row[0]: row[2] for row in rows("Outcomes")}
    assert told == {status.value: status.fault or "–" for status in SeatStatus}


def test_every_clock_is_told_with_what_holds() -> None:
    told = [row[0] for row in rows("The clock") if len(row) == 4]
    assert told == list(USED)
    holding = section("The clock").partition("What holds while a seat thinks")[2].partition(" hold, so")[0]
    assert re.findall(r"`(\w+)`", holding) == [field.name.lower() for field in Field if HELD[field]]


def test_the_time_limits_are_told_with_their_defaults() -> None:
    clock = Clock()
    limits = [row for row in rows("The clock") if len(row) == 3 and set(row[0]) != {"-"}][1:]
    assert len(limits) == 6
    for name, default, _ in limits:
        value = None if default == "none" else float(default.split()[0])
        assert value == getattr(clock, name), name


def test_every_reason_to_refuse_is_explained_where_the_page_leads() -> None:
    assert "platform/wildscav/proto/match.proto" in section("What is refused")
    assert set(re.findall(r"^//   ([A-Z_]+)  ", PROTO, re.MULTILINE)) >= REASONS


@pytest.mark.parametrize("name", ["findings.py", "trials.py"])
def test_every_check_is_told(name: str) -> None:
    code = (REPOSITORY / "evaluator" / "wildscav_evaluator" / "check" / name).read_text("utf-8")
    told = {row[0] for row in rows("What `wildscav check` checks")}
    for check in re.findall(r'(?:Finding\(\s*|check = |check, mend = )f?"([a-z][^":{]*)"', code):
        assert check in told, check
    assert told == {
        *("packages", "start-up", "match", "actions", "timing", "output", "end"),
        *("late answers", "cancelled match"),
    }


def test_what_is_left_out_of_a_submission_is_told() -> None:
    assert set(re.findall(r"`([_.]\w+)`", section("The files of a submission"))) == LEFT_OUT
