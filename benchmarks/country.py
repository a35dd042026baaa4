"""What rules of thumb reach in the suite ``wild``: success, and the length of the ways.

    python benchmarks/country.py --episodes 500

plays matches of navigation and capture with three agents in this process: ``straight`` walks straight to the
target, ``homing`` is the baseline, and ``oracle`` follows the shortest path over the map's own graph. Seeker
robots play in the other seats. Its table is in docs/maps.md.
"""

import statistics
import sys
from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np
import typer
from numpy.typing import NDArray
from rich.progress import track

from wildscav.opponents import SubmissionOpponent, submission
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.walk import Path, find_path
from wildscav_engine.maps.walk.leaps import LEAP_SPEED
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.rules import FRAME
from wildscav_evaluator.suites.suite import suite

SPEED = 10.0  # m/s
ARRIVED = 0.01  # m; a leg of a path ends here


class Way(NamedTuple):
    """The way of one episode."""

    path: float  # m, the shortest path
    straight: float  # m, the straight line


class Oracle:
    """Follows the shortest path over the map's own graph, with one frame a step."""

    def __init__(self, path: Path) -> None:
        self.legs, self.leg, self.jumps = path.legs, 0, bool(path.legs and path.legs[0].jump)

    def act(self, position: NDArray[np.float64], on_ground: bool, seconds: float) -> NDArray[np.float32]:
        """Return the action at a position (3,) m for a step of some seconds."""
        row = np.zeros(FIELDS, np.float32)
        while self.leg < len(self.legs):
            leg = self.legs[self.leg]
            east, north = leg.end[0] - position[0], leg.end[2] - position[2]
            left = float(np.sqrt(east * east + north * north))
            if left >= ARRIVED or not on_ground:
                break
            self.leg += 1
            self.jumps = self.leg < len(self.legs) and self.legs[self.leg].jump
        else:
            return row
        speed = LEAP_SPEED if leg.leap else SPEED
        row[0], row[1] = np.degrees(np.arctan2(east, north)) % 360.0, min(speed, left / seconds)
        row[4] = self.jumps
        self.jumps = False
        return row


def episodes_of(track_name: str, episodes: int) -> list[MatchSpec]:
    """Return matches of the suite on a track, evenly from rounds with the seeds 0, 1, 2 and so on."""
    specs: list[MatchSpec] = []
    seed = 0
    while len(specs) < episodes:
        specs += suite(track_name, "wild", seed)
        seed += 1
    return specs[:: len(specs) // episodes][:episodes]


def play_straight(spec: MatchSpec, game_map: GameMap) -> bool:
    """Walk straight to the target in the first seat; return whether its team reached it."""
    batch = Batch([spec], [game_map])
    row = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    target = batch.state.matches.target[0]
    while not batch.state.matches.over[0]:
        east, north = (target - batch.state.agents.position[0, 0])[[0, 2]]
        row[0, 0, :2] = np.degrees(np.arctan2(east, north)) % 360.0, SPEED
        batch.step(row)
    return bool(batch.state.agents.reached[0].any())


def play_homing(homing: SubmissionOpponent, spec: MatchSpec, game_map: GameMap) -> bool:
    """Let the baseline play in the first seat; return whether its team reached the target."""
    batch = Batch([spec], [game_map])
    match, seat = np.zeros(1, np.int64), np.zeros(1, np.int64)
    homing.begin(batch, match, seat)
    row = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    while not batch.state.matches.over[0]:
        row[0, 0] = homing.act(batch, match, seat)[0]
        batch.step(row)
    return bool(batch.state.agents.reached[0].any())


def play_oracle(spec: MatchSpec, game_map: GameMap) -> tuple[bool, Way]:
    """Follow the shortest path in the first seat; return whether the target was reached, and the way."""
    batch = Batch([spec.model_copy(update={"frames_per_action": 1})], [game_map])
    start, target = batch.state.agents.position[0, 0].copy(), batch.state.matches.target[0].copy()
    path = find_path(game_map.graph, start, target)
    offset = target - start
    straight = float(np.sqrt(offset[0] ** 2 + offset[2] ** 2))
    if path is None:
        return False, Way(np.inf, straight)
    oracle = Oracle(path)
    row = np.zeros((1, len(spec.seats), FIELDS), np.float32)
    while not batch.state.matches.over[0]:
        agents = batch.state.agents
        row[0, 0] = oracle.act(agents.position[0, 0], bool(agents.on_ground[0, 0]), FRAME)
        batch.step(row)
    return bool(batch.state.agents.reached[0].any()), Way(path.length, straight)


def rate(successes: Sequence[bool]) -> str:
    """Return a success rate with its 95 % interval (Wilson 1927)."""
    count, share = len(successes), statistics.fmean(successes)
    z = 1.96
    middle = (share + z * z / (2 * count)) / (1 + z * z / count)
    reach = z / (1 + z * z / count) * (share * (1 - share) / count + z * z / (4 * count * count)) ** 0.5
    low, high = 100.0 * max(0.0, middle - reach), 100.0 * min(1.0, middle + reach)
    return f"{100.0 * share:.1f} % ({low:.1f}–{high:.1f})"


def main(
    episodes: Annotated[int, typer.Option(help="Matches of each track.")] = 50,
    track_name: Annotated[str | None, typer.Option("--track", help="One track; default: both.")] = None,
) -> None:
    """Print the table."""
    homing = submission("homing")
    print_line("| track | matches | way / straight line | way | `straight` | `homing` | `oracle` |")
    print_line("|---|---|---|---|---|---|---|")
    for name in (track_name,) if track_name else ("navigation", "capture"):
        straight, baseline, oracle, ways = [], [], [], []
        for spec in track(episodes_of(name, episodes), name):
            game_map = map_of(spec.map)
            found, way = play_oracle(spec, game_map)
            if not found:
                sys.stderr.write(f"oracle failed: map {spec.map.seed}, match {spec.seed}\n")
            oracle.append(found)
            ways.append(way)
            straight.append(play_straight(spec, game_map))
            baseline.append(play_homing(homing, spec, game_map))
        ratio = statistics.median(way.path / way.straight for way in ways)
        length = statistics.median(way.path for way in ways)
        rates = " | ".join(map(rate, (straight, baseline, oracle)))
        print_line(f"| {name} | {len(ways)} | {ratio:.2f} × | {length:.0f} m | {rates} |")


def print_line(text: str) -> None:
    """Print a line of the table."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    typer.run(main)
