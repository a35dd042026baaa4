"""What the bridge to seats of words and keys costs: a step and a call beyond those of an agent of numbers.

The match server and the agent share this process, and the bridge is its own.
"""

import asyncio
import contextlib
import io
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import typer
from benchmarks.report import Figure, JsonFile, publish, time_of_children

from wildscav import Action, Agent, MatchInfo, Observation
from wildscav.keyboard import KeysSeat
from wildscav.policy.keys import Keys
from wildscav.sdk.run import play
from wildscav.words import WordsSeat
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.bridge.process import bridged
from wildscav_evaluator.sandbox import Launch
from wildscav_language.senses import sensors
from wildscav_server.match_server import MatchServer

STEPS, LONG = 300, 50  # steps of a match, and of its long calls
MAP = MapSpec(config=MapConfig(size=100), seed=1)
SPEC = MatchSpec(track="navigation", map=MAP, seed=1, time_limit=STEPS / 10, clock="paused")
SCREEN = {"screen": {"quality": "fast"}}
Sensors = dict[str, dict[str, Any]]


class Standing(Agent):
    """Does nothing, and measures its steps."""

    def __init__(self) -> None:
        self.moments: list[float] = []

    def reset(self, match: MatchInfo) -> None:
        """Begin."""

    def act(self, observation: Observation) -> Action:  # noqa: ARG002
        """Note the moment."""
        self.moments.append(time.perf_counter())
        return Action()


def numbers(address: str, token: str) -> list[float]:
    """Return how long the steps of an agent of numbers take, s."""
    agent = Standing()
    play(agent, address, token)
    return [after - before for before, after in zip(agent.moments, agent.moments[1:], strict=False)]


def calls(steps: int) -> Callable[[str, str], list[float]]:
    """Return what measures calls of so many steps: how long they take for each step, s."""

    def measure(address: str, token: str) -> list[float]:
        with WordsSeat(address, token) as seat:
            seat.observe()
            return [
                _time_of(lambda: seat.call("wait_until", {"event": "box", "seconds": steps / 10})) / steps
                for _ in range(STEPS // steps - 1)
            ]

    return measure


def keys(address: str, token: str) -> list[float]:
    """Return how long the steps of an agent of keys take, s."""
    with KeysSeat(address, token) as seat:
        seat.look()
        return [_time_of(lambda: seat.press(Keys())) for _ in range(STEPS - 2)]


def nothing(address: str, token: str) -> list[float]:
    """Take a seat, and leave it."""
    with WordsSeat(address, token) as seat:
        return [_time_of(lambda: seat.ask("observe"))]


def _time_of(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


async def times_of(interface: str, asked: Sensors, work: Callable[[str, str], list[float]]) -> float:
    """Play a match, and return the least of what is measured, ms; other processes make the rest longer."""
    with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stdout(io.StringIO()):
        server = MatchServer()
        (address,) = await server.start([f"unix:{folder}/match.sock"])
        hosted = await server.host(SPEC, names=["one"], sensors={0: asked})
        launch = Launch(Path(), "", address, hosted.tokens[0], Path(), interface=interface)
        try:
            async with bridged({0: launch}, hosted) as behind:
                times = await asyncio.to_thread(work, behind[0].address, behind[0].token)
        finally:
            hosted.cancel()
            await server.stop()
    return min(times) * 1e3


def main(json_file: JsonFile = None) -> None:
    """Measure, and print the figures."""
    plans = {
        "numbers, a step, with the sensors of words": ("numbers", sensors(), numbers),
        "words, a step of a long call": ("words", sensors(), calls(LONG)),
        "words, a call of one step": ("words", sensors(), calls(1)),
        "numbers, a step, with a screen": ("numbers", SCREEN, numbers),
        "keys, a step": ("keys", SCREEN, keys),
    }
    before = time_of_children()
    asyncio.run(times_of("words", sensors(), nothing))
    start = time_of_children() - before
    figures = [Figure("start of the bridge, processor time", start, "s")]
    for name, plan in plans.items():
        before = time_of_children()
        figures.append(Figure(name, asyncio.run(times_of(*plan)), "ms"))
        if plan[0] != "numbers":
            own = (time_of_children() - before - start) / STEPS * 1e3
            figures.append(Figure("… processor time in the bridge", own, "ms a step"))
    publish("the bridge to seats of words and keys", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
