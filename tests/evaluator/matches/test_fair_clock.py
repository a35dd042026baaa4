"""Nobody thinks on another's time: an agent that waits keeps to its own share of the processor."""

import asyncio
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.available import missing

from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.sandbox import SANDBOXES, Limits
from wildscav_evaluator.submissions.submission import Submission

pytestmark = pytest.mark.usefixtures("compiled")

STEPS = 50
LIMITS = Limits(cpus=0.25)
# Takes half of every step's budget, in which the other one waits.
THINKER = """
    def act(self, observation):
        time.sleep(0.05)
        return Action(walk_speed=1.0)
"""
# Answers at once; all that it uses of the processor, it uses while it waits. Says how much that is by now.
HOG = """
    def reset(self, match):
        self.spinning = [
            subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(2 * os.cpu_count())
        ]

    def act(self, observation):
        used = 0
        for process in self.spinning:
            with open(f"/proc/{process.pid}/stat") as stat:
                used += sum(map(int, stat.read().rpartition(")")[2].split()[11:13]))
        print(time.monotonic(), used / os.sysconf("SC_CLK_TCK"))
        return Action(walk_speed=1.0)
"""


def share_while_waiting(sandbox: str, seats: tuple[Submission, ...], tmp_path: Path) -> float:
    """Return how many cores the last seat's agent kept busy while it waited for the others."""
    small = MapSpec(config=MapConfig(size=40, houses=0), seed=3)
    filled = ("submission",) * len(seats)
    spec = MatchSpec(track="gathering", map=small, seats=filled, time_limit=STEPS / 10)
    logs = tuple(tmp_path / f"{sandbox}-{seat}.log" for seat in range(len(seats)))
    played = asyncio.run(play_match(MatchAssignment(spec, seats, logs, LIMITS), sandbox=SANDBOXES[sandbox]))
    assert {report.status for report in played.seats.values()} == {"finished"}
    lines = [[float(word) for word in line.split()] for line in logs[-1].read_text().splitlines()]
    (began, before), (ended, after) = lines[5], lines[-1]
    return (after - before) / (ended - began)


@pytest.mark.slow
def test_an_agent_that_works_while_it_waits_has_its_own_share_of_the_processor_and_no_more(
    submit: Submit, tmp_path: Path
) -> None:
    if missing("bubblewrap"):
        pytest.skip(missing("bubblewrap"))
    seats = (submit("thinker", THINKER), submit("hog", HOG))

    assert share_while_waiting("process", seats, tmp_path) > 1.6 * LIMITS.cpus  # the control
    assert share_while_waiting("bubblewrap", seats, tmp_path) < 1.2 * LIMITS.cpus
