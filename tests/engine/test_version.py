"""What to do with the records of other releases, as one line for a shell."""

from pathlib import Path

import pytest

from wildscav_engine import version
from wildscav_engine.version import ENGINE_VERSION, advice

RELEASE = "play it with release 0.0.9, which made it, in an environment of its own: pip install "


@pytest.mark.parametrize(
    ("inside", "line"),
    [
        (".git", "'wildscav[evaluator] @ git+file://{folder}@0.0.9'"),  # a checkout has the release as a tag
        ("wildscav", "'wildscav[evaluator]==0.0.9'"),  # a wheel came from where other releases are
    ],
)
def test_a_release_is_installed_from_where_this_one_came_from(
    inside: str, line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / inside).mkdir()
    monkeypatch.setattr(version, "CHECKOUT", tmp_path)
    assert advice("0.0.9") == RELEASE + line.format(folder=tmp_path)


def test_no_release_made_what_another_commit_of_this_version_made() -> None:
    assert (
        advice(ENGINE_VERSION)
        == f"play it with the engine that made it ({ENGINE_VERSION}, at another commit)"
    )


@pytest.mark.parametrize("made_by", ["", "0.1.0' && rm -rf ~ '", "0.1.0\n", "--help", "\u0663.\u0661"])
def test_a_file_puts_no_words_of_its_own_into_a_line_for_a_shell(made_by: str) -> None:
    assert "pip" not in advice(made_by)
