"""How long the first match takes with nothing compiled, and with everything in the cache."""

import os
import subprocess
import sys
import tempfile
import time

import typer
from report import Figure, JsonFile, publish

FIRST_STEP = """
from wildscav_engine.match import Match
from wildscav_engine.spec import MatchSpec
match = Match(MatchSpec(track="battle", seats=("submission", "fighter"), time_limit=10))
match.step()
"""


def seconds(cache: str) -> float:
    """Return how long a new process takes to its first step."""
    started = time.perf_counter()
    environment = {**os.environ, "WILDSCAV_CACHE_DIR": cache}
    subprocess.run([sys.executable, "-c", FIRST_STEP], check=True, env=environment)
    return time.perf_counter() - started


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as cache:
        figures = [
            Figure("import, map and first step, nothing compiled", seconds(cache), "s"),
            Figure("import, map and first step, compiled", min(seconds(cache) for _ in range(3)), "s"),
        ]
    publish("Engine: compile time", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
