"""Records of matches: writing, reading, re-simulation and verification."""

from wildscav_engine.record.format import (
    FILE_LIMIT,
    RECORD_VERSION,
    SUFFIX,
    Record,
    RecordError,
    check_recordable,
    read_record,
    record_of,
    save,
    write_record,
)
from wildscav_engine.record.verify import Verification, resimulate, verify_record

__all__ = [
    "FILE_LIMIT",
    "RECORD_VERSION",
    "SUFFIX",
    "Record",
    "RecordError",
    "Verification",
    "check_recordable",
    "read_record",
    "record_of",
    "resimulate",
    "save",
    "verify_record",
    "write_record",
]
