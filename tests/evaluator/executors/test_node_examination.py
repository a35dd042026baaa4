"""A node gets work only if it has the same Wildscav; what differs is said in one line."""

import pytest

from wildscav_evaluator.executors.cluster.node_examination import code_digest, examine, mismatch
from wildscav_evaluator.output.results import CURRENT_VERSIONS

VERSIONS = CURRENT_VERSIONS.model_dump()


@pytest.mark.parametrize(
    ("versions", "code", "difference"),
    [
        (VERSIONS, code_digest(), ""),
        (
            VERSIONS,
            "0" * 16,
            "its Wildscav has the same version, but other code: install the same files there",
        ),
        (
            {**VERSIONS, "simulation": 999},
            "0" * 16,  # of course
            f"it has another version of Wildscav: simulation 999 instead of {VERSIONS['simulation']}",
        ),
        (
            {name: version for name, version in VERSIONS.items() if name != "simulation"},
            code_digest(),
            f"it has another version of Wildscav: simulation None instead of {VERSIONS['simulation']}",
        ),
    ],
)
def test_differences(versions: dict[str, object], code: str, difference: str) -> None:
    assert mismatch({"versions": versions, "code": code}) == difference


def test_this_machine_may_play_with_itself_but_lacks_a_sandbox_that_nobody_knows() -> None:
    found = examine(["process", "vault"], [])

    assert mismatch(found) == ""
    assert found["sandboxes"]["vault"] == "there is no sandbox vault there"
    assert found["images"] == {}
