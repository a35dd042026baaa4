"""The page on submitting tells clock, outcomes and checks as they are, and shows the agent in JavaScript."""

import re
import tomllib
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks
from tests.platform.helpers.hostile_client import REASONS

from wildscav_engine.specs.actions import Field
from wildscav_engine.specs.thinking import HELD, USED
from wildscav_evaluator.submission_files import LEFT_OUT
from wildscav_server.hosting.manifest import Manifest
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

REPOSITORY = Path(__file__).parents[2]
FILE = REPOSITORY / "docs" / "submitting.md"
PAGE = FILE.read_text("utf-8")
AGENT = REPOSITORY / "submissions" / "homing-js"
CODE = "\n".join(path.read_text("utf-8") for path in sorted(AGENT.glob("*.js")))
PROTO = (REPOSITORY / "platform" / "wildscav" / "proto" / "match.proto").read_text("utf-8")


def section(title: str) -> str:
    return PAGE.partition(f"## {title}\n")[2].partition("\n## ")[0]


def rows(title: str) -> list[list[str]]:
    """The cells of the table of a section, without its head."""
    lines = [line for line in section(title).splitlines() if line.startswith("|")]
    return [[cell.strip(" `") for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_the_manifest_shown_is_one() -> None:
    content, command = blocks(FILE, "toml")
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
    holding = section("The clock").partition("While a seat thinks")[2].partition(" hold, so")[0]
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


@pytest.mark.parametrize("block", blocks(FILE, "javascript"), ids=lambda block: block.strip().splitlines()[0])
def test_the_code_shown_is_the_agents(block: str) -> None:
    assert block in CODE


def test_the_manifest_shown_is_the_agents() -> None:
    shown = blocks(FILE, "toml")[1]
    manifest = Manifest.model_validate(tomllib.loads(shown))
    own = Manifest.model_validate(tomllib.loads((AGENT / "submission.toml").read_text("utf-8")))

    assert manifest.model_copy(update={"sensors": own.sensors}) == own
    assert manifest.sensors["lidar"].items() <= own.sensors["lidar"].items()


def test_every_file_of_the_agent_that_is_named_is_there() -> None:
    named = set(re.findall(r"`([\w.-]+\.(?:js|proto|toml))`", section("Agents in other languages")))
    assert {"agent.js", "seat.js", "steering.js", "tensors.js"} <= named
    for name in named:
        assert (AGENT / name).is_file(), name


def test_every_field_and_message_that_is_named_is_in_the_protocol() -> None:
    named = re.findall(r"`(MatchInfo|Observation|MatchOver|Ready|Tensor|Action)(?:\.(\w+))?`", PAGE)
    assert len(named) > 8
    for message, field in named:
        body = re.search(rf"^message {message} {{(.*?)}}", PROTO, re.DOTALL | re.MULTILINE)
        assert body, message
        assert not field or re.search(rf" {field} = \d+;", body[1]), f"{message}.{field}"
    for field in ("target", "hit_seat", "hit_by_seat"):
        assert re.search(rf"optional \w+ {field} = ", PROTO), field
