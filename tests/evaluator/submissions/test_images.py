"""Submissions as images, by each container engine; nothing is fetched."""

import json
from collections.abc import Iterator
from pathlib import Path

import pytest
from tests.evaluator.sample_agents import Submit
from tests.evaluator.sandbox.available import engine_named
from tests.evaluator.sandbox.sandbox_runs import run_agent
from tests.evaluator.small_matches import need
from tests.evaluator.submissions.python_image import python_image

from wildscav_evaluator.cli.options.selection import load_submissions
from wildscav_evaluator.sandbox import DEFAULT_LIMITS, SANDBOXES, Ending, SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import ENGINES, bare_image, call, find_engine
from wildscav_evaluator.submissions.images import (
    IMAGE,
    _manifest_in,
    build_image,
    built_name,
    load_image,
    with_images,
)
from wildscav_evaluator.submissions.submission import Submission, load_submission
from wildscav_server.hosting.manifest import SubmissionError

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", autouse=True, params=ENGINES)
def _engine(request: pytest.FixtureRequest) -> Iterator[None]:
    with engine_named(request.param, request):
        need("oci")
        before = images()
        yield
        for image in images() - before:
            call(find_engine(), "rmi", "-f", image)


def images() -> set[str]:
    listed = call(find_engine(), "images", "-q", "--filter", "reference=localhost/wildscav/*")
    return set(listed.stdout.decode().split())


def build(submission: Submission, folder: Path, instructions: str = 'CMD ["agent"]', base: str = "") -> str:
    """Build an image with the code and some instructions alone, on an empty one or on another."""
    dockerfile = folder / "own.Dockerfile"
    dockerfile.write_text(f"ARG BASE\nFROM ${{BASE}}\nCOPY . /submission\n{instructions}\n")
    base = base or bare_image(find_engine(), ("/tmp",), ())  # noqa: S108
    return build_image(submission, base=base, dockerfile=dockerfile)


def run(submission: Submission, image: str, folder: Path) -> Ending:
    return run_agent(SANDBOXES["oci"], submission, folder, DEFAULT_LIMITS, image=image)[0]


def test_a_built_submission_runs_as_its_image_in_containers_alone(submit: Submit, tmp_path: Path) -> None:
    submission = submit("built")

    name = build(submission, tmp_path)

    assert name == built_name(submission)
    assert with_images([submission], "oci")[0].image == name
    assert with_images([submission], "bubblewrap")[0].image is None


def test_what_needs_packages_is_built_first_and_again_when_it_changes(submit: Submit, tmp_path: Path) -> None:
    folder = submit("needy").folder
    (folder / "requirements.txt").write_text("numpy\n")
    with pytest.raises(SubmissionError, match="no image of its present files has been built"):
        with_images([load_submission(folder)], "oci")

    build(load_submission(folder), tmp_path)
    assert with_images([load_submission(folder)], "oci")[0].image is not None

    (folder / "agent.py").write_text("print('changed')")
    with pytest.raises(SubmissionError, match=f"wildscav build {folder}"):
        with_images([load_submission(folder)], "oci")


def test_a_prebuilt_image_tells_its_own_manifest(submit: Submit, tmp_path: Path) -> None:
    name = build(submit("brought"), tmp_path)

    (loaded,) = load_submissions([Path(IMAGE + name)])

    assert loaded.name == "brought"
    # What an engine calls an image that may be given another name.
    told = call(find_engine(), "image", "inspect", "--format", "{{.Id}}", name)
    assert loaded.image == told.stdout.decode().strip()
    assert len(loaded.digest) == 32
    with pytest.raises(SubmissionError, match="which --sandbox bubblewrap does not run"):
        with_images([loaded], "bubblewrap")


def test_an_image_that_is_not_there_or_has_no_manifest_is_refused() -> None:
    with pytest.raises(SubmissionError, match="there is no image localhost/wildscav/nobody on this machine"):
        load_image("localhost/wildscav/nobody")
    with pytest.raises(SubmissionError, match=r"has no /submission/submission\.toml"):
        _manifest_in(find_engine(), bare_image(find_engine(), ("/tmp", "/submission"), ()), "empty")  # noqa: S108


def test_a_build_that_fails_is_told(submit: Submit, tmp_path: Path) -> None:
    broken = tmp_path / "broken.Dockerfile"
    broken.write_text("FROM scratch\nCOPY no-such-file /\n")

    with pytest.raises(SandboxError, match="could not be built"):
        build_image(submit("broken"), base="scratch", dockerfile=broken)


def test_an_image_with_volumes_is_refused_and_its_manifest_read_without_leaving_one(
    submit: Submit, tmp_path: Path
) -> None:
    """An engine keeps what is written to a volume on the machine's disk, without any limit."""
    submission = submit("hoarder")
    name = build(submission, tmp_path, "VOLUME /data")
    before = volumes()

    with pytest.raises(SubmissionError, match=r"has volumes \(/data\).*build it without VOLUME"):
        load_image(name)
    with pytest.raises(SubmissionError, match=r"has volumes \(/data\)"):
        with_images([submission], "oci")
    _manifest_in(find_engine(), name, name)

    assert volumes() == before


def test_whoever_starts_an_image_with_volumes_gets_no_writable_disk(submit: Submit, tmp_path: Path) -> None:
    if find_engine().name == "docker":
        pytest.skip("Docker has no option for it: such images are refused before")
    submission = submit("hoarder")
    instructions = 'VOLUME /data\nENTRYPOINT ["python3", "-c", "open(\'/data/x\', \'w\')"]'
    name = build(submission, tmp_path, instructions, python_image(find_engine()))
    before = volumes()

    ending = run(submission, name, tmp_path)

    assert "/data/x" in ending.last_words
    assert ending.exit_code == 1
    assert volumes() == before


def test_variables_of_an_image_do_not_reach_what_keeps_its_wall_clock(submit: Submit, tmp_path: Path) -> None:
    """A library that the loader is told to load first could take the place of the first process."""
    if find_engine().name == "podman":
        pytest.skip("Podman's monitor keeps the wall clock, outside of the container")
    submission = submit("usurper")
    code = "import os; print(os.environ['LD_PRELOAD'], b'usurp' in open('/proc/1/environ', 'rb').read())"
    variables, start = "ENV LD_PRELOAD=/usurp.so LC_ALL=usurp", json.dumps(["python3", "-c", code])
    name = build(submission, tmp_path, f"{variables}\nENTRYPOINT {start}", python_image(find_engine()))

    ending = run(submission, name, tmp_path)

    assert "/usurp.so False" in ending.last_lines  # what the loader says may come before or after
    assert ending.exit_code == 0


@pytest.mark.parametrize(
    ("instructions", "complaint"),
    [
        ("ENTRYPOINT []\nCMD []", "has no command: it needs an ENTRYPOINT or a CMD"),
        (
            f'CMD ["agent"]\nENV ONE={"x" * 40_000}\nENV TWO={"x" * 40_000}',
            r"has 80,\d+ bytes of environment variables \(ENV\), must have at most 65,536",
        ),
    ],
)
def test_an_image_that_could_not_be_run_is_refused_when_it_is_read(
    submit: Submit, tmp_path: Path, instructions: str, complaint: str
) -> None:
    name = build(submit("useless"), tmp_path, instructions)

    with pytest.raises(SubmissionError, match=complaint):
        load_image(name)


def volumes() -> set[str]:
    return set(call(find_engine(), "volume", "ls", "-q").stdout.decode().split())


def test_a_manifest_that_never_ends_is_refused(submit: Submit, tmp_path: Path) -> None:
    submission = submit("long")
    with (submission.folder / "submission.toml").open("a") as file:
        file.write("# more\n" * 100_000)

    with pytest.raises(SubmissionError, match=r"submission\.toml has more than 16,384 bytes"):
        load_image(build(submission, tmp_path))
