"""The check of ``wildscav verify`` whether records of evaluations are those that the ledger lists."""

from functools import lru_cache
from pathlib import Path

from wildscav_engine.record import Record
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, check_key, read_ledger, sha256_of
from wildscav_evaluator.output.layout import LEDGER_FILE, RECORDS
from wildscav_evaluator.output.record_names import misnamed, parse_name


def check_record(path: Path, record: Record, key: str | None) -> str:
    """Return why a record does not match its name or its evaluation's ledger, or an empty text if it does.

    Args:
        path: The file of the record.
        record: The record.
        key: The public key that the ledger must be signed with; None to accept any ledger.

    Raises:
        UserError: The key is not a public key.
    """
    name = parse_name(path)
    if name is not None and (fault := misnamed(record, name)):
        return f"its file has the name of another record: {fault}"
    out = path.absolute().parent.parent
    try:
        ledger = _ledger(out) if path.absolute().parent.name == RECORDS else None
        if key is not None:
            check_key(ledger, _public(key), out)
    except LedgerError as error:
        return str(error)
    return "" if ledger is None else _not_entered(path, ledger)


def _not_entered(path: Path, ledger: Ledger) -> str:
    """Return how a record differs from the ledger of its folder, or an empty text if it does not."""
    entered = ledger.played.get(path.stem)
    if entered is None:
        return f"{LEDGER_FILE} has no such match"
    return "" if entered.record == sha256_of(path) else f"{LEDGER_FILE} has the digest of another record"


@lru_cache(maxsize=1)
def _ledger(out: Path) -> Ledger | None:
    return read_ledger(out)


@lru_cache(maxsize=1)
def _public(key: str) -> str:
    from wildscav_evaluator.ledger.keys import read_public

    return read_public(key)
