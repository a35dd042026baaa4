"""What environments take beyond the matches that they play: their rate relative to a match or a batch alone.

All of them take turns in short slices, so that they see the same load of the machine, and the processor time
of the best fifth of the slices counts.
"""

import itertools
import time
from collections.abc import Callable
from typing import Any, NamedTuple

import gymnasium
import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, in_turns, publish
from benchmarks.speed.steps import (
    COUNTRY,
    ENV,
    Play,
    env_options,
    make_pool,
    random_actions,
    spec,
    vector_env,
)

from wildscav_engine.simulation.match import Match

SLICES = 60
Step = Callable[[int], Any]  # plays the step with a number


class Subject(NamedTuple):
    """Something that plays."""

    name: str
    step: Step
    steps: int  # in a slice
    alone: int | None  # the number of the subject that plays the same without an environment
    aim: float = 0.0  # of the rate relative to that


def match_alone(track: str, *seats: str) -> Step:
    """Return what plays a step of one match through ``Match``."""
    match, actions = Match(spec(0, track, *seats), COUNTRY), random_actions(1, len(seats))[:, 0]
    return lambda number: match.step(actions[number % 8])


def one_env(track: str, options: dict[str, Any]) -> Step:
    """Return what plays a step of one environment, as ``gymnasium.make`` returns it."""
    env: Any = gymnasium.make(ENV.replace("Navigation", track), **options)
    env.action_space.seed(0)
    actions = [env.action_space.sample() for _ in range(256)]
    env.reset(seed=0)
    make_pool(env.unwrapped.arena)

    def step(number: int) -> None:
        _, _, terminated, truncated, _ = env.step(actions[number % 256])
        if terminated or truncated:
            env.reset()

    return step


def vector(track: str, options: dict[str, Any]) -> Step:
    """Return what plays a step of a vector environment of 64 matches."""
    env = vector_env(64, options, track)
    actions = [env.action_space.sample() for _ in range(8)]
    return lambda number: env.step(actions[number % 8])


def subjects() -> list[Subject]:
    """Return what is measured."""
    plain, seeing = env_options(depth=False), env_options(depth=True)
    battle = {**plain, "time_limit": 120.0, "random_maps": 4}
    return [
        Subject("match of one agent", match_alone("navigation", "submission"), 400, None),
        Subject("environment, no sensors", one_env("Navigation", plain), 200, 0, 0.6),
        Subject("environment, 10 × 10 depth", one_env("Navigation", seeing), 200, 0, 0.28),
        Subject("match of ten fighters", match_alone("battle", *["fighter"] * 10), 100, None),
        Subject("environment, battle of ten, no sensors", one_env("Battle", battle), 100, 3, 0.6),
        Subject("batch of 64 × 1", Play(64, resets=True).step, 20, None),
        Subject("vector environment 64 × 1, no sensors", vector("Navigation", plain), 20, 5, 0.7),
        Subject("vector environment 64 × 1, 10 × 10 depth", vector("Navigation", seeing), 10, 5),
        Subject("vector environment 64 × 10, battles with nine robots", vector("Battle", battle), 4, None),
    ]


def slices_of(subject: Subject) -> Callable[[], None]:
    """Return what plays a slice of steps, which are numbered on from slice to slice."""
    numbers = itertools.count()

    def work() -> None:
        for number in itertools.islice(numbers, subject.steps):
            subject.step(number)

    return work


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    every = subjects()
    taken = in_turns(list(map(slices_of, every)), SLICES, time.thread_time)
    best = np.quantile(taken, 0.2, axis=0) / [subject.steps for subject in every]
    figures = []
    for subject, seconds in zip(every, best, strict=True):
        note = ""
        if subject.alone is not None:
            note = f"{best[subject.alone] / seconds:.2f} × {every[subject.alone].name}"
            note += f" (aim: {subject.aim:g})" if subject.aim else ""
        figures.append(Figure(subject.name, seconds * 1e6, "µs a step", note))
    publish("Environments beside matches alone: processor time", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
