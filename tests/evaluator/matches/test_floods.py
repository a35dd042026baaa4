"""An agent that floods its own socket from its sandbox is put out for it, and costs the other no step."""

import inspect
import os
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Submit
from tests.evaluator.small_matches import need, play, seated
from tests.platform.helpers import raw_http2
from tests.platform.helpers.attacked_server import memory

from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.reports import SeatStatus
from wildscav_server.time_limits import Clock

pytestmark = pytest.mark.usefixtures("compiled")

STEPS = 100
GROWTH = 50e6  # bytes
# So that only a victim that is kept from playing is late, however busy the machine is.
PATIENT = Clock(step_budget=5.0, join_timeout=60.0)
# The usual clock, for a machine that does nothing else: WILDSCAV_FLOODS_CLOCK=usual.
CLOCK = Clock() if os.environ.get("WILDSCAV_FLOODS_CLOCK") == "usual" else PATIENT
# Floods from threads of its own and of another process, and plays on meanwhile.
FLOODER = """
import os, subprocess, sys, threading

from wildscav import Action, Agent

import raw_http2

def begin():
    address = os.environ["WILDSCAV_ADDRESS"]
    subprocess.Popen([sys.executable, raw_http2.__file__, "{kind}", address], stderr=subprocess.DEVNULL)
    for _ in range(raw_http2.THREADS):
        threading.Thread(target=raw_http2.flood_for_ever, args=("{kind}", address), daemon=True).start()

if {step} is None:
    begin()

class Player(Agent):
    def act(self, observation):
        if observation.step == {step}:
            begin()
        return Action(walk_direction=observation.step * 10.0, walk_speed=6.0)
"""
# Takes its seat by itself, and floods on the seat's own connection and on others.
SEATED = """
import os
import raw_http2
raw_http2.main("{kind}", os.environ["WILDSCAV_ADDRESS"], os.environ["WILDSCAV_TOKEN"])
"""
CODES = {
    "import": FLOODER.replace("{step}", "None"),
    "match": FLOODER.replace("{step}", "20"),
    "seat": SEATED,
}
WORST = ("connect", "ping", "large-continuation")  # of those that cost others steps, or memory, before
EVERY_DAY = ("bubblewrap", "match", "connect")


def cases() -> list[object]:
    """One of the worst floods at each time in each sandbox; the server's own tests have all kinds."""
    chosen = {EVERY_DAY}
    for row, sandbox in enumerate(SANDBOXES.built_in):
        chosen |= {(sandbox, when, WORST[(row + column) % 3]) for column, when in enumerate(CODES)}
    slow = pytest.mark.slow
    return [case if case == EVERY_DAY else pytest.param(*case, marks=slow) for case in sorted(chosen)]


def flooder(submit: Submit, when: str, kind: str) -> Submission:
    """Write a submission that floods."""
    submission = submit("flooder", code=CODES[when].replace("{kind}", kind))
    (submission.folder / "raw_http2.py").write_text(inspect.getsource(raw_http2))
    return submission


@pytest.mark.parametrize(("sandbox", "when", "kind"), cases())
def test_a_flood_from_a_sandbox_costs_the_other_seat_no_step(
    submit: Submit, tmp_path: Path, sandbox: str, when: str, kind: str
) -> None:
    need(sandbox)  # its trial takes memory, too
    seating = seated(
        flooder(submit, when, kind), submit("victim", WALKER), folder=tmp_path, seconds=STEPS / 10
    )
    before = memory()

    played = play(seating, sandbox, clock=CLOCK)

    attacker, victim = played.seats[0], played.seats[1]
    assert (victim.status, victim.late_steps, victim.steps_played) == ("finished", 0, STEPS)
    assert (attacker.status, attacker.status.fault) == (SeatStatus.PROTOCOL_ERROR, "agent")
    assert attacker.detail.startswith(("flooded its ", "sent ", "did not begin "))
    assert not played.platform_faults
    assert memory() - before < GROWTH
