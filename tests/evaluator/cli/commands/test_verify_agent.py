"""`wildscav verify --agent`: only an agent that acts as recorded is borne out by its record."""

import asyncio
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.evaluator.sample_agents import Command, Submit

from wildscav.errors import UserError
from wildscav_engine.record import write_record
from wildscav_engine.simulation.match import Match
from wildscav_engine.specs.map_spec import MapConfig, MapSpec
from wildscav_engine.specs.match_spec import MatchSpec
from wildscav_engine.specs.thinking import SeatThinking, Thinking
from wildscav_evaluator.cli.sessions.run_again import run_again
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.matches.play import MatchAssignment, play_match
from wildscav_evaluator.output.results import TournamentSettings
from wildscav_evaluator.plans.tournament import TournamentPlan
from wildscav_evaluator.suites.seeds import SuiteSeed
from wildscav_evaluator.suites.suite import SUITES
from wildscav_evaluator.tournaments.names import with_unique_names

pytestmark = pytest.mark.usefixtures("compiled")

MAP = MapSpec(config=MapConfig(size=40, houses=0), seed=1)
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


@pytest.mark.parametrize("clock", ["running", "tokens"])
def test_a_match_in_which_thinking_costs_game_time_is_not_played_again(
    tmp_path: Path, submit: Submit, clock: str
) -> None:
    match = Match(MatchSpec(track="battle", map=MAP, time_limit=1.0, clock=clock))
    match.play_out()
    match.thinking = Thinking((SeatThinking(seat=0, decisions=0, seconds=0.0),), np.zeros((0, 5), np.int64))
    write_record(tmp_path / "match.wsr", match, ["circler"])
    with pytest.raises(UserError, match=f"its clock is {clock}"):
        run_again(
            tmp_path / "match.wsr", submit("circler", CIRCLER), seats=(), logs=tmp_path, sandbox="process"
        )


def recorded(path: Path, *submissions: object, logs: Path) -> Path:
    """Play a battle of some submissions with a robot, and keep its record."""
    seats = ("submission",) * len(submissions) + ("fighter",)
    spec = MatchSpec(track="battle", map=MAP, seats=seats, time_limit=2.0)
    places = tuple(logs / f"{number}.log" for number in range(len(submissions)))
    seeds = tuple(range(4, 4 + len(submissions)))  # as an evaluation tells them
    seating = MatchAssignment(spec, submissions, places, seeds=seeds)  # type: ignore[arg-type]
    logs.mkdir(exist_ok=True)
    played = asyncio.run(play_match(seating))
    write_record(path, played.match, seating.names)
    return path


def test_an_agent_that_acts_as_recorded_is_borne_out(
    submit: Submit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Also beside another submission, whose seat plays what is recorded of it."""
    circler, observer = (
        submit("circler", CIRCLER, tracks='["battle"]'),
        submit("observer", OBSERVER, tracks='["battle"]'),
    )
    path = recorded(tmp_path / "match.wsr", circler, observer, logs=tmp_path / "logs")

    for submission, seat in ((circler, 0), (observer, 1)):
        run_again(path, submission, seats=[], logs=tmp_path / "again", sandbox="process")
        said = capsys.readouterr().out
        assert f"seat {seat} ({submission.name}): all 20 steps as recorded" in said


def test_another_agent_is_found_out_at_its_first_other_step(
    submit: Submit, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    circler, turncoat = (
        submit("circler", CIRCLER, tracks='["battle"]'),
        submit("turncoat", TURNCOAT, tracks='["battle"]'),
    )
    path = recorded(tmp_path / "match.wsr", circler, logs=tmp_path / "logs")

    with pytest.raises(UserError) as refused:
        run_again(path, turncoat, seats=[0], logs=tmp_path / "again", sandbox="process")

    assert refused.value.exit_code == 1
    assert str(refused.value) == (
        "seat 0 (circler) acts differently than recorded in 13 of 20 steps, first in step 8: walk_speed 6 "
        "recorded, 2.5 now"
    )
    assert "may differ although its code is the same" in capsys.readouterr().out


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
    path = recorded(plan.out / "records" / "battle-000.wsr", *plan.submissions, logs=tmp_path / "logs")

    for submission, seat in ((old, 0), (new, 1)):
        run_again(path, submission, seats=[], logs=tmp_path / "again", sandbox="process")
        said = capsys.readouterr().out
        assert f"seat {seat} (circler@{submission.manifest.version}): all 20 steps as recorded" in said
        assert "warning" not in said


def test_a_seat_must_be_one_of_the_submission(submit: Submit, tmp_path: Path) -> None:
    circler, other = (
        submit("circler", CIRCLER, tracks='["battle"]'),
        submit("other", CIRCLER, tracks='["battle"]'),
    )
    path = recorded(tmp_path / "match.wsr", circler, logs=tmp_path / "logs")

    with pytest.raises(UserError, match=r"no seat in .* belongs to 'other': the seats .* are 0 \(circler\)"):
        run_again(path, other, seats=[], logs=tmp_path / "again", sandbox="process")
    with pytest.raises(UserError, match=r"--seat is 1: the seats of submissions in .* are 0 \(circler\)"):
        run_again(path, circler, seats=[1], logs=tmp_path / "again", sandbox="process")


def test_what_is_no_record_is_one_clear_line(submit: Submit, wildscav: Command, tmp_path: Path) -> None:
    circler = submit("circler", CIRCLER, tracks='["battle"]')
    path = tmp_path / "match.wsr"
    shutil.copy(circler.folder / "agent.py", path)

    done = wildscav("verify", path, "--agent", circler.folder, "--sandbox", "process", cwd=tmp_path)

    assert done.returncode == 2
    assert done.stderr.startswith(f"wildscav: {path}: ")
    assert len(done.stderr.splitlines()) == 1
