"""The modules of several submissions in one process, where different ones may have the same name."""

import importlib
import sys
import threading
from pathlib import Path
from types import ModuleType, TracebackType
from typing import ClassVar


class OwnModules:
    """The modules in a submission's folder, which only its own code can import.

    All submissions have a module ``agent``, and many have others of equal names. So a submission's code runs
    inside this context. It puts the folder first on the path and the submission's modules into
    ``sys.modules``, and takes both out again at the end. Only one thread at a time can be inside.
    """

    _one_at_a_time: ClassVar[threading.RLock] = threading.RLock()

    def __init__(self, folder: Path) -> None:
        self._folder = str(folder)
        self._names = {
            path.stem for path in folder.iterdir() if path.suffix == ".py" or (path / "__init__.py").is_file()
        }
        self._own: dict[str, ModuleType] = {}
        self._displaced: dict[str, ModuleType] = {}
        self._count = 0
        importlib.invalidate_caches()

    def __enter__(self) -> None:
        self._one_at_a_time.acquire()
        self._displaced = {
            name: sys.modules.pop(name) for name in self._names | self._own.keys() if name in sys.modules
        }
        sys.modules.update(self._own)
        self._count = len(sys.modules)
        sys.path.insert(0, self._folder)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if len(sys.modules) != self._count:
            modules = list(sys.modules.items())
            self._own = {name: found for name, found in modules if name.partition(".")[0] in self._names}
        for name in self._own:
            sys.modules.pop(name, None)
        sys.modules.update(self._displaced)
        if self._folder in sys.path:
            sys.path.remove(self._folder)
        self._one_at_a_time.release()
