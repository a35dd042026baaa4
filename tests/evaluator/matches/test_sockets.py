"""Nobody plays at another's cost: not by its token, and not by its time."""

from pathlib import Path

import pytest
from tests.evaluator import small_matches
from tests.evaluator.sample_agents import Submit
from tests.evaluator.small_matches import need, seated

from wildscav_evaluator.matches.play import PlayedMatch
from wildscav_evaluator.sandbox import Limits
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server.hosting.hosted_match import HostedMatch

pytestmark = pytest.mark.usefixtures("compiled")
STEPS = 20
# Comes late, so that its seat is free for whoever has its token.
VICTIM = """
    def __init__(self):
        time.sleep(1.5)

    def act(self, observation):
        return Action(walk_speed=5.0)
"""
# Speaks the protocol itself, as a thief would.
THIEF = """
    def reset(self, match):
        import grpc
        from wildscav.proto.match_pb2 import ClientMessage, Join, ServerMessage
        from wildscav.wire.errors import reason_of
        channel = grpc.insecure_channel(os.environ["WILDSCAV_ADDRESS"]{elsewhere})
        call = channel.stream_stream(
            "/wildscav.match.v1.Match/Play",
            request_serializer=ClientMessage.SerializeToString,
            response_deserializer=ServerMessage.FromString,
        )
        join = ClientMessage(join=Join(token=open("stolen.txt").read(), protocol_version=1))
        try:
            next(call(iter([join])))
            print("is in")
        except grpc.RpcError as error:
            print(error.details(), reason_of(error))

    def act(self, observation):
        return Action(walk_speed=5.0)
"""
ELSEWHERE = '.replace("/0/match.sock", "/1/match.sock")'  # the victim's socket, where it can be reached


def play(thief: Submission, victim: Submission, sandbox: str, tmp_path: Path) -> tuple[PlayedMatch, str]:
    """Play a match in which the thief is given the victim's token; return it with what the thief says."""

    def steal(hosted: HostedMatch) -> None:
        (thief.folder / "stolen.txt").write_text(hosted.tokens[1])

    seating = seated(thief, victim, folder=tmp_path, seconds=STEPS / 10)
    return small_matches.play(seating, sandbox, on_start=steal), (tmp_path / "0.log").read_text()


@pytest.mark.parametrize("sandbox", ["process", "bubblewrap", pytest.param("oci", marks=pytest.mark.slow)])
def test_a_stolen_token_is_refused_at_the_thiefs_own_socket(
    submit: Submit, tmp_path: Path, sandbox: str
) -> None:
    thief, victim = submit("thief", THIEF.format(elsewhere="")), submit("victim", VICTIM)

    played, said = play(thief, victim, sandbox, tmp_path)

    assert "seat 1 is not joined over this address" in said
    assert "SEAT_ELSEWHERE" in said
    assert [(seat.status, seat.steps_played) for seat in played.seats.values()] == [("finished", STEPS)] * 2


@pytest.mark.slow
@pytest.mark.parametrize(("sandbox", "taken"), [("process", True), ("bubblewrap", False)])
def test_only_a_sandbox_keeps_a_thief_from_the_socket_that_the_token_is_for(
    submit: Submit, tmp_path: Path, sandbox: str, taken: bool
) -> None:
    thief, victim = submit("thief", THIEF.format(elsewhere=ELSEWHERE)), submit("victim", VICTIM)

    played, said = play(thief, victim, sandbox, tmp_path)

    assert ("is in" in said) == taken, said
    assert (played.seats[1].status == "crashed") == taken


FAIR_STEPS = 50
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


def share_while_waiting(sandbox: str, seats: tuple[Submission, ...], folder: Path) -> float:
    """Return how many cores the last seat's agent kept busy while it waited for the others."""
    folder.mkdir()
    seating = seated(*seats, folder=folder, seconds=FAIR_STEPS / 10, limits=LIMITS)
    played = small_matches.play(seating, sandbox)
    assert {report.status for report in played.seats.values()} == {"finished"}

    lines = [[float(word) for word in line.split()] for line in seating.logs[-1].read_text().splitlines()]
    (began, before), (ended, after) = lines[5], lines[-1]
    return (after - before) / (ended - began)


@pytest.mark.slow
def test_an_agent_that_works_while_it_waits_has_its_own_share_of_the_processor_and_no_more(
    submit: Submit, tmp_path: Path
) -> None:
    need("bubblewrap")
    seats = (submit("thinker", THINKER), submit("hog", HOG))

    assert share_while_waiting("process", seats, tmp_path / "process") > 1.6 * LIMITS.cpus  # the control
    assert share_while_waiting("bubblewrap", seats, tmp_path / "bubblewrap") < 1.2 * LIMITS.cpus
