"""The settings of a model: from a file and the environment, and checked."""

from pathlib import Path

import pytest

from wildscav.errors import UserError
from wildscav.harness.settings import ModelSettings, read_settings


def test_a_file_and_the_environment_give_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "model.toml"
    file.write_text(
        'name = "small"\nwindow = 4\nlog = "out/log.jsonl"\n[request]\ntemperature = 0.5\n', "utf-8"
    )
    monkeypatch.setenv("OPENAI_BASE_URL", "http://127.0.0.1:1/v1")
    monkeypatch.setenv("OPENAI_API_KEY", "sk-secret")

    settings = read_settings(file)

    assert (settings.name, settings.window, settings.request) == ("small", 4, {"temperature": 0.5})
    assert (settings.url, settings.key) == ("http://127.0.0.1:1/v1", "sk-secret")
    assert settings.log == Path("out/log.jsonl")
    assert "secret" not in repr(settings)
    monkeypatch.setenv("WILDSCAV_MODEL", "unix:/run/model.sock")
    assert read_settings(file).url == "unix:/run/model.sock"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("windows = 4", "have no 'windows'; they have url, name"),
        ("window = 0", "window is 0, must be 1 to 1,000"),
        ("window = 1.5", "window is 1.5"),
        ("tokens = true", "tokens is True"),
        ("timeout = nan", "timeout is nan"),
        ("name = 3", "name must be a text"),
        ("pictures = 1", "pictures must be true or false"),
        ("log = 3", "log is 3, must be the name of a file"),
        (r'key = "sk-1\n"', "key has characters that no header may have$"),
        ('url = "ftp://x"', "must begin with http://"),
        ("request = 3", "request must be a table"),
        ("request = { stream = true }", "request has stream"),
        ("window", "not valid TOML"),
    ],
)
def test_what_is_not_allowed_is_refused(text: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "model.toml").write_text(text, "utf-8")

    with pytest.raises(UserError, match=said):
        read_settings(tmp_path / "model.toml")


def test_a_file_that_is_missing_is_named(tmp_path: Path) -> None:
    with pytest.raises(UserError, match=r"missing\.toml"):
        read_settings(tmp_path / "missing.toml")


def test_a_budget_may_be_missing() -> None:
    assert ModelSettings().tokens is None
