"""What somebody who can write to an evaluation's folder may try, and the line that gives it away."""

from tests.evaluator.ledger.forging import Forgery, blamed_on_platform, with_metrics

from wildscav_evaluator.output.results import KeptLimits, MatchRow
from wildscav_evaluator.suites.suite_file import read_suite

MATCHES = 5


def worst(forgery: Forgery, name: str = "ada") -> int:
    """The match whose loss raises a submission's mean most."""
    rows = forgery.evaluation(name).matches
    return max(rows, key=lambda row: (row.metrics or {})["time"]).index


def drop(forgery: Forgery) -> None:
    index = worst(forgery)
    forgery.remove_match("ada", index)
    forgery.change_matches("ada", lambda row: None if row.index == index else row)


def blame(forgery: Forgery) -> None:
    for index in range(1, MATCHES):
        forgery.remove_match("ada", index)
    forgery.change_matches("ada", lambda row: blamed_on_platform(row) if row.index else row)


def vanish(forgery: Forgery) -> None:
    for index in range(MATCHES):
        forgery.remove_match("bob", index)
    ada = forgery.evaluation("ada")
    timings = forgery.results.timings
    left = tuple(one for one in timings.matches if one.submission == "ada")
    forgery.tell(evaluations=(ada,), timings=timings.model_copy(update={"matches": left}))


def replace_record(forgery: Forgery) -> None:
    index = worst(forgery)
    before = forgery.evaluation("ada").matches[index].metrics
    metrics = forgery.play_otherwise("ada", index)
    assert metrics != before
    forgery.change_matches("ada", lambda row: with_metrics(row, metrics) if row.index == index else row)


def shut_in(forgery: Forgery) -> None:
    forgery.tell(sandbox="oci")


def excuse(forgery: Forgery) -> None:
    def late(row: MatchRow) -> MatchRow:
        seats = tuple(seat.model_copy(update={"status": "crashed", "fault": "agent"}) for seat in row.seats)
        return MatchRow.of(row.index, seats, row.record)

    forgery.change_matches("bob", late)


def answer_faster(forgery: Forgery) -> None:
    timings = forgery.results.timings
    quick = tuple(one.model_copy(update={"wall": 0.001}) for one in timings.matches)
    forgery.tell(timings=timings.model_copy(update={"matches": quick}))


def swap(forgery: Forgery) -> None:
    """A match of bob's for ada's, with its record, and the other way round."""
    index = worst(forgery)
    metrics = {name: forgery.evaluation(name).matches[index].metrics or {} for name in ("ada", "bob")}
    records = {name: forgery.record(name, index) for name in ("ada", "bob")}
    whole = {name: path.read_bytes() for name, path in records.items()}
    for name, other in (("ada", "bob"), ("bob", "ada")):
        told = metrics[other]
        forgery.change_matches(
            name, lambda row, told=told: with_metrics(row, told) if row.index == index else row
        )
        records[name].write_bytes(whole[other])


def tell_twice(forgery: Forgery) -> None:
    """Ada's best match in place of her worst one, with its record."""
    index = worst(forgery)
    rows = forgery.evaluation("ada").matches
    best = min(rows, key=lambda row: (row.metrics or {})["time"])
    forgery.record("ada", index).write_bytes(forgery.record("ada", best.index).read_bytes())
    told = best.metrics or {}
    forgery.change_matches("ada", lambda row: with_metrics(row, told) if row.index == index else row)


def shorten(forgery: Forgery) -> None:
    """A suite without its last match."""
    file = forgery.out / "suite.toml"
    file.write_text(file.read_text().replace(f"maps = {MATCHES}", f"maps = {MATCHES - 1}"))
    for name in ("ada", "bob"):
        forgery.remove_match(name, MATCHES - 1)
        forgery.change_matches(name, lambda row: row if row.index < MATCHES - 1 else None)
    forgery.tell(suite=read_suite(file).label)


FORGERIES = {
    "the worst match dropped": (drop, "ada on navigation: match {worst} of the suite is not in the results"),
    "losses blamed on the platform": (
        blame,
        "ada on navigation, match 1: there is no record of it; only a ledger that the organizer signed",
    ),
    "a competitor vanished": (
        vanish,
        "bob on navigation: evaluation.json names it as an entrant, but there are no results",
    ),
    "a record of other actions": (
        replace_record,
        "navigation-00{worst}-ada: its record is not the one that ledger.jsonl names",
    ),
    "other limits": (
        lambda forgery: forgery.tell(limits={"navigation": KeptLimits(memory=2**30)}),
        "results.json says limits {{'navigation': KeptLimits(cpus=None, memory=1073741824",
    ),
    "another submission": (
        lambda forgery: forgery.tell_of("ada", digest="0" * 32),
        "ada on navigation: results.json and evaluation.json name another version, files or interface",
    ),
    "another interface": (
        lambda forgery: forgery.tell_of("ada", interface="words"),
        "ada on navigation: results.json and evaluation.json name another version, files or interface",
    ),
    "another sandbox": (shut_in, "results.json says sandbox oci, evaluation.json process"),
    "agents that crashed": (excuse, "navigation-000-bob: results.json and ledger.jsonl disagree about it"),
    "quicker agents": (
        answer_faster,
        "navigation-000-ada: results.json and ledger.jsonl disagree about it",
    ),
    "matches of two competitors swapped": (
        swap,
        "navigation-00{worst}-ada.wsr: seat 0 belongs to bob, not to ada",
    ),
    "a good match told twice": (
        tell_twice,
        "navigation-00{worst}-ada.wsr: is not match {worst} of the suite",
    ),
    "a shorter suite": (shorten, "results.json says suite tiny@"),
}
