"""Where an evaluation goes if nobody says where, and what it is compared with."""

from pathlib import Path

import pytest
from tests.evaluator.results_by_hand import RESULTS, evaluation, identity_of

from wildscav_evaluator.output.identity import Identity, write_identity
from wildscav_evaluator.output.numbered_folders import own_folder
from wildscav_evaluator.output.results import Results, write_results
from wildscav_evaluator.scores.compare import changes_since_last


def identity(*names: str, digest: str = "1") -> Identity:
    return identity_of(*names, track="royale", digest=digest)


def begin(parent: Path, one: Identity, *, fresh: bool = False) -> str:
    folder = own_folder(parent, one, fresh=fresh)
    folder.mkdir(parents=True, exist_ok=True)
    write_identity(one, folder)
    return folder.name


def test_each_other_evaluation_gets_the_next_number_and_the_same_one_its_own(tmp_path: Path) -> None:
    parent = tmp_path / "out" / "evaluations"
    first, edited = identity("mine"), identity("mine", digest="2")
    assert begin(parent, first) == "0001-mine"
    assert begin(parent, first) == "0001-mine", "it is continued"
    assert begin(parent, edited) == "0002-mine"
    assert begin(parent, first) == "0001-mine", "an edit undone finds its evaluation again"
    assert begin(parent, first, fresh=True) == "0003-mine"
    assert begin(parent, identity("mine", "homing")) == "0004-mine-homing"
    assert begin(parent, identity("mine", "homing", "hunter")) == "0005-mine-and-2-more"


def test_what_else_lies_there_does_no_harm(tmp_path: Path) -> None:
    (tmp_path / "notes").mkdir()
    (tmp_path / "0007-a file").touch()
    (tmp_path / "9999-old").mkdir()
    (tmp_path / "9999-old" / "evaluation.json").write_text('{"format": 0}')
    assert begin(tmp_path, identity("mine")) == "10000-mine"
    assert begin(tmp_path, identity("mine", digest="2")) == "10001-mine"


def kept(parent: Path, number: int, values: tuple[float, ...], *, digest: str, **changed: object) -> Results:
    """An evaluation that was played to its end."""
    one = evaluation("mine", values=values).model_copy(update={"digest": digest})
    results = RESULTS.model_copy(update={"evaluations": (one,), **changed})
    folder = parent / f"{number:04}-mine"
    folder.mkdir(parents=True)
    write_identity(identity("mine", digest=digest), folder)
    write_results(results, folder)
    return results


def test_the_last_evaluation_of_other_files_on_the_same_matches_is_compared_with(tmp_path: Path) -> None:
    kept(tmp_path, 1, (1.0, 1.0), digest="1")
    kept(tmp_path, 2, (2.0, 4.0), digest="2")
    kept(tmp_path, 3, (9.0, 9.0), digest="3", seed=1)
    kept(tmp_path, 4, (9.0, 9.0), digest="4", sandbox="oci")
    (tmp_path / "0005-mine").mkdir()
    write_identity(identity("mine", digest="5"), tmp_path / "0005-mine")  # it was interrupted
    kept(tmp_path, 6, (5.0, 5.0), digest="6")
    now = kept(tmp_path, 7, (5.0, 5.0), digest="6")

    (since,) = changes_since_last(now, tmp_path / "0007-mine")

    assert (since.folder, since.version) == ("0002-mine", "1.0.0")
    assert since.comparison.differences[0].difference == pytest.approx(2.0)
    assert changes_since_last(now, tmp_path / "season") == ()


def test_a_first_evaluation_is_compared_with_nothing(tmp_path: Path) -> None:
    assert changes_since_last(kept(tmp_path, 1, (1.0,), digest="1"), tmp_path / "0001-mine") == ()
