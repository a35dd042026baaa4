"""Time to the first depth map of one agent, with empty caches and with compiled code and the map cached."""

import json
import os
import subprocess
import sys
import tempfile
import time

import typer
from benchmarks.report import Figure, JsonFile, publish

# Prints the wall-clock seconds and the processor seconds of each phase.
FIRST_STEP = """
import json, time
phases, last = [], (time.perf_counter(), time.process_time())

def done(name):
    global last
    now = (time.perf_counter(), time.process_time())
    phases.append((name, now[0] - last[0], now[1] - last[1]))
    last = now

from wildscav_engine.maps import map_of
from wildscav_engine.simulation.match import Match
from wildscav_engine.sensors import DepthCamera
from wildscav_engine.specs.match_spec import MatchSpec
done("import")
spec = MatchSpec(track="navigation", time_limit=10)
game_map = map_of(spec.map)
done("map")
match = Match(spec, game_map)
match.step()
done("match and first step")
DepthCamera(10, 10).read(match, [0])
done("first depth map")
print(json.dumps(phases))
"""

Phase = tuple[str, float, float]


def run(cache: str) -> list[Phase]:
    """Return the phases of a new process up to its first depth map, beginning with the start of Python."""
    started = time.perf_counter()
    environment = {**os.environ, "WILDSCAV_CACHE_DIR": cache}
    done = subprocess.run(
        [sys.executable, "-c", FIRST_STEP], check=True, env=environment, stdout=subprocess.PIPE
    )
    took = time.perf_counter() - started
    phases = [(name, seconds, worked) for name, seconds, worked in json.loads(done.stdout)]
    remaining = took - total(phases)
    return [("start and end of Python", remaining, remaining), *phases]


def total(phases: list[Phase]) -> float:
    """Return the seconds of all phases."""
    return sum(seconds for _, seconds, _ in phases)


def figures_of(state: str, phases: list[Phase]) -> list[Figure]:
    """Return a figure for the whole and one for each phase."""
    whole = Figure(
        f"up to the first depth map, {state}", total(phases), "s", _worked(sum(p[2] for p in phases))
    )
    return [whole, *(Figure(f"  {name}", seconds, "s", _worked(work)) for name, seconds, work in phases)]


def _worked(seconds: float) -> str:
    return f"{seconds:.1f} s of one core"


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    with tempfile.TemporaryDirectory() as cache:
        cold = run(cache)
        warm = min((run(cache) for _ in range(3)), key=total)
    figures = [*figures_of("nothing compiled", cold), *figures_of("compiled, map cached", warm)]
    publish("Engine: compile time", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
