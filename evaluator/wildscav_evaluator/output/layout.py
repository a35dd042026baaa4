"""What the files and folders in the output folder of an evaluation are called."""

RESULTS_FILE = "results.json"
IDENTITY_FILE = "evaluation.json"  # which evaluation it is
LEDGER_FILE = "ledger.jsonl"
COMPARISON_FILE = "comparison.json"
SUITE_FILE = "suite.toml"  # a copy of an organizer's own
OPENED_FILE = "secret.txt"  # the opened secret
RECORDS, REPLAYS, LOGS = "records", "replays", "logs"
MATCHES = "matches"  # the folder of the journal


def stem_of(track: str, index: int, submission: str) -> str:
    """Return what the files of a submission's match are called."""
    return f"{track}-{index:03d}-{submission}"
