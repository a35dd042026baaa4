"""Submissions as container images: built from a folder, or prebuilt."""

import base64
import contextlib
import functools
import hashlib
import io
import os
import secrets
import subprocess
import sys
import tarfile
import zipfile
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from email.message import Message
from importlib.metadata import distribution
from pathlib import Path

import wildscav
from wildscav.errors import UserError
from wildscav.sdk.submission_folder import MANIFEST
from wildscav_evaluator.cache import cache_folder
from wildscav_evaluator.sandbox import SANDBOXES
from wildscav_evaluator.sandbox.base import SandboxError
from wildscav_evaluator.sandbox.containers.container_engine import (
    ContainerEngine,
    call,
    find_engine,
    image_settings,
    last_line,
)
from wildscav_evaluator.sandbox.containers.left_containers import (
    enter_container,
    release_container,
    removal,
)
from wildscav_evaluator.submission_files import copy_files
from wildscav_evaluator.submissions.submission import Submission
from wildscav_server import leftovers
from wildscav_server.hosting.manifest import LARGEST_MANIFEST, SubmissionError, read_manifest

KEPT_LINES = 20  # of what a failing build prints
IMAGE = "image:"  # before the name of a prebuilt image, where a command takes a submission
REQUIREMENTS = "requirements.txt"
BASE = "localhost/wildscav/agent-base"
PYTHON = "WILDSCAV_PYTHON_IMAGE"  # the environment variable that names the base's image with Python
PACKAGE = Path(__file__).parents[1]
# An installed wheel has them in the package; a checkout has them in its root folder.
DOCKERFILES = next(
    (place for place in (PACKAGE / "docker", PACKAGE.parents[1] / "docker") if place.is_dir()),
    PACKAGE / "docker",
)
LARGEST_VARIABLES = 65_536  # bytes, names included; Linux accepts 128 KiB in one and 2 MiB in all
LARGEST_HEADERS = 16_384  # bytes of a tar archive with one file, without the file's content
TAG = "py3-none-any"
ENTRY_POINTS = b"""[console_scripts]
wildscav = wildscav.cli.main:main

[wildscav.commands]
init = wildscav.cli.init:init
"""
LEFT_OUT = {"__pycache__", "submissions"}  # an installed wheel has the baselines in the package


class BuildError(SandboxError):
    """An image could not be built: why, and the last lines that the engine printed."""

    def __init__(self, message: str, last_lines: tuple[str, ...] = ()) -> None:
        super().__init__(message)
        self.last_lines = last_lines


@functools.cache
def sdk_digest() -> str:
    """Return the digest of the SDK that is installed in images: the package wildscav, and nothing else."""
    digest = hashlib.blake2b(digest_size=4)
    for name, content in _sdk_files().items():
        digest.update(name.encode() + content)
    return digest.hexdigest()


def _sdk_files() -> dict[str, bytes]:
    """Return the content of the SDK's files, by their paths in its wheel."""
    package = Path(wildscav.__file__).parent
    files = sorted(path for path in package.rglob("*") if path.is_file())
    return {
        path.relative_to(package.parent).as_posix(): path.read_bytes()
        for path in files
        if not LEFT_OUT.intersection(path.relative_to(package).parts)
    }


def base_name(python: str) -> str:
    """Return the name of the image with the SDK, which depends on the SDK and its Python."""
    suffix = f"-{hashlib.blake2b(python.encode(), digest_size=4).hexdigest()}" if python else ""
    return f"{BASE}:{wildscav.__version__}-{sdk_digest()}{suffix}"


def built_name(submission: Submission) -> str:
    """Return the name of a submission's image, which depends on its content and the SDK."""
    return f"localhost/wildscav/{submission.manifest.name}:{submission.digest[:16]}-{sdk_digest()}"


def build_image(
    submission: Submission,
    *,
    base: str | None = None,
    options: Sequence[str] = (),
    dockerfile: Path | None = None,
) -> str:
    """Build the image of a submission that is a folder, and return its name. This installs its packages.

    It is built on ``base``, by default the SDK's own image, which is built if it does not exist. BuildError
    if the build failed; SandboxError if there is no engine, or what all images are built on cannot be built.
    """
    engine = find_engine()
    if base is None:
        python = os.environ.get(PYTHON, "")
        base = base_name(python)
        if not _exists(engine, base):
            own = ["--build-arg", f"PYTHON={python}"] if python else []
            with leftovers.temporary_folder("build-") as folder:
                write_sdk_wheel(folder)
                try:
                    _build(engine, base, folder, _dockerfile("base.Dockerfile"), [*own, *options])
                except BuildError as error:
                    raise SandboxError(str(error)) from None  # no submission is to blame
    name = built_name(submission)
    with leftovers.temporary_folder("build-") as folder:
        context = copy_files(submission.folder, folder / "context")
        file = dockerfile or _dockerfile("agent.Dockerfile")
        _build(engine, name, context, file, ["--build-arg", f"BASE={base}", *options])
    return name


def _dockerfile(name: str) -> Path:
    path = DOCKERFILES / name
    if not path.is_file():
        raise SandboxError(f"there is no {path}: install Wildscav again, or name a --dockerfile and a --base")
    return path


def _build(
    engine: ContainerEngine, name: str, context: Path, dockerfile: Path, options: Sequence[str]
) -> None:
    command = [*engine.command, "build", "--file", str(dockerfile), "--tag", name, *options]
    last_lines = deque(["no message"], KEPT_LINES)
    with subprocess.Popen(
        [*command, str(context)], stderr=subprocess.PIPE, encoding="utf-8", errors="replace"
    ) as process:
        for line in process.stderr or ():
            sys.stderr.write(line)
            last_lines.extend(filter(None, [line.strip()]))
    if process.returncode != 0:
        raise BuildError(f"{name} could not be built: {last_lines[-1]}", tuple(last_lines))


def _exists(engine: ContainerEngine, name: str) -> bool:
    return call(engine, "image", "inspect", name).returncode == 0


def with_images(submissions: Sequence[Submission], sandbox: str) -> tuple[Submission, ...]:
    """Return submissions as a sandbox runs them: for containers, with the images that were built.

    SubmissionError if one needs packages and was not built, or is an image and the sandbox runs none.
    """
    return tuple(_with_image(submission, sandbox) for submission in submissions)


def _with_image(submission: Submission, sandbox: str) -> Submission:
    if not SANDBOXES[sandbox].runs_images:
        if submission.image is not None:
            raise SubmissionError(f"{submission.name} is an image, which --sandbox {sandbox} does not run")
        return submission
    if submission.image is not None:
        return submission
    name = built_name(submission)
    if _exists(find_engine(), name):
        _check_settings(find_engine(), name)
        return replace(submission, image=name)
    if lacks_packages(submission):
        raise SubmissionError(
            f"{submission.folder} has a {REQUIREMENTS}, and no image of its present files has been built: "
            f"run wildscav build {submission.folder}"
        )
    return submission


def image_problem(name: str) -> str:
    """Return why an image cannot be used on this machine, in one line; an empty text if it can."""
    try:
        engine = find_engine()
        if not _exists(engine, name):
            return f"it has no image {name}"
        _check_settings(engine, name)
    except UserError as error:
        return str(error)
    return ""


def lacks_packages(submission: Submission) -> bool:
    """Return whether a submission requires packages and is not an image that has them."""
    return submission.image is None and (submission.folder / REQUIREMENTS).is_file()


def missing_packages(submission: Submission) -> list[str]:
    """Return the lines of a submission's requirements that this machine's Python does not fulfil."""
    from importlib.metadata import PackageNotFoundError, version

    from packaging.requirements import InvalidRequirement, Requirement

    missing = []
    with (submission.folder / REQUIREMENTS).open(encoding="utf-8", errors="replace") as file:
        lines = file.read(LARGEST_MANIFEST).splitlines()
    for wanted in filter(None, (line.partition("#")[0].strip() for line in lines)):
        try:
            need = Requirement(wanted)
            if need.marker and not need.marker.evaluate():
                continue
            if need.specifier.contains(version(need.name), prereleases=True):
                continue
        except (InvalidRequirement, PackageNotFoundError):  # such as an option of pip
            pass
        missing.append(wanted)
    return missing


def load_image(reference: str) -> Submission:
    """Return a prebuilt image as a submission, by its ``/submission/submission.toml``. None of its code runs.

    SubmissionError if there is no such image here, or it has no valid manifest.
    """
    engine = find_engine()
    answer = call(engine, "image", "inspect", "--format", "{{.Id}}", reference)
    if answer.returncode != 0 or reference.startswith("-"):
        raise SubmissionError(f"there is no image {reference} on this machine ({last_line(answer.stderr)})")
    identity = answer.stdout.decode("ascii").strip()
    # Its identity is used from here on, because its name may be given to another image at any time.
    _check_settings(engine, identity, reference)
    digest = identity.removeprefix("sha256:")[:32]
    folder = cache_folder("images") / digest
    folder.mkdir(parents=True, exist_ok=True)
    (folder / MANIFEST).write_bytes(_manifest_in(engine, identity, reference))
    return Submission(folder, read_manifest(folder / MANIFEST), digest, image=identity)


def _check_settings(engine: ContainerEngine, image: str, reference: str | None = None) -> None:
    """Refuse an image that cannot be run, or that needs what agents do not get.

    An engine would save what an agent writes to a volume on this machine's disk.
    """
    settings, name = image_settings(engine, image), f"image {reference or image}"
    if volumes := sorted(settings.get("Volumes") or ()):
        raise SubmissionError(
            f"{name} has volumes ({', '.join(volumes)}), which agents may not have: "
            "build it without VOLUME; what it writes belongs into /tmp"
        )
    if not (settings.get("Entrypoint") or settings.get("Cmd")):
        raise SubmissionError(f"{name} has no command: it needs an ENTRYPOINT or a CMD")
    size = sum(len(variable.encode()) for variable in settings.get("Env") or ())
    if size > LARGEST_VARIABLES:
        raise SubmissionError(
            f"{name} has {size:,} bytes of environment variables (ENV), "
            f"must have at most {LARGEST_VARIABLES:,}"
        )


def _manifest_in(engine: ContainerEngine, image: str, reference: str) -> bytes:
    container = f"wildscav-{leftovers.owner()}-manifest-{secrets.token_hex(4)}"
    enter_container(engine, container)
    options = ("--name", container, "--network", "none", "--pull", "never")
    created = call(engine, "create", *options, image, "nothing")
    if created.returncode != 0:
        raise SubmissionError(f"image {reference} cannot be read: {last_line(created.stderr)}")
    try:
        packed = _beginning(engine, "cp", f"{container}:/submission/{MANIFEST}", "-")
    finally:
        if call(engine, *removal(engine, container)).returncode == 0:
            release_container(engine, container)
    manifest = _first_file(packed)
    if manifest is None:
        raise SubmissionError(
            f"image {reference} has no /submission/{MANIFEST}: it gives name, version and tracks"
        )
    if len(manifest) > LARGEST_MANIFEST:
        raise SubmissionError(
            f"image {reference}: /submission/{MANIFEST} has more than {LARGEST_MANIFEST:,} bytes"
        )
    return manifest


def _beginning(engine: ContainerEngine, *arguments: str) -> bytes:
    """Return the beginning of the output of an engine's command, enough for the largest manifest."""
    with subprocess.Popen(
        [*engine.command, *arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    ) as process:
        if process.stdout is None:
            raise RuntimeError("the output of an engine's command is a pipe")
        content = process.stdout.read(LARGEST_MANIFEST + LARGEST_HEADERS)
        process.kill()
    return content


def _first_file(packed: bytes) -> bytes | None:
    """Return the beginning of the first plain file of a possibly truncated tar archive; None without one."""
    with contextlib.suppress(tarfile.TarError), tarfile.open(fileobj=io.BytesIO(packed)) as archive:
        for entry in archive:
            content = archive.extractfile(entry) if entry.isreg() else None
            if content is not None:
                # One byte more than allowed is enough to see that it is too large.
                size = min(entry.size, LARGEST_MANIFEST + 1)
                return packed[entry.offset_data : entry.offset_data + size]
    return None


def write_sdk_wheel(folder: Path) -> Path:
    """Write the SDK into a folder as a wheel, made from the installed package, and return its path.

    It contains the package ``wildscav`` alone.
    """
    info = f"wildscav-{wildscav.__version__}.dist-info"
    wheel_info = ("Wheel-Version: 1.0", "Generator: wildscav", "Root-Is-Purelib: true", f"Tag: {TAG}", "")
    content = _sdk_files() | {
        f"{info}/METADATA": _metadata().encode(),
        f"{info}/WHEEL": "\n".join(wheel_info).encode(),
        f"{info}/entry_points.txt": ENTRY_POINTS,
    }
    record = f"{info}/RECORD"
    lines = [f"{name},sha256={_digest(data)},{len(data)}" for name, data in content.items()]
    content[record] = "\n".join([*lines, f"{record},,", ""]).encode()
    path = folder / f"wildscav-{wildscav.__version__}-{TAG}.whl"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, data in content.items():
            wheel.writestr(name, data)
    return path


def _metadata() -> str:
    """Return the metadata for pip: the version and the dependencies of the SDK, without extras."""
    known = distribution("wildscav")
    message = Message()
    message["Metadata-Version"] = "2.1"
    message["Name"] = "wildscav"
    message["Version"] = wildscav.__version__
    message["Requires-Python"] = known.metadata["Requires-Python"]
    for requirement in known.requires or ():
        if "extra ==" not in requirement:
            message["Requires-Dist"] = requirement
    return str(message)


def _digest(data: bytes) -> str:
    return base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
