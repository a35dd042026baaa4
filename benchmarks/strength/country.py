"""What rules of thumb reach in the suite ``wild``: success, and the length of the ways.

    python -m benchmarks.strength.country --episodes 500

plays matches of navigation and capture in this process: ``straight`` walks straight to the target, ``oracle``
follows the shortest path over the map's own graph, and others are baselines. Seeker robots play in the other
seats. Its table is in docs/maps.md.
"""

import statistics
import sys
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np
import typer
from benchmarks.strength.baselines import episodes_of, play, player, rate
from numpy.typing import NDArray
from rich.progress import track

from wildscav_engine.envs import SeatController
from wildscav_engine.maps.cache import map_of
from wildscav_engine.maps.game_map import GameMap
from wildscav_engine.maps.walk import find_path
from wildscav_engine.simulation.batch import Batch
from wildscav_engine.specs.actions import FIELDS, MAX_WALK_SPEED
from wildscav_engine.specs.match_spec import MatchSpec

if TYPE_CHECKING:
    from wildscav_engine.envs.settings.players import Indices


class Way(NamedTuple):
    """The way of one episode."""

    path: float  # m, the shortest path
    straight: float  # m, the straight line


class Straight(SeatController):
    """Walks straight to the target."""

    name = "straight"

    def begin(self, batch: Batch, matches: "Indices", seats: "Indices") -> None:
        """Do nothing: it has no memory."""

    def act(self, batch: Batch, matches: "Indices", seats: "Indices") -> NDArray[np.float32]:
        """Return (N, FIELDS) rows of actions."""
        rows = np.zeros((len(seats), FIELDS), np.float32)
        offsets = batch.state.matches.target[matches] - batch.state.agents.position[matches, seats]
        rows[:, 0] = np.degrees(np.arctan2(offsets[:, 0], offsets[:, 2])) % 360.0
        rows[:, 1] = MAX_WALK_SPEED
        return rows


def way_of(spec: MatchSpec, game_map: GameMap) -> Way:
    """Return the shortest way from the first seat's start to the target."""
    batch = Batch([spec], [game_map])
    start, target = batch.state.agents.position[0, 0], batch.state.matches.target[0]
    path, offset = find_path(game_map.graph, start, target), target - start
    straight = float(np.sqrt(offset[0] ** 2 + offset[2] ** 2))
    return Way(path.length if path else np.inf, straight)


def main(
    episodes: Annotated[int, typer.Option(help="Matches of each track.")] = 50,
    track_name: Annotated[str | None, typer.Option("--track", help="One track; default: both.")] = None,
    agents: Annotated[str, typer.Option(help="The agents, separated by commas.")] = "straight,homing,oracle",
) -> None:
    """Print the table."""
    players = {name: Straight() if name == "straight" else player(name) for name in agents.split(",")}
    heads = " | ".join(f"`{name}`" for name in players)
    print_line(f"| track | matches | way / straight line | way | {heads} |")
    print_line("|---|---|---|---|" + "---|" * len(players))
    for name in (track_name,) if track_name else ("navigation", "capture"):
        found: dict[str, list[bool]] = {player: [] for player in players}
        ways: list[Way] = []
        for spec in track(episodes_of(name, "wild", episodes), name):
            game_map = map_of(spec.map)
            ways.append(way_of(spec, game_map))
            for other, agent in players.items():
                # The oracle stops at each corner, so its steps are single frames.
                own = spec.model_copy(update={"frames_per_action": 1}) if other == "oracle" else spec
                found[other].append(play(agent, own, game_map).success)
            if not found.get("oracle", [True])[-1]:
                sys.stderr.write(f"oracle failed: map {spec.map.seed}, match {spec.seed}\n")
        ratio = statistics.median(way.path / way.straight for way in ways)
        length = statistics.median(way.path for way in ways)
        rates = " | ".join(rate(successes) for successes in found.values())
        print_line(f"| {name} | {len(ways)} | {ratio:.2f} × | {length:.0f} m | {rates} |")


def print_line(text: str) -> None:
    """Print a line of the table."""
    sys.stdout.write(text + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    typer.run(main)
