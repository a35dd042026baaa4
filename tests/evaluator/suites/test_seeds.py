"""Hidden seeds: bound by a public commitment, told by nothing before they are opened."""

import hashlib
import json
import shutil
import stat
from functools import partial
from pathlib import Path

import pytest
from tests.commands import Done, Run, run_command
from tests.evaluator.conftest import submission_in
from tests.evaluator.results_by_hand import plan_of
from tests.evaluator.sample_agents import WALKER
from tests.evaluator.small_matches import tiny_suite
from tests.evaluator.warm_workers import WarmWorkers, playing_with

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.evaluate import run_session
from wildscav_evaluator.output.layout import OPENED_FILE
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.scores.expected_matches import check_opened, expected_matches
from wildscav_evaluator.suites.seeds import SuiteSeed, read_secret
from wildscav_evaluator.suites.suite_file import read_suite


@pytest.fixture
def secret(tmp_path: Path) -> Run:
    """Run `wildscav season secret`."""
    return partial(run_command, "season", "secret", cwd=tmp_path, columns=200)


@pytest.fixture(scope="module")
def hidden(tmp_path_factory: pytest.TempPathFactory, warm_workers: WarmWorkers) -> tuple[Path, Path]:
    """A secret's file, and the output folder of an evaluation with that hidden seed."""
    folder = tmp_path_factory.mktemp("hidden")
    file, out = folder / "season.secret", folder / "out"
    file.write_bytes(b"nobody knows this, and nobody is going to guess it\n")
    suite = read_suite(tiny_suite(folder))
    with playing_with(warm_workers):
        run_session(
            plan_of(submission_in(folder, "walker", WALKER), out=out, suite=suite, seed=read_secret(file))
        )
    return file, out


def verified(out: Path, commitment: object) -> Done:
    """Run `wildscav verify`."""
    return run_command("verify", out, "--workers", 1, "--commitment", commitment, columns=200)


def test_a_new_secret_is_private_and_its_commitment_is_the_sha256_of_its_file(
    secret: Run, tmp_path: Path
) -> None:
    made = secret("new", "season.secret")

    content = (tmp_path / "season.secret").read_bytes()
    assert made.stdout.strip() == hashlib.sha256(content).hexdigest()
    assert secret("commitment", "season.secret").stdout == made.stdout
    assert stat.S_IMODE((tmp_path / "season.secret").stat().st_mode) == 0o600
    assert len(content) > 64
    again = secret("new", "season.secret")
    assert (again.returncode, "never overwritten" in again.stderr) == (2, True)
    assert (tmp_path / "season.secret").read_bytes() == content


def test_other_secrets_give_other_seeds_that_their_commitments_do_not_tell(tmp_path: Path) -> None:
    one, other = tmp_path / "one", tmp_path / "other"
    one.write_bytes(b"1" * 32)
    other.write_bytes(b"2" * 32)

    first, second = read_secret(one), read_secret(other)

    assert first == read_secret(one)
    assert first.value != second.value
    assert first.value != int(str(first.commitment), 16)
    assert str(first.value) not in first.label
    assert first.label == f"hidden:{str(first.commitment)[:12]}"
    assert SuiteSeed(7).label == "7"


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (None, "cannot be read: No such file"),
        (b"guess me", "has 8 bytes, a secret must have 32 to 4096"),
        (b"x" * 5000, "has 5000 bytes, a secret must have 32 to 4096"),
    ],
)
def test_what_can_be_no_secret_is_refused(tmp_path: Path, content: bytes | None, says: str) -> None:
    if content is not None:
        (tmp_path / "secret").write_bytes(content)
    with pytest.raises(UserError, match=says):
        read_secret(tmp_path / "secret")


def test_results_tell_the_commitment_and_not_the_seed(hidden: tuple[Path, Path]) -> None:
    file, out = hidden
    told, seed = read_results(out / "results.json"), read_secret(file)

    assert (told.seed, told.commitment) == (None, seed.commitment)
    assert told.seed_label == seed.label
    for name in ("results.json", "evaluation.json"):
        assert str(seed.value) not in (out / name).read_text()
    assert expected_matches(out, told) is None


def test_an_opened_secret_shows_that_its_matches_were_played(hidden: tuple[Path, Path], secret: Run) -> None:
    file, out = hidden
    commitment = read_secret(file).commitment
    assert "is not opened: use" in verified(out, str(commitment).upper()).stderr

    opened = secret("open", file, out)
    checked = verified(out, commitment)

    assert opened.returncode == checked.returncode == 0
    assert str(commitment) in opened.stdout
    assert "5 records are of matches that the secret determines" in checked.stdout
    told = read_results(out / "results.json")
    expected = expected_matches(out, told)
    assert expected is not None
    assert len(expected["navigation"]) == 5
    (out / OPENED_FILE).unlink()


def test_another_secret_than_that_committed_to_is_found_out(
    hidden: tuple[Path, Path], secret: Run, tmp_path: Path
) -> None:
    file, out = hidden
    other = tmp_path / "other"
    other.write_bytes(b"the one that would have suited my friend's agent better")
    mine = str(read_secret(file).commitment)

    assert "was evaluated on the secret of" in secret("open", other, out).stderr
    assert "was evaluated with the commitment" in verified(out, read_secret(other).commitment).stderr
    assert "must be 64 hexadecimal digits" in verified(out, "1234").stderr

    (out / OPENED_FILE).write_bytes(other.read_bytes())
    assert "is not the secret of the commitment" in verified(out, mine).stderr
    (out / OPENED_FILE).unlink()


def test_results_that_name_the_commitment_and_other_matches_are_found_out(
    hidden: tuple[Path, Path], tmp_path: Path
) -> None:
    """An organizer plays matches of an own choice and puts the commitment into the results."""
    _, out = hidden
    other = tmp_path / "other"
    other.write_bytes(b"the one that was committed to, but whose matches were not to somebody's liking")
    forged = tmp_path / "out"
    forged.mkdir()
    shutil.copytree(out / "records", forged / "records")
    shutil.copy(out / "suite.toml", forged)
    told = json.loads((out / "results.json").read_text())
    told["commitment"] = read_secret(other).commitment
    (forged / "results.json").write_text(json.dumps(told))
    (forged / OPENED_FILE).write_bytes(other.read_bytes())

    with pytest.raises(UserError, match=r"navigation-000-walker\.wsr is not of a match that the secret"):
        check_opened(forged, told["commitment"])


def test_an_evaluation_on_a_public_seed_has_nothing_to_open(
    secret: Run, hidden: tuple[Path, Path], tmp_path: Path
) -> None:
    file, out = hidden
    told = json.loads((out / "results.json").read_text())
    (tmp_path / "results.json").write_text(json.dumps({**told, "seed": 0, "commitment": None}))

    assert "was evaluated on a public seed" in secret("open", file, tmp_path).stderr
    assert "was evaluated on a public seed" in verified(tmp_path, "0" * 64).stderr
