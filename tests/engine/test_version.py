"""What to do with the records of other releases, as one line for a shell."""

from pathlib import Path

import pytest

from wildscav_engine import version
from wildscav_engine.version import ENGINE_VERSION, advice

RELEASE = "play it with release 0.0.9, which made it, in an environment of its own: "


def test_a_checkout_has_the_release_as_a_tag(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    checkout = tmp_path / "a clone"
    (checkout / ".git").mkdir(parents=True)
    monkeypatch.setattr(version, "CHECKOUT", checkout)
    assert advice("0.0.9") == (
        f"{RELEASE}git -C '{checkout}' worktree add {tmp_path}/wildscav-0.0.9 0.0.9 && "
        f"pip install '{tmp_path}/wildscav-0.0.9[evaluator]'"
    )


def test_a_wheel_came_from_where_the_wheels_of_releases_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(version, "CHECKOUT", tmp_path)
    assert advice("0.0.9") == f"{RELEASE}pip install 'wildscav[evaluator]==0.0.9'"


def test_no_release_made_what_another_commit_of_this_version_made() -> None:
    told = f"play it with the engine that made it ({ENGINE_VERSION}, at another commit)"
    assert advice(ENGINE_VERSION) == told


@pytest.mark.parametrize("made_by", ["", "0.1.0' && rm -rf ~ '", "0.1.0\n", "--help", "\u0663.\u0661"])
def test_a_file_puts_no_words_of_its_own_into_a_line_for_a_shell(made_by: str) -> None:
    assert "pip" not in advice(made_by)
