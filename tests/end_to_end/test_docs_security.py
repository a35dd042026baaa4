"""The page on security names every attack, every limit and every sandbox, and none that is not there."""

import re
from pathlib import Path

from wildscav_evaluator.matches.play import SEAT_ENDPOINT
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Limits
from wildscav_evaluator.submissions import archives
from wildscav_server.http2 import accounting
from wildscav_server.http2.session import HEADER_LIMIT, STREAMS
from wildscav_server.http2.stream import UNREAD_LIMIT

REPOSITORY = Path(__file__).parents[2]
PAGE = (REPOSITORY / "docs" / "security.md").read_text("utf-8")
ATTACKER = (REPOSITORY / "tests" / "evaluator" / "sandbox" / "attacker" / "agent.py").read_text("utf-8")


def test_every_attack_stands_beside_its_promise() -> None:
    named = set(re.findall(r"`((?:network|files|kernel|processes|limits)_\w+)`", PAGE))

    assert named == set(re.findall(r'^    "(\w+)": ', ATTACKER.partition("ATTACKS: ")[2], re.MULTILINE))


def test_every_limit_is_told_with_its_default() -> None:
    rows = dict(
        re.findall(r"^\| `(\w+)` \| (none|[\d.]+(?: \w+)?) \|", PAGE.partition("## Limits")[2], re.MULTILINE)
    )

    told = {name: None if value == "none" else value.replace(" ", "") for name, value in rows.items()}
    assert Limits.model_validate(told) == DEFAULT_LIMITS
    assert set(told) == set(Limits.model_fields)


def test_every_sandbox_is_told() -> None:
    assert re.findall(
        r"^\| `(\w+)` \| [^|]+\| [^|]+\|$", PAGE.partition("## What is promised")[0], re.MULTILINE
    ) == [*SANDBOXES]


def test_the_limits_of_archives_are_told() -> None:
    words = (
        f"{archives.LARGEST >> 20} MiB",
        f"{archives.LARGEST_CONTENT >> 30} GiB",
        f"{archives.MAX_ENTRIES:,}",
    )
    assert all(word in PAGE for word in (*words, *(f"`{suffix}`" for suffix in archives.SUFFIXES)))


def test_what_a_connection_may_cost_is_told() -> None:
    for words in (
        f"{HEADER_LIMIT >> 10} KiB of headers a call",
        f"in an evaluation {SEAT_ENDPOINT.connections}, ",
        f"and {SEAT_ENDPOINT.max_total_connections} in a whole match",
        f"{STREAMS} streams each",
        f"{UNREAD_LIMIT} messages ahead",
    ):
        assert words in PAGE, words
    assert accounting.SHARE == 0.25
    assert "a quarter of a core for all of them" in PAGE
