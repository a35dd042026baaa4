"""One evaluation of two submissions, really played and signed, and copies of its folder to be forged."""

from pathlib import Path

import pytest
from tests.evaluator.ledger.forging import Forgery, Rescored, copied

from wildscav.errors import UserError
from wildscav_evaluator.cli.sessions.rescore import run_rescore
from wildscav_evaluator.executors.local import LocalExecutor


@pytest.fixture
def signed(evaluated: Path, tmp_path: Path) -> Forgery:
    """A copy of the folder."""
    return copied(evaluated, tmp_path / "out")


@pytest.fixture
def unsigned(signed: Forgery) -> Forgery:
    """The same folder as nobody signed it."""
    signed.rewrite_ledger()
    return signed


@pytest.fixture
def rescored(capsys: pytest.CaptureFixture[str]) -> Rescored:
    """Rescore a folder that must be refused, and return all the lines that say why."""

    def run(forgery: Forgery, key: str | None = None) -> str:
        capsys.readouterr()
        with pytest.raises(UserError) as refused:
            run_rescore(forgery.out, LocalExecutor(1), key)
        assert refused.value.exit_code != 0
        return f"{capsys.readouterr().err}\n{refused.value}"

    return run
