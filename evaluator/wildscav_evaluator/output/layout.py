"""The names of the files and folders in the output of an evaluation, and of a published season."""

RESULTS_FILE = "results.json"
IDENTITY_FILE = "evaluation.json"  # the identity of the evaluation
LEDGER_FILE = "ledger.jsonl"
COMPARISON_FILE = "comparison.json"
TOURNAMENT_FILE = "tournament.json"
STANDINGS_PICTURE = "standings.png"
SUITE_FILE = "suite.toml"  # a copy of an organizer's own suite
OPENED_FILE = "secret.txt"  # the opened secret
SEASON_FILE = "season.json"  # of a season that is published
RECORDS, REPLAYS, LOGS = "records", "replays", "logs"
EXCHANGES = "exchanges"  # what agents asked a model, and its answers: for organizers alone
JOURNAL = "matches"  # of earlier versions, which wrote each match there before the ledger


def stem_of(track: str, index: int, submission: str | None) -> str:
    """Return the stem of the names of a match's files; the submission is None in a tournament."""
    return f"{track}-{index:03d}" if submission is None else f"{track}-{index:03d}-{submission}"
