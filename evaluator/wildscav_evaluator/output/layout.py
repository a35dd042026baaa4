"""The names of the files and folders in the output folder of an evaluation."""

RESULTS_FILE = "results.json"
IDENTITY_FILE = "evaluation.json"  # the identity of the evaluation
LEDGER_FILE = "ledger.jsonl"
COMPARISON_FILE = "comparison.json"
SUITE_FILE = "suite.toml"  # a copy of an organizer's own suite
OPENED_FILE = "secret.txt"  # the opened secret
RECORDS, REPLAYS, LOGS = "records", "replays", "logs"
MATCHES = "matches"  # the folder of the journal


def stem_of(track: str, index: int, submission: str) -> str:
    """Return the stem of the names of the files of a submission's match."""
    return f"{track}-{index:03d}-{submission}"
