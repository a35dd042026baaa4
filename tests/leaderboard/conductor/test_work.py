"""The work that the conductor hands out: in which sandbox, on what, and what it keeps of it."""

import re
from dataclasses import replace
from pathlib import Path

import pytest
from tests.evaluator.sandbox.available import missing
from tests.leaderboard.agents import write_agent
from tests.leaderboard.seasons_made import NOON, changed, checked, make_season

from wildscav.errors import UserError
from wildscav_engine.storage.files import write_whole
from wildscav_evaluator.executors.local import LocalExecutor
from wildscav_evaluator.matches.jobs import Job, JobResult
from wildscav_evaluator.output.results import MatchRow
from wildscav_evaluator.sandbox import SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import call, find_engine
from wildscav_evaluator.sandbox.limits import DEFAULT_LIMITS
from wildscav_evaluator.submissions import images
from wildscav_leaderboard.conductor.work import (
    VARIABLE,
    Rejection,
    build,
    chosen_sandbox,
    job_of,
    keep_record,
    trial_of,
    validate,
)
from wildscav_leaderboard.matches.models import (
    FINAL,
    FINAL_ROUND,
    LADDER,
    SEASON_ROUND,
    SUITE,
    Match,
    MatchSeat,
)
from wildscav_leaderboard.matches.record_files import record_digest
from wildscav_leaderboard.seasons.folder import Season
from wildscav_leaderboard.submissions.archives import archive_name
from wildscav_server.monitoring.logs import open_log


@pytest.fixture
def result(tmp_path: Path) -> JobResult:
    """The result of a match whose record was written."""
    season = make_season(tmp_path / "season")
    job = Job(
        submissions=(),
        track="navigation",
        index=0,
        spec=season.suite_matches["navigation"][0],
        out=tmp_path / "match",
        replay=False,
        key="match-1",
        sandbox="process",
        limits=DEFAULT_LIMITS,
        evaluated="runner-1",
    )
    path = job.out / job.record
    path.parent.mkdir(parents=True)
    path.write_bytes(b"the first record")
    return JobResult(
        job, MatchRow(index=0, status="finished", metrics={"time": 1.0}, record=job.record), None
    )


def test_a_worker_that_comes_too_late_cannot_change_a_record_that_is_kept(result: JobResult) -> None:
    row, record = keep_record(result)
    write_whole(result.job.out / result.job.record, b"another record of the same match")
    kept = result.job.out / str(row.record)
    assert row.record != result.row.record
    assert kept.read_bytes() == b"the first record"
    assert (record_digest(kept.read_bytes()), kept.stat().st_size) == (record.digest, record.size)


def test_a_record_is_kept_once_however_often_it_comes(result: JobResult) -> None:
    first, _ = keep_record(result)
    again, record = keep_record(result)
    assert first == again
    assert record_digest((result.job.out / str(again.record)).read_bytes()) == record.digest
    assert len(list((result.job.out / result.job.record).parent.iterdir())) == 2


@pytest.mark.slow
def test_a_team_is_told_what_is_doubtful_about_a_submission_that_takes_part(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season")
    loud = "    def act(self, observation): print('x' * 100_000); return Action()\n"
    archive = archive_name(checked(season, write_agent(tmp_path, "loud", loud)))

    warnings = validate(season, archive, "loud-1", "process", 1)

    assert isinstance(warnings, str)
    assert re.fullmatch(r"output: [\d,]+ of 1,000,000 bytes printed", warnings)
    assert re.fullmatch(r"late answers: \d+ of 40 steps played", season.validation_file(1).read_text())


@pytest.mark.parametrize(
    ("kind", "group", "final"),
    [(SUITE, 5, False), (FINAL, 5, True), (LADDER, SEASON_ROUND, False), (LADDER, FINAL_ROUND, True)],
)
def test_the_private_seeds_of_a_match_follow_from_the_secret_that_its_map_follows_from(
    tmp_path: Path, kind: str, group: int, *, final: bool
) -> None:
    season = make_season(tmp_path / "season")
    archive = checked(season, write_agent(tmp_path, "walker"))
    matches = season.final_matches if final else season.suite_matches
    spec = matches["navigation"][0]
    match = Match(
        kind=kind,
        track="navigation",
        number=0,
        group_id=group,
        spec=spec.model_dump(mode="json"),
        created=NOON,
        since=NOON,
    )
    match.id = 1
    seat = MatchSeat(match_id=1, seat=0, submission_id=5, entrant="walker-1")

    job = job_of(season, match, [seat], {5: archive_name(archive)}, "process")

    secret = season.final_seed if final else season.seed
    assert job.seeds == secret.private(spec, [archive.digest])


def test_packages_that_no_sandbox_of_the_season_installs_are_the_competitors_fault(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season")
    folder = write_agent(tmp_path, "walker")
    (folder / "requirements.txt").write_text("no-such-package\n")
    archive = archive_name(checked(season, folder))

    rejection = validate(season, archive, "walker-1", "process", 1)

    assert isinstance(rejection, Rejection)
    assert rejection.reason.startswith(
        "packages: requirements.txt names 'no-such-package', which this machine"
    )
    assert str(season.folder) not in rejection.reason


@pytest.mark.slow
@pytest.mark.parametrize("broken", ["base.Dockerfile", "agent.Dockerfile"])
def test_only_a_build_of_the_submission_itself_is_the_competitors_fault(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, broken: str
) -> None:
    if why := missing("oci"):
        pytest.skip(why)
    season = make_season(tmp_path / "season")
    folder = write_agent(tmp_path, "walker")
    (folder / "requirements.txt").write_text("no-such-package\n")
    archive = archive_name(checked(season, folder))
    for name in ("base.Dockerfile", "agent.Dockerfile"):
        missing_file = "COPY no-such-file /\n" if name == broken else ""
        (tmp_path / name).write_text(f"FROM scratch\nCOPY . /\n{missing_file}")
    monkeypatch.setattr(images, "DOCKERFILES", tmp_path)
    monkeypatch.setenv(images.PYTHON, base := f"of-{tmp_path.name}")
    try:
        if broken == "base.Dockerfile":
            with pytest.raises(SandboxError, match=r"could not be built: .*no-such-file"):
                build(season, archive, "walker-1", "oci")
        else:
            rejection = build(season, archive, "walker-1", "oci")
            assert isinstance(rejection, Rejection)
            assert "no-such-file" in rejection.last_lines[-1]
    finally:
        call(find_engine(), "rmi", "-f", images.base_name(base))


def test_a_ladder_is_tried_with_the_seats_of_its_matches(tmp_path: Path) -> None:
    season = make_season(tmp_path / "season")
    spec, limits, *_ = trial_of(season, "battle", "walker-1")
    assert (sorted(spec.seats), limits) == (["fighter", "submission"], season.limits("battle"))


def test_a_match_without_a_record_is_refused(result: JobResult) -> None:
    without = replace(result, row=result.row.model_copy(update={"record": None}))
    with pytest.raises(UserError, match="the match match-1 has no record"):
        keep_record(without)


@pytest.fixture
def untold(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Season:
    """A season whose settings name no sandbox, on a machine without the programs that sandboxes need."""
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv(VARIABLE, raising=False)
    season = make_season(tmp_path / "season")
    return changed(season, execution=season.settings.execution.model_copy(update={"sandbox": None}))


@pytest.mark.parametrize(
    ("named", "says"),
    [
        (None, r"no sandbox works here .+ sandbox = 'process' in the settings"),
        ("bubblewrap", "the sandbox bubblewrap cannot be kept here"),  # for all seasons
    ],
)
def test_agents_of_strangers_run_in_a_sandbox_or_not_at_all(
    untold: Season, monkeypatch: pytest.MonkeyPatch, named: str | None, says: str
) -> None:
    if named is not None:
        monkeypatch.setenv(VARIABLE, named)
    with pytest.raises(UserError, match=says):
        chosen_sandbox(untold, LocalExecutor(1), open_log(None))


def test_the_settings_may_ask_for_none_and_the_warning_names_what_an_organizer_can_set(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    season = make_season(tmp_path / "trusting")
    assert chosen_sandbox(season, LocalExecutor(1), open_log("text")) == "process"
    said = "".join(capsys.readouterr())
    assert "set sandbox = 'bubblewrap' or 'oci' under [execution]" in said
    assert "--sandbox" not in said
