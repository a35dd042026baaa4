"""Files of an output folder may be anybody's: what is read, and at a price that is known."""

import os
from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import results_of

from wildscav.errors import UserError
from wildscav_evaluator.ledger.ledger import LedgerError, read_ledger
from wildscav_evaluator.output.identity import read_identity
from wildscav_evaluator.output.json_files import LARGEST, SMALL
from wildscav_evaluator.output.layout import LEDGER_FILE
from wildscav_evaluator.output.results import read_results, write_results
from wildscav_evaluator.suites.seeds import read_secret
from wildscav_evaluator.suites.suite_file import read_suite

READERS = {
    "results.json": read_results,
    "evaluation.json": lambda path: read_identity(path.parent),
    LEDGER_FILE: lambda path: read_ledger(path.parent),
    "suite.toml": read_suite,
    "secret.txt": read_secret,
}


@pytest.mark.parametrize("name", READERS)
def test_what_is_no_plain_file_is_not_waited_for(name: str, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / name)
    with pytest.raises((UserError, OSError), match="it is not a plain file") as caught:
        READERS[name](tmp_path / name)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", READERS)
def test_what_is_longer_than_it_can_be_is_not_read(name: str, tmp_path: Path) -> None:
    with (tmp_path / name).open("wb") as file:
        file.truncate(10 * LARGEST)
    with pytest.raises((UserError, OSError), match=r"it has more than [\d,]+ bytes"):
        READERS[name](tmp_path / name)


def test_a_hundred_thousand_faults_are_one_short_line(tmp_path: Path) -> None:
    path = tmp_path / "results.json"
    path.write_bytes(b'{"evaluations":[' + b"0," * 100_000 + b"0]}")
    assert path.stat().st_size < SMALL
    with pytest.raises(UserError, match=r"100,\d+ of its values are invalid") as caught:
        read_results(path)
    assert len(str(caught.value)) < 300


def test_large_results_are_read_like_small_ones(tmp_path: Path) -> None:
    results = results_of(*(f"agent-{number}" for number in range(400)))
    path = write_results(results, tmp_path)
    assert path.stat().st_size > SMALL
    assert read_results(path) == results


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "content", "says"),
    [
        ("results.json", b'{"evaluations":[' + b"0," * 15_000_000 + b"0]}", "MiB of memory"),
        ("results.json", b"[" * 30_000_000, "recursion limit exceeded"),
        ("evaluation.json", b'{"submissions":[' + b"0," * 15_000_000 + b"0]}", "is not of this version"),
        (LEDGER_FILE, b"\n" * 30_000_000, "line 1: not an entry"),
        (LEDGER_FILE, b"[" * 30_000_000 + b"\n", "line 1: not an entry"),
        ("suite.toml", b".".join([b"a"] * 50_000) + b"=1\n", "reading it would cost too much"),
    ],
)
def test_what_would_eat_time_or_memory_is_refused_in_a_line(
    name: str, content: bytes, says: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises((UserError, LedgerError), match=says) as caught:
        READERS[name](tmp_path / name)
    assert "\n" not in str(caught.value)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize(
    ("content", "says"),
    [
        ("{}", "is not a results file of format 2: versions: Field required"),
        ("[1, 2]", "is not a results file of format 2"),
        ('{"format": 1}', "is not a results file of format 2"),
        ("[" * 100_000, "is not a results file of format 2"),
        ("no JSON", "is not a results file of format 2"),
    ],
)
def test_what_is_no_results_file_is_one_clear_line(tmp_path: Path, content: str, says: str) -> None:
    path = tmp_path / "results.json"
    path.write_text(content)

    with pytest.raises(UserError, match=says) as refused:
        read_results(path)

    assert "\n" not in str(refused.value)
