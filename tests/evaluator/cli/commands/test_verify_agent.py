"""`wildscav verify --agent`: only an agent that acts as recorded is borne out by its record."""

import json
import shutil
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
from tests.end_to_end.pages import json_documents, names
from tests.evaluator.conftest import submission_in
from tests.evaluator.results_by_hand import identity_of
from tests.evaluator.sample_agents import Command, Submit
from tests.evaluator.small_matches import SMALL, play, seated

from wildscav.errors import UserError
from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.thinking import CHARGE, SeatThinking, Thinking
from wildscav_evaluator.cli.sessions.run_again import run_again
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.results import KeptLimits, TournamentSettings
from wildscav_evaluator.plans.tournament import TournamentPlan
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES
from wildscav_evaluator.tournaments.names import with_unique_names

pytestmark = pytest.mark.usefixtures("compiled")

CIRCLER = """
    def reset(self, info):
        self.turn = info.seed % 7

    def act(self, observation):
        return Action(walk_direction=observation.step * 10.0 + self.turn, walk_speed=6.0)
"""
# The same up to its eighth step.
TURNCOAT = """
    def reset(self, info):
        self.turn = info.seed % 7

    def act(self, observation):
        speed = 6.0 if observation.step < 7 else 2.5
        return Action(walk_direction=observation.step * 10.0 + self.turn, walk_speed=speed)
"""
# Looks at what it sees: agrees in all steps only if it sees what was there in the match recorded.
OBSERVER = """
    def act(self, observation):
        return Action(walk_direction=observation.position[0] * 50.0, walk_speed=5.0)
"""


def again(path: Path, submission: Submission, logs: Path, seats: Sequence[int] = ()) -> None:
    run_again(path, submission, seats=seats, logs=logs, sandbox="process")


def recorded(path: Path, *submissions: Submission) -> Path:
    """Play a battle of some submissions with a robot, and keep its record."""
    seeds = tuple(range(4, 4 + len(submissions)))  # as an evaluation tells them
    seating = seated(
        *submissions, folder=path.parent, track="battle", seconds=2.0, robots=("fighter",), seeds=seeds
    )
    write_record(path, play(seating).match, seating.names)
    return path


@pytest.mark.parametrize("clock", ["running", "tokens"])
def test_a_match_in_which_thinking_costs_game_time_is_not_played_again(
    tmp_path: Path, submit: Submit, clock: str
) -> None:
    match = Match(MatchSpec(track="battle", map=SMALL, time_limit=1.0, clock=clock))
    match.play_out()
    nothing = np.zeros((0, len(CHARGE)), np.int64)
    match.thinking = Thinking((SeatThinking(seat=0, decisions=10, seconds=1.0),), nothing)
    write_record(tmp_path / "match.wsr", match, ["circler"])
    with pytest.raises(UserError, match=f"its clock is {clock}"):
        again(tmp_path / "match.wsr", submit("circler", CIRCLER), tmp_path)


def test_an_entry_of_a_tournament_is_known_by_its_files(
    submit: Submit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two versions of a submission met; each is compared with its own seat."""
    old, new = submit("circler", CIRCLER, tracks='["battle"]'), submit("other", TURNCOAT, tracks='["battle"]')
    new = replace(new, manifest=old.manifest.model_copy(update={"version": "2.0.0"}))
    plan = TournamentPlan(
        submissions=with_unique_names([old, new], meet_own=True),
        track="battle",
        settings=TournamentSettings(seats=2, meet_own=True),
        suite=SUITES["quick"],
        seed=SuiteSeed(0),
        replays="none",
        jobs=1,
        out=tmp_path / "out",
    )
    (plan.out / "records").mkdir(parents=True)
    LedgerWriter(plan.out, plan.identity(), None)
    path = recorded(plan.out / "records" / "battle-000.wsr", *plan.submissions)

    for submission, seat in ((old, 0), (new, 1)):
        again(path, submission, tmp_path / "again")
        said = capsys.readouterr().out
        assert f"seat {seat} (circler@{submission.manifest.version}): all 20 steps as recorded" in said
        assert "warning" not in said


def test_what_is_no_record_is_one_clear_line(submit: Submit, wildscav: Command, tmp_path: Path) -> None:
    circler = submit("circler", CIRCLER, tracks='["battle"]')
    path = tmp_path / "match.wsr"
    shutil.copy(circler.folder / "agent.py", path)

    done = wildscav("verify", path, "--agent", circler.folder, "--sandbox", "process", cwd=tmp_path)

    assert done.returncode == 2
    assert done.stderr.startswith(f"wildscav: {path}: ")
    assert len(done.stderr.splitlines()) == 1


def test_a_sandbox_is_for_agents_unless_only_the_environment_names_it(
    wildscav: Command, tmp_path: Path
) -> None:
    given = wildscav("verify", tmp_path, "--sandbox", "process")
    named = wildscav("verify", tmp_path, WILDSCAV_SANDBOX="process")

    assert given.returncode == 2
    assert "--sandbox is for a record with --agent; " in given.stderr
    assert "--sandbox" not in named.stderr


class Recorded(NamedTuple):
    """A match of two submissions with a robot, and one that did not play in it."""

    path: Path
    circler: Submission
    observer: Submission
    turncoat: Submission


@pytest.fixture(scope="module")
def match(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    place = tmp_path_factory.mktemp("match")
    bodies = {"circler": CIRCLER, "observer": OBSERVER, "turncoat": TURNCOAT}
    agents = [submission_in(place, name, body, tracks='["battle"]') for name, body in bodies.items()]
    return Recorded(recorded(place / "match.wsr", *agents[:2]), *agents)


def test_an_agent_that_acts_as_recorded_is_borne_out_beside_another_whose_seat_plays_its_record(
    match: Recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for seat, submission in enumerate((match.circler, match.observer)):
        again(match.path, submission, tmp_path)
        said = capsys.readouterr().out
        assert f"seat {seat} ({submission.name}): all 20 steps as recorded" in said


def test_another_agent_is_found_out_at_its_first_other_step(
    match: Recorded, wildscav: Command, tmp_path: Path
) -> None:
    options = ("--seat", 0, "--logs", tmp_path, "--sandbox", "process", "--json")
    done = wildscav("verify", match.path, "--agent", match.turncoat.folder, *options)

    difference = "walk_speed 6 recorded, 2.5 now"
    assert done.returncode == 1
    assert (
        "wildscav: seat 0 (circler) acts differently than recorded in 13 of 20 steps, first in step 8: "
        f"{difference}\n" in done.stderr
    )
    assert "may differ although its code is the same" in " ".join(done.stderr.split())
    document = json.loads(done.stdout)
    counts = {"late_steps": 0, "steps": 20, "differing": 13, "first": 8}
    seat = {"seat": 0, "name": "circler", "status": "finished", "difference": difference, **counts}
    assert document == {"record": str(match.path), "seats": [seat]}
    assert names(document) == json_documents()["verify of a record with --agent"]


def test_a_ledger_with_limits_that_no_sandbox_has_is_refused(match: Recorded, tmp_path: Path) -> None:
    path = tmp_path / "records" / "battle-000-circler.wsr"
    path.parent.mkdir()
    limits = {"battle": KeptLimits(output=1)}
    LedgerWriter(tmp_path, identity_of("circler", track="battle").model_copy(update={"limits": limits}), None)
    shutil.copy(match.path, path)

    with pytest.raises(UserError, match="the ledger's limits are not possible: output: ") as refused:
        again(path, match.circler, tmp_path / "again", [0])
    assert refused.value.exit_code == 2


def test_a_seat_must_be_one_of_the_submission(match: Recorded, tmp_path: Path) -> None:
    filled = r"0 \(circler\), 1 \(observer\)"
    with pytest.raises(UserError, match=rf"no seat in .* belongs to 'turncoat': the seats .* are {filled}"):
        again(match.path, match.turncoat, tmp_path)
    with pytest.raises(UserError, match=rf"--seat is 2: the seats of submissions in .* are {filled}"):
        again(match.path, match.circler, tmp_path, [2])
