"""The paper's table of throughput: frames a second of 1, 5 and 10 agents in 1, 2 and 4 processes.

The paper's figures (its appendix, "Computation cost and simulation speed") are of the Unity engine on one AMD
5800H. Here each process plays a battle of its own through ``Match``, one Python call a step, with random
actions; frames of all processes are added up.
"""

import subprocess
import sys
import time
from typing import Annotated, TextIO, cast

import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, publish

from wildscav_engine.maps import load_map
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.match_spec import MatchSpec

AGENTS, PROCESSES = (1, 5, 10), (1, 2, 4)
PAPER = {
    (1, 1): 499.61, (1, 2): 996.90, (1, 4): 1974.84,
    (5, 1): 500.18, (5, 2): 996.94, (5, 4): 1609.81,
    (10, 1): 500.54, (10, 2): 997.62, (10, 4): 1095.73,
}  # fmt: skip
MAP = 104  # of the paper's benchmark: 100 m
SECONDS = 4.0  # of measuring, in each process
FRAMES_PER_ACTION = 5


def frames_per_second(agents: int, processes: int) -> float:
    """Return the total frames a second of several processes, measured while all of them play."""
    command = (sys.executable, "-m", "benchmarks.speed.processes", "--worker", str(agents))
    workers = [
        subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        for _ in range(processes)
    ]
    for worker in workers:
        cast(TextIO, worker.stdout).readline()  # it is ready
    for worker in workers:
        cast(TextIO, worker.stdin).write("go\n")
        cast(TextIO, worker.stdin).flush()
    return sum(float(worker.communicate()[0]) for worker in workers)


def work(agents: int) -> None:
    """Play after a line on stdin, and print the frames a second."""
    game_map = load_map(MAP)
    spec = MatchSpec(track="battle", map=game_map.spec, seats=("submission",) * agents, time_limit=80_000)
    match = Match(spec, game_map)
    random = np.random.default_rng(0)
    actions = np.zeros((64, agents, FIELDS), np.float32)
    actions[..., Field.WALK_DIRECTION] = random.uniform(0, 360, actions.shape[:-1])
    actions[..., Field.WALK_SPEED] = random.uniform(0, 10, actions.shape[:-1])
    actions[..., Field.TURN] = random.uniform(-5, 5, actions.shape[:-1])
    actions[..., Field.SHOOT] = random.integers(0, 2, actions.shape[:-1])
    match.step(actions[0])
    print("ready", flush=True)
    sys.stdin.readline()
    steps, started = 0, time.perf_counter()
    while time.perf_counter() - started < SECONDS:
        match.step(actions[steps % 64])
        steps += 1
    print(steps * FRAMES_PER_ACTION / (time.perf_counter() - started))


def main(
    json_file: JsonFile = None, worker: Annotated[int, typer.Option(hidden=True, help="Agents.")] = 0
) -> None:
    """Measure and print."""
    if worker:
        work(worker)
        return
    figures = []
    for agents in AGENTS:
        for processes in PROCESSES:
            rate, paper = frames_per_second(agents, processes), PAPER[agents, processes]
            plural = "" if processes == 1 else "es"
            what = f"{agents} agent{'' if agents == 1 else 's'}, {processes} process{plural}"
            figures.append(Figure(what, rate, "frames/s", f"paper: {paper:,.0f}; {rate / paper:,.0f} ×"))
    publish("The paper's table: frames a second, all processes together", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
