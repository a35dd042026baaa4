"""The wheel as somebody installs it who has no checkout: it does all that the checkout does."""

import importlib.metadata
import json
import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from collections.abc import Callable
from pathlib import Path

import pytest

from wildscav.baselines import ALL_ROUND, NAMES, baseline_folder
from wildscav_evaluator.submissions.images import DOCKERFILES, write_sdk_wheel
from wildscav_evaluator.submissions.submission import folder_digest

ROOT = Path(__file__).parents[2]
PACKAGES = (
    *("wildscav", "wildscav_engine", "wildscav_evaluator", "wildscav_inspect", "wildscav_language"),
    *("wildscav_leaderboard", "wildscav_legacy", "wildscav_server", "wildscav_stage", "wildscav_training"),
)
PARTS = ("engine", "platform", "evaluator", "leaderboard")
Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new environment with the wheel in it, outside of the repository."""
    pytest.importorskip("hatchling", reason="builds the wheel")
    folder = tmp_path_factory.mktemp("wheel")
    build = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(folder)]
    subprocess.run(build, cwd=ROOT, check=True, capture_output=True)
    (wheel,) = folder.glob("*.whl")
    environment = folder / "environment"
    venv.create(environment)
    python = environment / "bin" / "python"
    install = ("install", "--quiet", "--no-compile", "--no-deps", "--no-index", wheel)
    subprocess.run([sys.executable, "-m", "pip", "--python", python, *install], check=True)
    # What it depends on is read from the environment of the tests, so that no network is needed; the project
    # itself is not found there, since a path that is added so does not have its own .pth files read.
    code = "import sysconfig; print(sysconfig.get_path('purelib'))"
    site = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True).stdout.strip()
    Path(site, "dependencies.pth").write_text(sysconfig.get_path("purelib") + "\n")
    return environment


@pytest.fixture
def run(installed: Path, tmp_path: Path) -> Run:
    """Run a program of that environment in an empty folder."""

    def command(*arguments: object, code: int = 0) -> "subprocess.CompletedProcess[str]":
        done = subprocess.run(
            [installed / "bin" / str(arguments[0]), *map(str, arguments[1:])],
            cwd=tmp_path,
            env={**os.environ, "COLUMNS": "120", "PYTHONPATH": ""},
            capture_output=True,
            text=True,
            timeout=1200,
        )
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return command


@pytest.mark.slow
def test_every_package_comes_from_the_wheel_and_has_types(installed: Path, run: Run) -> None:
    code = "import importlib, pathlib\n"
    code += f"for name in {PACKAGES}: print(pathlib.Path(importlib.import_module(name).__file__).parent)"
    places = run("python", "-c", code).stdout.split()
    assert len(places) == len(PACKAGES)
    for place in map(Path, places):
        assert place.is_relative_to(installed)
        assert (place / "py.typed").is_file()


@pytest.mark.slow
def test_it_has_the_viewer_and_not_what_it_is_built_of(run: Run) -> None:
    code = "from wildscav_stage.viewer_files import FOLDER, viewer_addresses\n"
    code += "viewer_addresses(); print(FOLDER)"
    folder = Path(run("python", "-c", code).stdout.strip())
    assert {path.name for path in folder.iterdir()} >= {"viewer.js", "viewer.css"}
    assert "Permission is hereby granted" in (folder / "viewer.js.LEGAL.txt").read_text("utf-8")
    assert not (folder.parents[1] / "viewer").exists()


@pytest.mark.slow
def test_its_baselines_are_those_of_the_checkout(run: Run) -> None:
    code = "from wildscav.baselines import NAMES, baseline_folder\n"
    code += "from wildscav_evaluator.submissions.submission import folder_digest\n"
    code += "for name in NAMES: print(folder_digest(baseline_folder(name)))"
    assert run("python", "-c", code).stdout.split() == [
        folder_digest(baseline_folder(name)) for name in NAMES
    ]


@pytest.mark.slow
def test_it_plays_checks_and_evaluates_baselines_and_a_new_agent(run: Run, tmp_path: Path) -> None:
    short = ("--time-limit=2", "--size=40", "--sandbox=process")
    played = json.loads(run("wildscav", "play", "homing", "baseline:hunter", *short, "--json").stdout)
    assert [seat["status"] for seat in played["seats"][:2]] == ["finished", "finished"]

    run("wildscav", "init", "mine", "--from=homing")
    checked = json.loads(run("wildscav", "check", "mine", "--sandbox=process", "--json").stdout)
    assert checked["passed"]

    (tmp_path / "tiny.toml").write_text(
        'name = "tiny"\n[map]\nsize = 40\nhouses = 1\n'
        "[tracks.navigation]\nmaps = 1\nmatch = { time_limit = 2 }\n"
    )
    arguments = ("random", "homing", "mine", "--suite=tiny.toml", "--sandbox=process")
    evaluated = json.loads(run("wildscav", "evaluate", *arguments, "--json").stdout)
    assert {one["submission"] for one in evaluated["results"]["evaluations"]} == {"random", "homing", "mine"}
    assert "homing" in run("wildscav", "leaderboard").stdout


@pytest.mark.slow
def test_it_makes_a_season_to_look_at(run: Run) -> None:
    code = "from pathlib import Path\n"
    code += "from wildscav_leaderboard.hosting.demo.make import make_demo\n"
    code += "season, logins = make_demo(Path('demo').absolute(), 8000, 'process')\n"
    code += "print(len(list(season.archives.iterdir())), *(one.name for one in logins))"
    assert run("python", "-c", code).stdout.split() == ["3", "organizer", *ALL_ROUND]


@pytest.mark.slow
def test_it_builds_images_of_the_same_files(run: Run, tmp_path: Path) -> None:
    code = "from pathlib import Path; from wildscav_evaluator.submissions import images\n"
    code += "print(images.DOCKERFILES, images.write_sdk_wheel(Path()).absolute())"
    dockerfiles, sdk = map(Path, run("python", "-c", code).stdout.split())
    (tmp_path / "ours").mkdir()

    for name in ("agent.Dockerfile", "base.Dockerfile"):
        assert (dockerfiles / name).read_bytes() == (DOCKERFILES / name).read_bytes()
    assert modules_of(sdk) == modules_of(write_sdk_wheel(tmp_path / "ours"))


def modules_of(wheel: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(wheel) as files:
        return {name: files.read(name) for name in files.namelist() if name.endswith(".py")}


def test_every_package_of_the_checkout_has_types() -> None:
    folders = {path.parent.name for part in PARTS for path in (ROOT / part).glob("*/py.typed")}
    assert folders == set(PACKAGES)


def test_the_wheel_of_the_sdk_can_be_installed_and_holds_the_sdk(tmp_path: Path) -> None:
    wheel = write_sdk_wheel(tmp_path)
    target = tmp_path / "target"
    pip = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-index"]
    subprocess.run([*pip, "--target", target, wheel], check=True)
    (found,) = importlib.metadata.distributions(path=[str(target)])
    assert found.version == importlib.metadata.version("wildscav")
    needed = {text.partition(">")[0] for text in found.requires or ()}
    assert {"grpcio", "numpy", "protobuf"} <= needed
    assert "numba" not in needed
    commands = {point.name for point in found.entry_points if point.group == "wildscav.commands"}
    assert commands == {"init"}, "those of the package that it holds"
    code = "import wildscav; print(wildscav.__file__)"
    place = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(target)},
        capture_output=True,
        text=True,
    )
    assert place.stdout.startswith(str(target)), place.stderr
