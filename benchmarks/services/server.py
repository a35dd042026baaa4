"""Steps a second of matches over gRPC, with agents in processes of their own.

For comparison, a bare stream of the same messages runs with gRPC's default settings and with ours.
"""

import wildscav  # noqa: F401 - before gRPC, which it configures

# isort: split

import asyncio
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import grpc
import typer
from benchmarks.report import Figure, JsonFile, publish, time_of_children
from benchmarks.services import echo

from wildscav.grpc_settings import EXPERIMENTS, VARIABLE
from wildscav.proto.match_pb2 import GetMatchRequest, HostMatchRequest, ServerMessage
from wildscav.proto.match_pb2_grpc import ArenaStub
from wildscav.wire.matches import decode_seat_address
from wildscav.wire.observations import encode_observation
from wildscav_engine.parallel.threads import cores
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import Field, no_actions
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_server.hosting.hosted_match import HostedMatch
from wildscav_server.hosting.observations import SeatObservations
from wildscav_server.hosting.precompile import precompile
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock
from wildscav_server.workers.shared_server import SharedServer

HERE = Path(__file__).parent
STEPS = {1: 1500, 10: 300}
REPEATS = 3
AT_ONCE = 16  # matches
PATIENT = Clock(step_budget=5.0)  # so that a busy machine drops no step


def match_spec(seats: int) -> MatchSpec:
    """Return the spec of a match as in evaluations, for a given number of agents."""
    track = "gathering" if seats == 1 else "battle"
    game_map = MapSpec(config=MapConfig(size=100, houses=4), seed=1)
    filled = ("submission",) * seats
    return MatchSpec(track=track, map=game_map, seed=1, seats=filled, time_limit=STEPS[seats] / 10)


async def play_matches(folder: Path, seats: int, count: int = 1) -> list[tuple[HostedMatch, float]]:
    """Play some matches at once on one server; return them with their steps a second."""
    server = MatchServer()
    (address,) = await server.start([f"unix:{folder}/match.sock"])
    matches = [
        await server.host(match_spec(seats), names=["walker"] * seats, clock=PATIENT) for _ in range(count)
    ]
    agents = [await start_agent(address, token) for hosted in matches for token in hosted.tokens.values()]
    outcomes = [await hosted.finished() for hosted in matches]
    await asyncio.gather(*(agent.wait() for agent in agents))
    await server.stop()
    late = sum(report.late_steps for outcome in outcomes for report in outcome.seats.values())
    if late:
        raise RuntimeError(f"{late} steps were late: the figure would mean nothing")
    return [
        (hosted, outcome.match.step_number / outcome.seconds)
        for hosted, outcome in zip(matches, outcomes, strict=True)
    ]


async def start_agent(address: str, token: str) -> asyncio.subprocess.Process:
    """Start the process of an agent that walks in a circle."""
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", "wildscav.sdk", "walker:Walker"),
        cwd=HERE,
        env={**os.environ, "WILDSCAV_ADDRESS": address, "WILDSCAV_TOKEN": token},
    )


async def steps_a_second(folder: Path, seats: int) -> float:
    """Return the steps a second of one match."""
    ((_, rate),) = await play_matches(folder, seats)
    return rate


async def rounds_a_second(folder: Path, clients: int, experiments: str) -> float:
    """Return the mean rounds a second of clients of a bare stream, with some experiments of gRPC."""
    environment = {**os.environ, VARIABLE: experiments}
    address, messages = f"unix:{folder}/echo.sock", folder / "messages"
    echo.write_messages(messages, sample_messages(clients))
    server = await _script(environment, "serve", address, str(messages))
    if server.stdout is not None:
        await server.stdout.readline()
    processes = [await _script(environment, "play", address, str(STEPS[clients])) for _ in range(clients)]
    outputs = await asyncio.gather(*(process.communicate() for process in processes))
    server.kill()
    await server.communicate()
    return statistics.mean(float(output) for output, _ in outputs)


async def _script(environment: dict[str, str], *arguments: str) -> asyncio.subprocess.Process:
    command = (sys.executable, str(HERE / "echo.py"), *arguments)
    return await asyncio.create_subprocess_exec(*command, env=environment, stdout=asyncio.subprocess.PIPE)


def sample_messages(seats: int, count: int = 100) -> list[ServerMessage]:
    """Return the messages that the first seat of such a match receives."""
    match = Match(match_spec(seats))
    observations = SeatObservations(match, [0])
    messages = []
    for step in range(count):
        rows = no_actions(seats)
        rows[:, Field.WALK_DIRECTION], rows[:, Field.WALK_SPEED] = step * 3.0, 6.0
        match.step(rows)
        observations.encode([30.0])
        messages.append(ServerMessage.FromString(encode_observation(observations.of(0), {})))
    return messages


def compare(folder: Path, seats: int) -> list[Figure]:
    """Measure a match and the bare streams in turns, so that all see the same machine."""
    turns = [
        (
            asyncio.run(steps_a_second(folder, seats)),
            asyncio.run(rounds_a_second(folder, seats, "")),
            asyncio.run(rounds_a_second(folder, seats, EXPERIMENTS)),
        )
        for _ in range(REPEATS)
    ]
    steps, bare, tuned = (statistics.median(column) for column in zip(*turns, strict=True))
    over_bare = statistics.median(turn[0] / turn[1] for turn in turns)
    over_tuned = statistics.median(turn[0] / turn[2] for turn in turns)
    size = statistics.mean(message.ByteSize() for message in sample_messages(seats))
    name = f"{seats} agent{'s' if seats > 1 else ''}"
    return [
        Figure(f"match of {name}", steps, "steps/s", f"observations of about {size:.0f} bytes"),
        Figure(f"bare stream, {name}", bare, "rounds/s", "the same messages, gRPC as it comes"),
        Figure(f"bare stream, {name}, tuned", tuned, "rounds/s", "both ends set as ours"),
        Figure(f"match over bare stream, {name}", over_bare, "", f"median of {REPEATS} turns; aim: 0.8"),
        Figure(f"match over tuned stream, {name}", over_tuned, "", f"median of {REPEATS} turns"),
    ]


async def play_shared(folder: Path, count: int) -> float:
    """Play some matches at once on a server with a worker a core; return the steps a second of all."""
    server = SharedServer(cores())
    (address,) = await server.start([f"unix:{folder}/shared.sock"])
    spec = match_spec(1).model_dump_json()
    async with grpc.aio.insecure_channel(address) as channel:
        arena = ArenaStub(channel)
        matches = [await arena.HostMatch(HostMatchRequest(spec_json=spec)) for _ in range(count)]
        started = time.perf_counter()
        agents = [await start_agent(decode_seat_address(one, address), one.seat_tokens[0]) for one in matches]
        await asyncio.gather(*(agent.wait() for agent in agents))
        seconds = time.perf_counter() - started
        answers = [await arena.GetMatch(GetMatchRequest(match_id=one.match_id)) for one in matches]
    await server.stop()
    if late := sum(answer.conduct[0].late_steps for answer in answers):
        raise RuntimeError(f"{late} steps were late: the figure would mean nothing")
    return sum(answer.steps for answer in answers) / seconds


def crowd(folder: Path) -> list[Figure]:
    """Measure many simultaneous matches on one server."""
    before, started = time.process_time() + time_of_children(), time.perf_counter()
    total = asyncio.run(play_shared(folder, AT_ONCE))
    wall, used = time.perf_counter() - started, time.process_time() + time_of_children() - before
    return [
        Figure(
            f"{AT_ONCE} matches at once", total, "steps/s", "all together, one agent each; start-up included"
        ),
        Figure("cores used by them", used / wall, "cores", f"of {cores()}, start-up included"),
    ]


def main(json: JsonFile = None) -> None:
    """Measure the match server."""
    precompile()
    figures = []
    with tempfile.TemporaryDirectory() as name:
        for seats in STEPS:
            figures += compare(Path(name), seats)
        figures += crowd(Path(name))
    publish("Match server", figures, json)


if __name__ == "__main__":
    typer.run(main)
