"""Plays one match twice: in an environment, and through a server and the SDK with the same choices."""

import asyncio
from collections.abc import Callable, Mapping
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from tests.platform.helpers.seats import host, serving

from wildscav import MatchInfo, Observation
from wildscav.agent import Action
from wildscav.policy import Environment
from wildscav.sdk.connection import Connection
from wildscav_engine.envs import SingleEnv
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_server.match_server import MatchServer
from wildscav_server.time_limits import Clock

PATIENT = Clock(step_budget=10.0, time_bank=600.0)  # the machine may be busy


class Played(NamedTuple):
    """An episode of an environment."""

    spec: MatchSpec  # the match that it was
    observations: list[Any]  # before each choice
    choices: list[Any]


def play_env(env: SingleEnv, seed: int, choose: Callable[[Any], Any] | None = None) -> Played:
    """Play an episode of an environment to its end, by default with random choices."""
    observation, _ = env.reset(seed=seed)
    env.action_space.seed(seed)
    assert env.arena.batch is not None
    played = Played(env.arena.batch.specs[0], [], [])
    over = False
    while not over:
        choice = env.action_space.sample() if choose is None else choose(observation)
        played.observations.append(observation)
        played.choices.append(choice)
        observation, _, terminated, truncated, _ = env.step(choice)
        over = terminated or truncated
    return played


def play_match(
    tmp_path: Path,
    spec: MatchSpec,
    sensors: Mapping[str, Mapping[str, Any]],
    begin: Callable[[MatchInfo], None],
    act: Callable[[Observation], Action],
) -> None:
    """Play seat 0 of a match, over a real server, with an agent's two methods."""

    async def test(server: MatchServer, address: str) -> None:
        match = await host(server, spec, sensors={0: sensors}, clock=PATIENT)
        async with Connection(address, match.seats[0].token, "test") as connection:
            begin(connection.match)
            seen = await connection.first()
            while seen is not None:
                seen = await connection.answer(seen.step, act(seen))
        await asyncio.wait_for(match.task, 60)

    serving(tmp_path, test)


def observed(
    tmp_path: Path, description: Mapping[str, Any], played: Played, spec: MatchSpec | None = None
) -> list[Any]:
    """Return the observations that the SDK makes in a match, with the choices made in the environment."""
    environment, told = Environment(description), []
    sensors = {part["name"]: part["sensor"] for part in description["observations"] if "sensor" in part}
    choices = iter(played.choices)
    until, action = 0, Action()

    def act(seen: Observation) -> Action:
        nonlocal until, action
        if seen.frame < until:
            environment.skip(seen)
        elif len(told) < len(played.choices):
            told.append(environment.observe(seen))
            action = environment.action(next(choices), seen)
            until = seen.frame + environment.frames_per_action
        return action  # whoever is out of a royale is asked on, where the environment's episode has ended

    play_match(tmp_path, spec or played.spec, sensors, environment.begin, act)
    return told


def assert_same(ours: Any, theirs: Any) -> None:
    """Two observations are the same to the last bit, types included."""
    if isinstance(theirs, Mapping):
        assert ours.keys() == theirs.keys()
        for name, values in theirs.items():
            assert_equal(ours[name], values, name)
    else:
        assert_equal(ours, theirs, "row")


def assert_equal(ours: Any, theirs: Any, name: str) -> None:
    assert ours.dtype == theirs.dtype, name
    assert np.array_equal(ours, theirs), (name, ours, theirs)
    assert ours.tobytes() == theirs.tobytes(), name  # -0.0 is not 0.0


def write_layers(path: Path, *widths: int, value: float | None = None, **more: Any) -> Path:
    """Write layers of these widths, from inputs to outputs, with a value in all weights or random ones."""
    dice, arrays = np.random.default_rng(0), dict(more)
    for layer, (before, after) in enumerate(pairwise(widths)):
        weight = dice.normal(size=(after, before)) if value is None else np.full((after, before), value)
        arrays |= {f"weight_{layer}": weight, f"bias_{layer}": dice.normal(size=after)}
    np.savez(path, **arrays)
    return path
