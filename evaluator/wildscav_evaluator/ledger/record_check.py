"""What ``wildscav verify`` asks about records of evaluations: whether they are the ones that were played."""

from functools import lru_cache
from pathlib import Path

from wildscav_engine.record import Record
from wildscav_evaluator.ledger.ledger import Ledger, LedgerError, check_key, read_ledger, sha256_of
from wildscav_evaluator.output.layout import LEDGER_FILE, RECORDS
from wildscav_evaluator.output.record_names import misnamed, parse_name


def check_record(path: Path, record: Record, key: str | None) -> str:
    """Return why a record is not the one that its name and its evaluation's ledger tell of; nothing if it is.

    Args:
        path: Its file.
        record: What is in it.
        key: The public key that the ledger must be signed with; any, or none, if none is given.

    Raises:
        UserError: The key is no key.
    """
    name = parse_name(path)
    if name is not None and (fault := misnamed(record, name)):
        return f"it is under another's name: {fault}"
    out = path.absolute().parent.parent
    try:
        ledger = _ledger(out) if path.absolute().parent.name == RECORDS else None
        if key is not None:
            check_key(ledger, _public(key), out)
    except LedgerError as error:
        return str(error)
    return "" if ledger is None else _not_entered(path, ledger)


def _not_entered(path: Path, ledger: Ledger) -> str:
    """Return in what a record differs from the ledger of its folder."""
    entered = ledger.played.get(path.stem)
    if entered is None:
        return f"{LEDGER_FILE} knows no such match"
    return "" if entered.record == sha256_of(path) else f"it is not the record that {LEDGER_FILE} has of it"


@lru_cache(maxsize=1)
def _ledger(out: Path) -> Ledger | None:
    return read_ledger(out)


@lru_cache(maxsize=1)
def _public(key: str) -> str:
    from wildscav_evaluator.ledger.keys import read_public

    return read_public(key)
