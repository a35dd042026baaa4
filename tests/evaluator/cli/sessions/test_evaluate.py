"""What becomes of results that cannot all be kept."""

from pathlib import Path

from tests.evaluator.results_by_hand import identity_of, results_of

from wildscav_evaluator.cli.sessions.playing import saving_errors
from wildscav_evaluator.ledger.writer import LedgerWriter
from wildscav_evaluator.output.results import read_results


def test_a_ledger_that_cannot_be_closed_keeps_no_results_from_being_shown(tmp_path: Path) -> None:
    results = results_of("ada")
    ledger = LedgerWriter(tmp_path, identity_of("ada"), None)
    ledger._path = Path("/dev/full")  # the disk is full from here on

    (said,) = saving_errors(results, tmp_path, ledger)

    assert said == "the ledger /dev/full cannot be written: No space left on device"
    assert read_results(tmp_path / "results.json") == results
