"""Steps a second of matches over gRPC, agents in processes of their own, beside a bare gRPC echo."""

import asyncio
import os
import statistics
import sys
import tempfile
from pathlib import Path

import echo
import typer
from report import Figure, JsonFile, publish

from wildscav.sdk.agent import Action
from wildscav.server import Clock, MatchServer
from wildscav.server.snapshot import take_snapshot
from wildscav.wire.actions import encode_action
from wildscav.wire.observations import encode_observation
from wildscav_engine.actions import Field, no_actions
from wildscav_engine.match import Match
from wildscav_engine.spec import MapConfig, MapSpec, MatchSpec

HERE = Path(__file__).parent
STEPS = {1: 2000, 10: 400}
REPEATS = 3
PATIENT = Clock(step_budget=5.0, game_time_factor=100.0)  # so that a busy machine drops no step


def match_spec(seats: int) -> MatchSpec:
    """A match as evaluations have it, of a given number of agents."""
    track = "gathering" if seats == 1 else "battle"
    game_map = MapSpec(config=MapConfig(size=100, houses=4), seed=1)
    filled = ("submission",) * seats
    return MatchSpec(track=track, map=game_map, seed=1, seats=filled, time_limit=STEPS[seats] / 10)


async def play_match(folder: str, seats: int) -> float:
    """Return steps a second of one match."""
    server = MatchServer()
    (address,) = await server.start([f"unix:{folder}/match.sock"])
    hosted = await server.host(match_spec(seats), names=["walker"] * seats, clock=PATIENT)
    environment = {**os.environ, "WILDSCAV_ADDRESS": address}
    agents = [
        await asyncio.create_subprocess_exec(
            *(sys.executable, "-m", "wildscav.sdk", "walker:Walker"),
            cwd=HERE,
            env={**environment, "WILDSCAV_TOKEN": token},
        )
        for token in hosted.tokens.values()
    ]
    outcome = await hosted.finished()
    await asyncio.gather(*(agent.wait() for agent in agents))
    await server.stop()
    late = sum(report.late_steps for report in outcome.seats.values())
    if late:
        raise RuntimeError(f"{late} steps were late: the figure would mean nothing")
    return outcome.match.step_number / outcome.seconds


async def play_echo(folder: str, clients: int) -> float:
    """Return rounds a second that each of some clients gets from a bare stream, all at once."""
    address = f"unix:{folder}/echo.sock"
    message_bytes, answer_bytes = message_sizes(clients)
    server = await echo.serve(address, message_bytes)
    processes = [
        await asyncio.create_subprocess_exec(
            *(sys.executable, str(HERE / "echo.py"), address, str(STEPS[clients]), str(answer_bytes)),
            stdout=asyncio.subprocess.PIPE,
        )
        for _ in range(clients)
    ]
    outputs = await asyncio.gather(*(process.communicate() for process in processes))
    await server.stop(None)
    return statistics.mean(float(output) for output, _ in outputs)


def message_sizes(seats: int) -> tuple[int, int]:
    """Return the bytes of an observation and of an action in such a match."""
    match = Match(match_spec(seats))
    for step in range(STEPS[seats] // 4):
        rows = no_actions(seats)
        rows[:, Field.WALK_DIRECTION], rows[:, Field.WALK_SPEED] = step * 3.0, 6.0
        match.step(rows)
    observation = encode_observation(
        take_snapshot(match), 0, seconds_per_frame=0.02, time_bank=30.0, tensors={}
    )
    return observation.ByteSize(), encode_action(1000, Action(walk_direction=10.0, walk_speed=6.0)).ByteSize()


def main(json: JsonFile = None) -> None:
    """Measure the match server."""
    figures = []
    with tempfile.TemporaryDirectory() as folder:
        for seats in STEPS:
            name = f"{seats} agent{'s' if seats > 1 else ''}"
            message_bytes, answer_bytes = message_sizes(seats)
            # Taken in turns, so that both see the same machine.
            pairs = [
                (asyncio.run(play_match(folder, seats)), asyncio.run(play_echo(folder, seats)))
                for _ in range(REPEATS)
            ]
            steps, rounds = (statistics.median(column) for column in zip(*pairs, strict=True))
            figures += [
                Figure(f"match of {name}", steps, "steps/s", f"observations of about {message_bytes} bytes"),
                Figure(f"bare echo, {name}", rounds, "rounds/s", f"{message_bytes} to, {answer_bytes} fro"),
                Figure(f"match over echo, {name}", steps / rounds, "", f"median of {REPEATS} runs each"),
            ]
    publish("Match server", figures, json)


if __name__ == "__main__":
    typer.run(main)
