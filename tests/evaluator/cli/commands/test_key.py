"""`wildscav season key`, and the options that take keys."""

import shutil
import stat
import subprocess
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import WALKER, Command, Submit

from wildscav.errors import UserError
from wildscav_evaluator.cli.options.signing import signing_key
from wildscav_evaluator.ledger.keys import is_signed, new_key, read_key, read_public


def nobody() -> str:
    raise AssertionError("no passphrase is needed")


def test_a_new_key_is_for_its_owner_alone_and_never_overwritten(wildscav: Command, tmp_path: Path) -> None:
    file = tmp_path / "season.key"

    made = wildscav("season", "key", "new", file)
    shown = wildscav("season", "key", "public", file)

    assert made.returncode == shown.returncode == 0, made.stderr + shown.stderr
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    assert made.stdout == shown.stdout
    assert read_public(made.stdout.strip()) == read_key(file, nobody).public
    before = file.read_bytes()
    again = wildscav("season", "key", "new", file)
    assert (again.returncode, file.read_bytes()) == (2, before)
    assert again.stderr == f"wildscav: {file} exists already: a key is never overwritten\n"


def test_a_signature_is_that_of_its_key_and_content_alone(tmp_path: Path) -> None:
    key, other = new_key(tmp_path / "one"), new_key(tmp_path / "other")
    signature = key.sign(b"ada wins")

    assert is_signed(b"ada wins", signature, key.public)
    assert not is_signed(b"bob wins", signature, key.public)
    assert not is_signed(b"ada wins", signature, other.public)
    assert not is_signed(b"ada wins", "no signature", key.public)
    assert not is_signed(b"ada wins", signature, "no key")


def test_a_key_with_a_passphrase_is_of_no_use_without_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "season.key"
    public = new_key(file, "correct horse").public

    assert b"ENCRYPTED" in file.read_bytes()
    assert read_key(file, lambda: "correct horse").public == public
    with pytest.raises(UserError, match="that is not the passphrase of"):
        read_key(file, lambda: "battery staple")

    monkeypatch.setenv("WILDSCAV_KEY_PASSPHRASE", "correct horse")
    found = signing_key(file, tmp_path / "out", ())
    assert found is not None
    assert found.public == public


@pytest.mark.parametrize("passphrase", ["", "x" * 1024, "\udcff"])
def test_a_passphrase_that_cannot_be_used_is_refused_in_a_line(tmp_path: Path, passphrase: str) -> None:
    with pytest.raises(UserError, match="the passphrase cannot be used: ") as refused:
        new_key(tmp_path / "season.key", passphrase)

    assert refused.value.exit_code == 2
    assert not (tmp_path / "season.key").exists()


def test_without_a_terminal_the_passphrase_must_be_in_the_environment(
    wildscav: Command, tmp_path: Path
) -> None:
    new_key(tmp_path / "season.key", "correct horse")

    done = wildscav("season", "key", "public", tmp_path / "season.key")

    assert done.returncode == 2
    assert "set WILDSCAV_KEY_PASSPHRASE" in done.stderr


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is not a private key in PEM"),
        (b"-----BEGIN PRIVATE KEY-----\nAAAA\n-----END PRIVATE KEY-----\n", "is not a private key in PEM"),
        (b"x" * 10_000, "has more than 8192 bytes"),
    ],
)
def test_what_is_no_key_is_one_clear_line(tmp_path: Path, content: bytes, says: str) -> None:
    file = tmp_path / "season.key"
    file.write_bytes(content)
    file.chmod(0o600)

    with pytest.raises(UserError, match=says) as refused:
        read_key(file, nobody)
    assert refused.value.exit_code == 2
    with pytest.raises(UserError, match=r"No such file"):
        read_key(tmp_path / "missing", nobody)


def test_a_key_that_others_can_read_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "season.key"
    new_key(file)
    file.chmod(0o640)

    with pytest.raises(UserError, match="can be read by others: `chmod 600"):
        read_key(file, nobody)


def test_a_public_key_may_be_told_in_digits_or_as_a_file(tmp_path: Path) -> None:
    public = new_key(tmp_path / "season.key").public
    (tmp_path / "season.pub").write_text(f"{public}\n")

    assert read_public(public) == read_public(public.upper()) == public
    assert read_public(str(tmp_path / "season.pub")) == public
    with pytest.raises(UserError, match="is a private key, which nobody else may see"):
        read_public(str(tmp_path / "season.key"))
    with pytest.raises(UserError, match="the public key 1234 cannot be read"):
        read_public("1234")


def test_openssl_reads_our_keys(tmp_path: Path) -> None:
    if shutil.which("openssl") is None:
        pytest.skip("openssl is not installed")
    public = new_key(tmp_path / "season.key").public

    command = ["openssl", "pkey", "-in", tmp_path / "season.key", "-pubout", "-out", tmp_path / "season.pem"]
    subprocess.run(command, check=True)

    assert read_public(str(tmp_path / "season.pem")) == public


def test_a_key_may_not_lie_where_agents_or_readers_of_the_results_see_it(
    submit: Submit, tmp_path: Path
) -> None:
    walker, out = submit("walker", WALKER), tmp_path / "out"
    out.mkdir()

    for folder in (walker.folder, out):
        new_key(folder / "season.key")
        with pytest.raises(UserError, match="where others can see it: move it"):
            signing_key(folder / "season.key", out, (walker,))
