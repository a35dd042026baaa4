"""What becomes of results that cannot all be kept."""

from pathlib import Path

from tests.evaluator.results_by_hand import results_of

from wildscav_evaluator.cli.session import _written
from wildscav_evaluator.ledger.keeper import Keeper
from wildscav_evaluator.output.identity import Entrant, Identity
from wildscav_evaluator.output.results import read_results
from wildscav_evaluator.output.versions import CURRENT_VERSIONS


def test_a_ledger_that_cannot_be_closed_keeps_no_results_from_being_shown(tmp_path: Path) -> None:
    results = results_of("ada")
    identity = Identity(
        versions=CURRENT_VERSIONS,
        suite="quick",
        seed="0",
        tracks=("navigation",),
        matches="0" * 32,
        submissions=(Entrant(name="ada", version="1", digest="1" * 32, tracks=("navigation",)),),
        sandbox="process",
        limits={},
    )
    ledger = Keeper(tmp_path, identity, None)
    ledger._path = Path("/dev/full")  # the disk is full from here on

    (said,) = _written(results, tmp_path, ledger)

    assert said == "the ledger /dev/full cannot be written: No space left on device"
    assert read_results(tmp_path / "results.json") == results
