"""The page on agents in other languages shows the agent in JavaScript as it is, and the protocol as it is."""

import re
import tomllib
from pathlib import Path

import pytest
from tests.end_to_end.pages import blocks

from wildscav_server.hosting.manifest import Manifest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "other-languages.md"
AGENT = ROOT / "submissions" / "homing-js"
CODE = "\n".join(path.read_text("utf-8") for path in sorted(AGENT.glob("*.js")))
PROTO = (AGENT / "match.proto").read_text("utf-8")


@pytest.mark.parametrize("block", blocks(PAGE, "javascript"), ids=lambda block: block.strip().splitlines()[0])
def test_the_code_shown_is_the_agents(block: str) -> None:
    assert block in CODE


def test_the_manifest_shown_is_the_agents() -> None:
    (shown,) = blocks(PAGE, "toml")
    manifest = Manifest.model_validate(tomllib.loads(shown))
    own = Manifest.model_validate(tomllib.loads((AGENT / "submission.toml").read_text("utf-8")))

    assert manifest.model_copy(update={"sensors": own.sensors}) == own
    assert manifest.sensors["lidar"].items() <= own.sensors["lidar"].items()


def test_every_file_of_the_agent_that_is_named_is_there() -> None:
    named = set(re.findall(r"`([\w.-]+\.(?:js|proto|toml))`", PAGE.read_text("utf-8")))
    assert {"agent.js", "seat.js", "steering.js", "tensors.js"} <= named
    for name in named:
        assert (AGENT / name).is_file(), name


def test_every_field_and_message_that_is_named_is_in_the_protocol() -> None:
    text = PAGE.read_text("utf-8")
    named = re.findall(r"`(MatchInfo|Observation|MatchOver|Ready|Tensor|Action)(?:\.(\w+))?`", text)
    assert len(named) > 8
    for message, field in named:
        body = re.search(rf"^message {message} {{(.*?)}}", PROTO, re.DOTALL | re.MULTILINE)
        assert body, message
        assert not field or re.search(rf" {field} = \d+;", body[1]), f"{message}.{field}"
    for field in ("target", "hit_seat", "hit_by_seat"):
        assert re.search(rf"optional \w+ {field} = ", PROTO), field
