"""Whoever removes a name that others build on notices it here."""

import json

from tests.releases.public_names import COMMAND, FILE, names_now


def test_the_public_names_are_those_of_the_list() -> None:
    listed: dict[str, list[str]] = json.loads(FILE.read_text("utf-8"))
    now = names_now()
    for part in sorted({*now, *listed}):
        before, after = set(listed.get(part, ())), set(now.get(part, ()))
        assert not before - after, (
            f"{part}: others may use these names; they work for one more release, and warn"
        )
        assert not after - before, f"{part}: these names are new; list them with: {COMMAND}"
