"""Every entrant of a tournament has a name of its own, whatever the order in which the entrants are named."""

from dataclasses import replace
from itertools import permutations

import pytest
from tests.evaluator.sample_agents import WALKER, Submit

from wildscav.errors import UserError
from wildscav_evaluator.submissions.images import built_name
from wildscav_evaluator.submissions.submission import Submission
from wildscav_evaluator.tournaments.names import groups_of, with_unique_names


@pytest.fixture
def walker(submit: Submit) -> Submission:
    return submit("walker", WALKER)


def version_of(submission: Submission, version: str, digest: str) -> Submission:
    manifest = submission.manifest.model_copy(update={"version": version})
    return replace(submission, manifest=manifest, digest=digest * 32)


def names(*submissions: Submission, meet_own: bool = False) -> list[str]:
    return [one.name for one in with_unique_names(submissions, meet_own=meet_own)]


def test_a_submission_that_is_entered_once_keeps_its_name(walker: Submission) -> None:
    assert names(walker) == ["walker"]


def test_two_versions_of_a_submission_are_told_apart_by_their_versions(walker: Submission) -> None:
    assert names(walker, version_of(walker, "2.0", "a")) == ["walker@1.0.0", "walker@2.0"]


def test_other_files_with_the_same_version_are_told_apart_by_their_digests(walker: Submission) -> None:
    one, other = version_of(walker, "1", "a"), version_of(walker, "1", "b")
    assert names(one, other) == ["walker@1#aaaaaaaa", "walker@1#bbbbbbbb"]


def test_the_same_files_are_entered_twice_only_if_they_may_meet(walker: Submission) -> None:
    with pytest.raises(UserError, match="'walker' is entered twice with the same files; --meet-own"):
        names(walker, walker)
    assert names(walker, walker, meet_own=True) == ["walker@1.0.0#1", "walker@1.0.0#2"]


def test_names_do_not_depend_on_the_order_of_the_entrants(walker: Submission) -> None:
    entries = [walker, version_of(walker, "1.0.0", "c"), version_of(walker, "3", "d")]
    found = [with_unique_names(order, meet_own=False) for order in permutations(entries)]
    assert all(one == found[0] for one in found)


def test_entries_of_one_submission_form_a_group() -> None:
    assert groups_of(["bob", "robot:fighter", "walker@1#aa", "walker@1#bb", "walker@2"]) == [0, 1, 2, 2, 2]


def test_an_entry_runs_in_the_image_that_was_built_of_its_submission(walker: Submission) -> None:
    first, _ = with_unique_names([walker, version_of(walker, "2", "a")], meet_own=False)
    assert first.name != walker.name
    assert built_name(first) == built_name(walker)
