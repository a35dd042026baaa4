"""Steps a second of the engine, with threads and processes; ``environments.py`` measures environments."""

import functools
import itertools
import multiprocessing
import time
from collections.abc import Callable
from typing import Any

import gymnasium
import numpy as np
import typer
from benchmarks.report import Figure, JsonFile, in_turns, many, publish, ratio

from wildscav_engine.envs.arena import Arena
from wildscav_engine.maps import generate_map
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.pools import random_maps
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.actions import FIELDS, Field
from wildscav_engine.specs.map_spec import MapConfig
from wildscav_engine.specs.match_spec import MatchSpec

REPEATS = 5
POOL = 64  # maps
EPISODE = 40.0  # s, 400 steps as in the paper
COUNTRY = generate_map(MapConfig(size=100, houses=4), 1)
LISTS: dict[str, Any] = {"visible_agents": {"limit": 8}, "nearby_supplies": {"limit": 8}, "teammates": {}}
ENV = "wildscav_engine:WildScav/Navigation-v1"


def spec(index: int, track: str, *seats: str) -> MatchSpec:
    """Return a match that does not end while it is measured."""
    return MatchSpec(track=track, map=COUNTRY.spec, seed=index, seats=seats, time_limit=80_000)


@functools.cache
def wilds() -> GameMap:
    """Return a large map."""
    return generate_map(MapConfig(size=1000, houses=40), 1)


def spec_on(game_map: GameMap, track: str, seats: int) -> MatchSpec:
    """Return a match of submissions on a map, which does not end while it is measured."""
    return MatchSpec(track=track, map=game_map.spec, seats=("submission",) * seats, time_limit=80_000)


def random_actions(matches: int, seats: int) -> np.ndarray:
    """Return eight different steps of random walks, (8, matches, seats, FIELDS)."""
    random = np.random.default_rng(0)
    rows = np.zeros((8, matches, seats, FIELDS), np.float32)
    rows[..., Field.WALK_DIRECTION] = random.uniform(0, 360, rows.shape[:-1])
    rows[..., Field.WALK_SPEED] = random.uniform(0, 10, rows.shape[:-1])
    rows[..., Field.TURN] = random.uniform(-5, 5, rows.shape[:-1])
    return rows


def steps_per_second(step: Callable[[int], None], agents: int, steps: int) -> float:
    """Return the median of agent-steps a second."""
    return agents * steps / float(np.median(in_turns([many(step, steps)], REPEATS)))


@functools.cache
def pool() -> tuple[GameMap, ...]:
    """Return the maps that matches restart on."""
    maps = random_maps("easy", size=POOL)
    return tuple(maps[number] for number in range(POOL))


class Play:
    """A batch of navigation matches of one agent, each restarted on the next map when it ends."""

    def __init__(self, matches: int, *, resets: bool) -> None:
        limit = EPISODE if resets else 80_000.0
        # Ends spread over time, as in training.
        self.specs = [
            MatchSpec(
                track="navigation", map=game_map.spec, seed=index, time_limit=limit * (index + 1) / matches
            )
            for index, game_map in zip(range(matches), itertools.cycle(pool()), strict=False)
        ]
        self.maps = [pool()[index % POOL] for index in range(matches)]
        self.limit, self.begun = limit, matches
        self.batch = Batch(self.specs, self.maps, pool=pool())
        self.actions = random_actions(matches, 1)

    def step(self, number: int) -> None:
        """Play one step of all matches, and restart those that end."""
        self.batch.step(self.actions[number % 8])
        for row in np.flatnonzero(self.batch.state.matches.over).tolist():
            self.maps[row] = pool()[self.begun % POOL]
            spec = self.specs[row].model_copy(
                update={"seed": self.begun, "map": self.maps[row].spec, "time_limit": self.limit}
            )
            self.batch.restart([row], [spec], [self.maps[row]])
            self.begun += 1


def batch_figure(*, resets: bool = True) -> Figure:
    """Measure a batch of 64 matches of one agent on 64 maps."""
    play = Play(64, resets=resets)
    rate = steps_per_second(play.step, 64, 400)
    what = f"64 matches × 1 agent, no sensors{'' if resets else ', no resets'}"
    return Figure(what, rate, "agent-steps/s")


def threads_figure(name: str, steps: int, one: Callable[[int], None], two: Callable[[int], None]) -> Figure:
    """Measure the speed of two threads relative to one."""
    alone, together = in_turns([many(one, steps), many(two, steps)], 4 * REPEATS).T
    return ratio(f"two threads over one, {name}", alone / together)


def batch_threads_figure(matches: int, seats: int) -> Figure:
    """Measure two threads on a batch of battles."""
    actions = random_actions(matches, seats)
    specs = [spec(index, "battle", *["submission"] * seats) for index in range(matches)]
    one, two = (Batch(specs, [COUNTRY] * matches) for _ in range(2))
    return threads_figure(
        f"{matches} battles × {seats}",
        max(4, 10_000 // (matches * seats)),
        lambda number: one.step(actions[number % 8]),
        lambda number: two.step(actions[number % 8], threads=2),
    )


def vector_threads_figure(envs: int, sensor: str, size: int, steps: int, level: str = "easy") -> Figure:
    """Measure two threads on a vector environment with square images."""
    sensors = {sensor: {"width": size, "height": size}}
    options = {**env_options(depth=False), "sensors": sensors, "level": level}
    one, two = (vector_env(envs, options | {"threads": threads}) for threads in (1, 2))
    actions = [one.action_space.sample() for _ in range(8)]
    return threads_figure(
        f"vector env, {envs} × 1, {sensor} {size} × {size}, {level}",
        steps,
        lambda number: one.step(actions[number % 8]),
        lambda number: two.step(actions[number % 8]),
    )


def processes_figure(depth: bool) -> Figure:
    """Measure two processes, each with its own vector environment, relative to one."""
    context = multiprocessing.get_context("spawn")
    rates = []
    for count in (1, 2):
        together, found = context.Barrier(count), context.Queue()
        arguments = (together, found, depth)
        processes = [context.Process(target=play_beside, args=arguments) for _ in range(count)]
        for process in processes:
            process.start()
        rates.append(sum(found.get() for _ in processes))
        for process in processes:
            process.join()
    what = f"two processes over one, vector env, 64 × 1, {seen(depth)}"
    return Figure(what, rates[1] / rates[0], "×", f"{rates[1]:,.0f} agent-steps/s")


def play_beside(together: Any, found: Any, depth: bool) -> None:
    """Play a vector environment while other processes play theirs, and report its agent-steps a second."""
    vector = vector_env(64, env_options(depth))
    actions = [vector.action_space.sample() for _ in range(8)]

    def step(number: int) -> None:
        if number == 0:
            together.wait()
        vector.step(actions[number % 8])

    found.put(steps_per_second(step, 64, 2000))


def vector_env(envs: int, options: dict[str, Any], track: str = "Navigation") -> Any:
    """Return a vector environment after its reset, with all the maps that it will play on."""
    env = ENV.replace("Navigation", track)
    vector = gymnasium.make_vec(env, num_envs=envs, vectorization_mode="vector_entry_point", **options)
    vector.action_space.seed(0)
    vector.reset(seed=0)
    make_pool(vector.unwrapped.arena)
    return vector


def reset_figure() -> Figure:
    """Measure how long it takes to restart a match on a map of the pool."""
    play = Play(1, resets=True)
    specs = [
        play.specs[0].model_copy(update={"seed": seed, "map": pool()[seed % POOL].spec})
        for seed in range(200)
    ]
    started = time.perf_counter()
    for seed, fresh in enumerate(specs):
        play.batch.restart([0], [fresh], [pool()[seed % POOL]])
    return Figure("restart of a navigation match", (time.perf_counter() - started) * 1e6 / 200, "µs")


def crowd_cost(seats: int) -> float:
    """Return the processor time of an agent-step in a battle with random actions on a large map, in µs."""
    match = Batch([spec_on(wilds(), "battle", seats)], [wilds()])
    actions = random_actions(1, seats)
    actions[..., Field.SHOOT :] = np.random.default_rng(1).random(actions[..., Field.SHOOT :].shape) < 0.3
    steps = max(4, 2000 // seats)
    play = many(lambda number: match.step(actions[number % 8]), steps)
    return 1e6 * in_turns([play], REPEATS, time.thread_time).min() / (steps * seats)


def crowd_figure(seats: int, against: float | None = None) -> Figure:
    """Measure a crowd: its cost, or the cost relative to another."""
    cost = crowd_cost(seats)
    if against is None:
        return Figure(f"one battle, {seats} agents, 1,000 × 1,000 m", cost, "µs/agent-step")
    return Figure(f"the same, {seats:,} agents over 10", cost / against, "times", f"{cost:.2f} µs/agent-step")


def memory_of(batch: Batch) -> int:
    """Return the memory of a batch without its maps, in bytes."""
    return sum(array.nbytes for part in (*batch.state, batch.seen) for array in part)


def memory_figure(seats: int) -> Figure:
    """Return the memory of a battle without its map, and its share of the limit."""
    batch = Batch([spec_on(wilds(), "battle", seats)], [wilds()])
    used = memory_of(batch)
    slots = batch.state.supplies.quantity.shape[1]
    share = used / (20_000 + 2_000 * seats + 32 * slots)
    return Figure(f"memory of it, {seats:,} agents", used / 1000, "kB", f"{share:.0%} of the limit")


def match_figure(name: str, *seats: str) -> Figure:
    """Measure one battle through the Match class, one Python call a step."""
    match = Match(spec(0, "battle", *seats), COUNTRY)
    actions = random_actions(1, len(seats))[:, 0]
    rate = steps_per_second(lambda number: match.step(actions[number % 8]), 1, 500)
    return Figure(name, rate, "steps/s", "battle, one Python call a step")


def robots_figures() -> list[Figure]:
    """Measure battles of ten robots of each kind that fights, in turns, by processor time."""
    teams = (0,) * 5 + (1,) * 5
    kinds: dict[str, tuple[int, ...] | None] = {"fighter": None, "fighter-hard": None}
    kinds |= {"hunter-squad": teams, "hunter-squad-hard": teams}
    specs = [
        spec(0, "battle", *[kind] * 10).model_copy(update={"teams": sides}) for kind, sides in kinds.items()
    ]
    plays, actions = [Match(each, COUNTRY) for each in specs], random_actions(1, 10)[0, 0]
    works = [many(lambda _, match=match: match.step(actions), 500) for match in plays]  # type: ignore[misc]
    medians = (500 / np.median(in_turns(works, REPEATS, time.process_time), axis=0)).tolist()
    return [
        Figure(
            f"one match, 10 × {kind}{'' if sides is None else ', two teams'}",
            rate,
            "steps/s of processor time",
            f"{medians[0] / rate:.2f} × the time of 10 × fighter",
        )
        for (kind, sides), rate in zip(kinds.items(), medians, strict=True)
    ]


def opponents_figures() -> list[Figure]:
    """Measure battles of one learner against nine robots, and what nine seats of one policy take more."""
    rates = []
    for opponent in ("fighter", stand):
        options = {
            "level": "easy",
            "flat": True,
            "action_mode": "box",
            "sensors": {"visible_agents": {"limit": 8}, "nearby_supplies": {"limit": 8}},
        }
        vector = vector_env(64, options | {"opponents": (opponent,) * 9}, "Battle")
        actions = np.zeros((64, 8), np.float32)
        rates.append(steps_per_second(lambda _, v=vector, a=actions: v.step(a), 640, 60))  # type: ignore[misc]
    what = "vector env of battles, 64 × (1 learner + 9"
    more = 1e6 * 640 / rates[1] - 1e6 * 640 / rates[0]
    note = f"{more:+,.0f} µs per step of all matches"
    return [
        Figure(f"{what} robots)", rates[0], "agent-steps/s", "agents and boxes in sight, flat"),
        Figure(f"{what} seats of one policy)", rates[1], "agent-steps/s", note),
    ]


def lists_figure(track: str, options: dict[str, Any]) -> Figure:
    """Measure what the lists of agents and boxes cost: with them relative to without."""
    made = {"level": "easy", "flat": True, "action_mode": "box"} | options
    none, lists = (vector_env(64, made | {"sensors": sensors}, track) for sensors in ({}, LISTS))
    actions = [none.action_space.sample() for _ in range(8)]
    works = [
        many(lambda number, env=env: env.step(actions[number % 8]), 50)  # type: ignore[misc]
        for env in (none, lists)
    ]
    without, having = in_turns(works, 2 * REPEATS, time.process_time).T
    what = f"vector env, {track.lower()}, 64 matches: lists of agents and boxes over none, processor time"
    return ratio(what, having / without)


def stand(observations: np.ndarray) -> np.ndarray:
    """Return actions that do nothing, so that the rest is measured."""
    return np.zeros((len(observations), 8), np.float32)


def make_pool(arena: Arena) -> None:
    """Generate all maps that matches restart on, as happens in long trainings."""
    for number in range(len(arena.pool)):
        _ = arena.pool[number]


def env_options(depth: bool) -> dict[str, Any]:
    """Return episodes of at most 400 steps on random maps of one kind."""
    sensors = {"depth": {"width": 10, "height": 10}} if depth else {}
    return {"level": "easy", "time_limit": 40.0, "action_mode": "box", "sensors": sensors}


def seen(depth: bool) -> str:
    """Return the name of what is observed."""
    return "10 × 10 depth" if depth else "no sensors"


def main(json_file: JsonFile = None) -> None:
    """Measure and print."""
    figures = [
        batch_figure(),
        batch_figure(resets=False),
        *(batch_threads_figure(matches, seats) for matches, seats in ((64, 10), (512, 1))),
        vector_threads_figure(64, "camera", 84, 2),
        vector_threads_figure(64, "depth", 84, 20),
        vector_threads_figure(64, "depth", 84, 8, "normal"),
        vector_threads_figure(256, "depth", 84, 2, "normal"),
        vector_threads_figure(512, "depth", 10, 20),
        processes_figure(depth=True),
        processes_figure(depth=False),
        reset_figure(),
        match_figure("one match, 1 agent", "submission"),
        match_figure("one match, 10 agents", *["submission"] * 10),
        *robots_figures(),
        *opponents_figures(),
        lists_figure("Battle", {}),
        lists_figure("Gathering", {"teammates": ("gatherer",) * 3}),
    ]
    ten = crowd_figure(10)
    figures += [
        ten,
        *(crowd_figure(seats, ten.value) for seats in (100, 1000)),
        memory_figure(100),
        memory_figure(1000),
    ]
    publish("Engine: steps per second", figures, json_file)


if __name__ == "__main__":
    typer.run(main)
