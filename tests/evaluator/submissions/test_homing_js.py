"""The agent in JavaScript: made from the proto alone, it plays in every sandbox, about as well as homing."""

import json
import shutil
import subprocess
import tomllib
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Command
from tests.evaluator.small_matches import need

REPOSITORY = Path(__file__).parents[3]
AGENT = REPOSITORY / "submissions" / "homing-js"
PROTO = REPOSITORY / "platform" / "wildscav" / "proto" / "match.proto"
RULINGS = Path(__file__).parent / "homing_js.test.mjs"


def run(*command: str, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run a program of Node.js; skipped where there is none."""
    if shutil.which(command[0]) is None:
        pytest.skip(f"there is no {command[0]}")
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The agent with its packages, as its README says; skipped where they cannot be had."""
    ignored = shutil.ignore_patterns("node_modules")
    folder = shutil.copytree(AGENT, tmp_path_factory.mktemp("javascript") / "homing-js", ignore=ignored)
    done = run("npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund", folder=folder)
    if done.returncode != 0:
        pytest.skip(f"npm cannot install the packages: {done.stderr.strip().splitlines()[-1]}")
    return folder


def test_it_has_the_protocol_as_it_is() -> None:
    assert (AGENT / "match.proto").read_bytes() == PROTO.read_bytes(), "`make proto` copies it"


def test_its_package_is_its_submission() -> None:
    manifest = tomllib.loads((AGENT / "submission.toml").read_text("utf-8"))
    package = json.loads((AGENT / "package.json").read_text("utf-8"))

    assert (package["name"], package["version"]) == (manifest["name"], manifest["version"])
    name, version = repr(package["name"]), repr(package["version"])
    assert (
        f"playSeat(new HomingJs(), {name}, {version})".replace("'", '"') in (AGENT / "agent.js").read_text()
    )


def test_its_packages_are_pinned_by_digest_and_come_from_the_users_own_registry() -> None:
    lock = json.loads((AGENT / "package-lock.json").read_text("utf-8"))
    packages = {name: package for name, package in lock["packages"].items() if name}

    assert "node_modules/@grpc/grpc-js" in packages
    for name, package in packages.items():
        assert package["integrity"].startswith("sha512-"), name
        assert "resolved" not in package, f"{name}: lock it with --omit-lockfile-registry-resolved"


def test_it_walks_and_decodes_as_its_rulings_say() -> None:
    done = run("node", "--test", str(RULINGS), folder=REPOSITORY)

    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.slow
def test_without_a_seat_it_says_how_to_start_it(built: Path) -> None:
    done = run("env", "-u", "WILDSCAV_ADDRESS", "node", "agent.js", folder=built)

    assert done.returncode == 1
    assert done.stderr == (
        "WILDSCAV_ADDRESS and WILDSCAV_TOKEN are not set: start the agent with `wildscav play`\n"
    )


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
@pytest.mark.parametrize("sandbox", ["bubblewrap", "oci"])
def test_it_plays_to_the_end_and_reaches_the_target(
    wildscav: Command, built: Path, sandbox: str, tmp_path: Path
) -> None:
    need(sandbox)

    done = wildscav("play", built, "--sandbox", sandbox, "--logs", tmp_path / "logs")

    assert done.returncode == 0, done.stderr
    (row,) = (line for line in done.stdout.splitlines() if line.split()[1:2] == ["homing-js"])
    assert "100%" in row
    assert "finished" in row


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_it_passes_every_check(wildscav: Command, built: Path, tmp_path: Path) -> None:
    done = wildscav("check", built, "--sandbox=process", "--logs", tmp_path / "logs")

    assert "homing-js may be submitted" in done.stdout, done.stdout + done.stderr


@pytest.mark.slow
@pytest.mark.usefixtures("compiled")
def test_it_reaches_nearly_all_targets_as_homing_does(wildscav: Command, built: Path, tmp_path: Path) -> None:
    options = ("--track=navigation", "--suite=quick", "--seed=1", "--replays=none", "--sandbox=process")

    done = wildscav("evaluate", built, *options, "--out", tmp_path / "out")

    assert done.returncode == 0, done.stderr
    results = json.loads((tmp_path / "out" / "results.json").read_text("utf-8"))
    (row,) = results["evaluations"]
    assert row["summary"]["success"]["mean"] >= 0.8  # all but one of five
