"""The last lines of an agent's output: few enough that results of thousands of failures can be read."""

import asyncio
import json
from pathlib import Path

import pytest

from wildscav_evaluator.sandbox.agents.capped_log import CappedLog


@pytest.mark.parametrize(
    ("printed", "kept"),
    [
        (["a traceback's line"] * 30, 20),
        (["x" * 200] * 30, 20),
        (["\U0001f600" * 200] * 20, 1),  # each takes 12 bytes of JSON
        (["\U0001f600" * 200] * 20 + ["ValueError"], 2),
    ],
)
def test_the_last_lines_that_results_keep_take_4_kb_at_most(
    tmp_path: Path, printed: list[str], kept: int
) -> None:
    async def copied() -> CappedLog:
        stream, log = asyncio.StreamReader(), CappedLog(tmp_path / "log", limit=1_000_000)
        stream.feed_data("\n".join(printed).encode())
        stream.feed_eof()
        await log.copy(stream)
        return log

    last = asyncio.run(copied()).last_lines()

    assert list(last) == printed[-kept:]
    assert sum(len(json.dumps(line)) for line in last) <= 4_096
