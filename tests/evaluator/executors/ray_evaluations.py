"""Evaluations of one submission on a Ray cluster, and how they compare with those of this machine."""

import json
from collections import Counter
from pathlib import Path

from tests.evaluator.executors.ray_clusters import RayCluster
from tests.evaluator.interrupted_runs import check_whole, files, without_timings

from wildscav_evaluator.ledger.ledger import read_ledger
from wildscav_evaluator.output.layout import RESULTS_FILE

SUITE = """
name = "short"

[map]
size = 40
houses = 0

[tracks.navigation]
maps = 2
episodes = 2
match = { time_limit = 4 }

[tracks.battle]
maps = 1
episodes = 1
match = { time_limit = 4, seats = ["submission", "fighter", "submission"] }
"""
MATCHES = 5
PATIENCE = 900.0  # s, of a busy machine: nodes that were lost take their time to be replaced
# Slow enough to be killed in the middle of a match.
PLODDER = """
    def act(self, observation):
        print("step", observation.step)
        time.sleep(0.05)
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""


def options(cluster: RayCluster, suite: Path, sandbox: str = "process") -> list[str]:
    """Return the options of an evaluation on a cluster."""
    on_cluster = ["--executor=ray", f"--address={cluster.address}"]
    return [*on_cluster, f"--suite={suite}", f"--sandbox={sandbox}", "--replays=none"]


def check_equal(out: Path, expected: Path) -> None:
    """Everything but the timings is the same, byte for byte, and every match has exactly one result."""
    check_whole(out)
    assert files(out, "records") == files(expected, "records")
    there, here = without_timings(out), without_timings(expected)
    for name in ("sandbox", "limits"):  # of which nothing else depends
        del there[name], here[name]
    assert there == here
    ledger = read_ledger(out)
    assert ledger is not None
    assert Counter(len([end for end in ends if end.record]) for ends in ledger.ended.values()) == {1: MATCHES}


def faults(out: Path) -> list[str]:
    """What the platform broke, by the results."""
    matches = json.loads((out / RESULTS_FILE).read_text())["timings"]["matches"]
    return [fault for match in matches for fault in match["platform_faults"]]
