"""Whom a video follows: one agent, or whoever has most to do."""

import numpy as np
from numpy.typing import NDArray

from wildscav_engine.geometry.rays import sight_is_clear
from wildscav_engine.geometry.world import World
from wildscav_engine.simulation.state import NOBODY
from wildscav_engine.specs.body import EYE_HEIGHT
from wildscav_engine.specs.rules import FRAMES_PER_SECOND
from wildscav_engine.view.recording.history import History, seats_where

# How much a viewer wants to see of each kind of event.
SHOT, HIT, DEATH, PICK_UP = 1.0, 3.0, 8.0, 1.5
WALKING = 0.05  # a second
BEFORE, AFTER = 3.0, 1.0  # s, for which an event is worth to be seen before and after it
SHORTEST = 5.0  # s between two cuts
BETTER = 1.6  # times as much must be going on elsewhere before there is a cut
NEAR, SEEN, ACTS = 35.0, 4.0, 6.0  # m; how much a poster gains by each agent in sight, and by acting at most
TRIED = 100  # steps, that might make a good poster
DEAD_FOR = 1.5  # s, after which there is one from an agent that is dead


def interest(history: History) -> NDArray[np.float64]:
    """Return (T + 1, A) how much each seat does in each step."""
    agents = history.agents
    worth = SHOT * agents.fired + PICK_UP * (agents.gained > 0)
    worth = worth + DEATH * np.diff(agents.deaths, axis=0, prepend=agents.deaths[:1])
    for row, seat in seats_where(agents.fired & (agents.hit_seat != NOBODY)):
        worth[row, seat] += HIT
        worth[row, int(agents.hit_seat[row, seat])] += HIT / 2
    for row, seat in seats_where(np.diff(agents.deaths, axis=0) > 0):
        by = int(agents.hit_by_seat[row + 1, seat])
        if by != NOBODY:
            worth[row + 1, by] += DEATH
    walked = np.diff(agents.walked, axis=0, prepend=agents.walked[:1])
    return np.asarray(worth + WALKING * (walked > 0.0), np.float64)


def whom_to_follow(history: History) -> NDArray[np.int64]:
    """Return (T + 1,) the seat to follow in each step, with few cuts."""
    per_second = max(
        1, round(FRAMES_PER_SECOND * (len(history.frame) - 1) / max(1.0, float(history.frame[-1])))
    )
    before, after = round(BEFORE * per_second), round(AFTER * per_second)
    padded = np.pad(interest(history), ((after, before), (0, 0)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, before + after + 1, axis=0)
    worth = windows.sum(axis=-1)
    alive = history.agents.health > 0
    worth = np.where(alive, worth, 0.0)
    followed = np.empty(len(worth), np.int64)
    seat, since, dead = int(np.argmax(worth[0])), 0, 0
    for row, now in enumerate(worth):
        best = int(np.argmax(now))
        dead = 0 if alive[row, seat] else dead + 1
        is_time = row - since >= SHORTEST * per_second and now[best] > BETTER * now[seat]
        if is_time or (dead > DEAD_FOR * per_second and alive[row].any()):
            seat, since, dead = best, row, 0
        followed[row] = seat
    return followed


def best_row(world: World, history: History, followed: NDArray[np.int64]) -> int:
    """Return the step that shows most: the followed agent acts, and sees others before it."""
    rows = np.arange(len(followed))
    acts = np.minimum(interest(history)[rows, followed], ACTS)
    near = _are_near(history, followed)
    score = acts + SEEN * near.sum(axis=1)
    seen = {row: _seen(world, history, row, int(followed[row]), near[row]) for row in _best(score, TRIED)}
    return max(seen, key=lambda row: acts[row] + SEEN * seen[row])


def _are_near(history: History, followed: NDArray[np.int64]) -> NDArray[np.bool_]:
    """Return (T + 1, A) who is near the followed agent and before it, while both are alive."""
    agents, rows = history.agents, np.arange(len(followed))
    ways = agents.position - agents.position[rows, followed][:, None]
    far, yaw = np.linalg.norm(ways, axis=-1), np.radians(agents.yaw[rows, followed])[:, None]
    ahead = ways[..., 0] * np.sin(yaw) + ways[..., 2] * np.cos(yaw)
    alive = agents.health > 0
    return np.asarray(
        (far > 1.0) & (far < NEAR) & (ahead > 0.8 * far) & alive & alive[rows, followed][:, None]
    )


def _best(score: NDArray[np.float64], count: int) -> list[int]:
    rows: list[int] = np.argsort(-score, kind="stable")[:count].tolist()
    return rows


def _seen(world: World, history: History, row: int, seat: int, near: NDArray[np.bool_]) -> int:
    """Return how many of those near a seat it sees."""
    eyes = history.agents.position[row] + np.array([0.0, EYE_HEIGHT, 0.0])
    return sum(
        bool(sight_is_clear(world, *eyes[seat].tolist(), *eyes[other].tolist()))
        for other in np.nonzero(near)[0].tolist()
    )
