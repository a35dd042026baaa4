"""The digest of everything that a kernel's code depends on: its file, all files imported by it, the compiler.

A file whose kernels call kernels of extensions declares a constant ``KERNELS_OF``, the group of entry points
that names them; the files of those extensions, built-in or of other packages, then count as imported.

The digest does not depend on the location or the modification time of files, so all clones, environments and
wheels of the same version share their compiled code. It does not include the processor, because Numba itself
separates machine code for different processors.

Finding the imports of a file takes longer than anything else here, so they are remembered between processes.
"""

import ast
import functools
import json
import os
import sys
from collections.abc import Iterator
from contextlib import suppress
from hashlib import blake2b
from importlib.metadata import version
from pathlib import Path

from wildscav_engine.compilation.caching.cache_root import cache_root
from wildscav_engine.extensions import sources_of

PACKAGE = Path(__file__).parents[2]
OURS = "wildscav"  # how the names of all our packages begin; those of the platform lie in one folder
BLOCKS = ("body", "orelse", "handlers", "finalbody", "cases")  # fields of a statement that contain statements
KERNELS_OF = "KERNELS_OF"  # the name of the constant
TYPE_CHECKING = ("TYPE_CHECKING", "typing.TYPE_CHECKING")
REMEMBERED = 5000  # files

Imports = tuple[list[str], list[str]]  # the names of imports, and the groups of kernels that are called


@functools.cache
def compiler_versions() -> str:
    """Return the versions of everything that compiles kernels, in one line."""
    packages = " ".join(f"{name} {version(name)}" for name in ("numba", "llvmlite", "numpy"))
    return f"{packages} {sys.implementation.cache_tag}"


@functools.cache
def sources_digest(file: Path) -> str:
    """Return a digest of a file, all files on which it depends, and the version of the compiler."""
    known = len(_remembered())
    digest = blake2b(compiler_versions().encode(), digest_size=8)
    for name, content in sorted((name_of(path), content_digest(path)) for path in closure(file)):
        digest.update(name.encode() + b"\0" + content)
    if len(_remembered()) > known:
        _remember()
    return digest.hexdigest()


def closure(file: Path) -> set[Path]:
    """Return a file and all files that it imports, even indirectly, as ``imported_files`` finds them."""
    found: set[Path] = set()
    waiting = [file]
    while waiting:
        path = waiting.pop()
        if path not in found:
            found.add(path)
            waiting.extend(imported_files(path))
    return found


@functools.cache
def content_digest(file: Path) -> bytes:
    """Return a digest of the content of a file."""
    return blake2b(file.read_bytes(), digest_size=16).digest()


def name_of(file: Path) -> str:
    """Return the path of a file from its outermost package, such as ``wildscav_engine/maps/land.py``."""
    return file.relative_to(_root(file)).as_posix()


@functools.cache
def imported_files(file: Path) -> tuple[Path, ...]:
    """Return the files that a file imports at run time from the engine, its own package or ours beside it.

    Imports in functions count. A file outside packages may also import files in its own folder.
    """
    root = _root(file)
    own = "" if root == file.parent else file.relative_to(root).parts[0]
    package = list(file.parent.relative_to(root).parts)
    found: dict[Path, None] = {}
    names, groups = _imports_of(file, package)
    for name in names:
        top = name.split(".")[0]
        if top == PACKAGE.name:
            found[_module_file(PACKAGE.parent, name)] = None
        elif own and (top == own or top.startswith(OURS)):
            found[_module_file(root, name)] = None
        elif not own:
            found[root / f"{name}.py"] = None
    for group in groups:
        found.update(dict.fromkeys(sources_of(group)))
    return tuple(path for path in found if path.is_file())


def _imports_of(file: Path, package: list[str]) -> Imports:
    """Return what a file in a package imports and calls."""
    key = f"{'.'.join(package)} {content_digest(file).hex()}"
    if key not in _remembered():
        tree = ast.parse(file.read_bytes())
        _remembered()[key] = list(_imported_names(tree, package)), list(_groups_called(tree))
    return _remembered()[key]


@functools.cache
def _remembered() -> dict[str, Imports]:
    """Return what is known of the imports of files, by their packages and the digests of their contents."""
    try:
        found: dict[str, Imports] = json.loads(_memory().read_bytes())
    except (OSError, ValueError):
        return {}
    return found if len(found) < REMEMBERED else {}


def _remember() -> None:
    memory = _memory()
    new = memory.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        memory.parent.mkdir(parents=True, exist_ok=True)
        new.write_text(json.dumps(_remembered()))
        new.replace(memory)


def _memory() -> Path:
    """Return the file for what this version of Python and of this file finds."""
    version = content_digest(Path(__file__)).hex()
    return cache_root() / f"imports-{sys.implementation.cache_tag}-{version}.json"


def _groups_called(tree: ast.Module) -> Iterator[str]:
    """Yield the groups of entry points whose kernels are called by the kernels of a file."""
    for node in tree.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
            names = [target.id for target in node.targets if isinstance(target, ast.Name)]
            if KERNELS_OF in names:
                yield str(node.value.value)


def _imported_names(tree: ast.AST, package: list[str]) -> Iterator[str]:
    """Yield the full name of every import that may be a module, of a file in packages, outermost first."""
    for node in _run(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                parts = alias.name.split(".")
                # ``import a.b`` binds a, which gives access to everything in it.
                yield from (".".join(parts[:count]) for count in range(1, len(parts) + 1))
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) - node.level + 1] if node.level else []
            base = ".".join([*above, *filter(None, [node.module])])
            yield from [base, *(f"{base}.{alias.name}" for alias in node.names)]


def _run(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield the statements of a syntax tree, including nested ones, except those only for type checkers."""
    waiting = [tree]
    while waiting:
        node = waiting.pop()
        yield node
        is_typing = isinstance(node, ast.If) and ast.unparse(node.test) in TYPE_CHECKING
        for part in ("orelse",) if is_typing else BLOCKS:
            waiting.extend(getattr(node, part, ()))


def _module_file(root: Path, name: str) -> Path:
    path = root.joinpath(*name.split("."))
    return path / "__init__.py" if path.is_dir() else path.with_name(f"{path.name}.py")


def _root(file: Path) -> Path:
    """Return the folder that contains the outermost package of a file, or else the folder of the file."""
    folder = file.parent
    while (folder / "__init__.py").exists():
        folder = folder.parent
    return folder
