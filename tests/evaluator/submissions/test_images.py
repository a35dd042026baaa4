"""Submissions as images, by each container engine; nothing is fetched."""

import asyncio
import json
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from tests.evaluator.sandbox.available import engine_named, missing
from tests.evaluator.sandbox.sandbox_runs import listening
from tests.evaluator.submissions.python_image import python_image

from wildscav_evaluator.cli.options.selection import load_submissions
from wildscav_evaluator.sandbox import SANDBOXES, Ending, Launch, SandboxError
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
Submit = Callable[..., Submission]
CODE_ALONE = "ARG BASE\nFROM ${BASE}\nCOPY . /submission\n"
COMMAND = 'CMD ["agent"]\n'


@pytest.fixture(autouse=True, params=ENGINES)
def _engine(request: pytest.FixtureRequest) -> Iterator[None]:
    with engine_named(request.param, request):
        if missing("oci"):
            pytest.skip(missing("oci"))
        before = images()
        yield
        for image in images() - before:
            call(find_engine(), "rmi", "-f", image)


def images() -> set[str]:
    listed = call(find_engine(), "images", "-q", "--filter", "reference=localhost/wildscav/*")
    return set(listed.stdout.decode().split())


def build(submission: Submission, folder: Path) -> str:
    """Build an image with the code alone, on an empty one."""
    dockerfile = folder / "own.Dockerfile"
    dockerfile.write_text(CODE_ALONE + COMMAND)
    base = bare_image(find_engine(), ("/tmp",), ())  # noqa: S108
    return build_image(submission, base=base, dockerfile=dockerfile)


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
    assert loaded.image == image_identity(name)
    assert len(loaded.digest) == 32
    with pytest.raises(SubmissionError, match="which --sandbox bubblewrap does not run"):
        with_images([loaded], "bubblewrap")


def image_identity(name: str) -> str:
    """Return what an engine calls an image that may be given another name."""
    return call(find_engine(), "image", "inspect", "--format", "{{.Id}}", name).stdout.decode().strip()


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
    dockerfile = tmp_path / "volumes.Dockerfile"
    dockerfile.write_text(f"{CODE_ALONE}VOLUME /data\n")
    base = bare_image(find_engine(), ("/tmp",), ())  # noqa: S108
    name = build_image(submission, base=base, dockerfile=dockerfile)
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
    dockerfile = tmp_path / "volumes.Dockerfile"
    dockerfile.write_text(
        f'{CODE_ALONE}VOLUME /data\nENTRYPOINT ["python3", "-c", "open(\'/data/x\', \'w\')"]\n'
    )
    name = build_image(submission, base=python_image(find_engine()), dockerfile=dockerfile)
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
    dockerfile = tmp_path / "usurper.Dockerfile"
    dockerfile.write_text(
        f"{CODE_ALONE}ENV LD_PRELOAD=/usurp.so LC_ALL=usurp\n"
        f"ENTRYPOINT {json.dumps(['python3', '-c', code])}\n"
    )
    name = build_image(submission, base=python_image(find_engine()), dockerfile=dockerfile)

    ending = run(submission, name, tmp_path)

    assert ending.last_lines[-1] == "/usurp.so False"
    assert ending.exit_code == 0


def run(submission: Submission, image: str, folder: Path) -> Ending:
    """Run an image to its end."""

    async def to_end(address: str) -> Ending:
        launch = Launch(submission.folder, "agent:Player", address, "t", folder / "log", image=image)
        agent = await SANDBOXES["oci"].start(launch)
        try:
            return await agent.ended()
        finally:
            await agent.stop()

    with listening(folder / "match.sock") as address:
        return asyncio.run(to_end(address))


@pytest.mark.parametrize(
    ("instructions", "complaint"),
    [
        ("ENTRYPOINT []\nCMD []\n", "has no command: it needs an ENTRYPOINT or a CMD"),
        (
            f'CMD ["agent"]\nENV ONE={"x" * 40_000}\nENV TWO={"x" * 40_000}\n',
            r"has 80,\d+ bytes of environment variables \(ENV\), must have at most 65,536",
        ),
    ],
)
def test_an_image_that_could_not_be_run_is_refused_when_it_is_read(
    submit: Submit, tmp_path: Path, instructions: str, complaint: str
) -> None:
    dockerfile = tmp_path / "own.Dockerfile"
    dockerfile.write_text(CODE_ALONE + instructions)
    base = bare_image(find_engine(), ("/tmp",), ())  # noqa: S108
    name = build_image(submit("useless"), base=base, dockerfile=dockerfile)

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
