"""The ids by which Gymnasium and PettingZoo know the environments.

Entry points are strings: nothing is compiled, or imported beyond this file, before an environment is made.
The number after ``-v`` rises whenever learning could change.
"""

import sys
from collections.abc import Callable, Sequence
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType

VERSION = 0
TRACK_NAMES = ("navigation", "gathering", "capture", "battle", "royale")


def env_id(track: str) -> str:
    """Return the Gymnasium id of a track."""
    return f"WildScav/{track.capitalize()}-v{VERSION}"


def zoo_id(track: str) -> str:
    """Return the PettingZoo name of a track."""
    return f"wildscav/{track}_v{VERSION}"


def register() -> None:
    """Make the ids known to Gymnasium and PettingZoo: now if they are imported, else when they will be.

    They are not imported for it, since most processes that use the engine need neither.
    """
    for library, enter in (("gymnasium", _enter_gymnasium), ("pettingzoo", _enter_pettingzoo)):
        if sys.modules.get(library) is not None:
            enter()
        else:
            sys.meta_path.insert(0, _Watch(library, enter))


def _enter_gymnasium() -> None:
    import gymnasium

    for track in TRACK_NAMES:
        if env_id(track) not in gymnasium.registry:
            gymnasium.register(
                id=env_id(track),
                entry_point="wildscav_engine.envs.single:SingleEnv",
                vector_entry_point="wildscav_engine.envs.vector:VectorArena",
                kwargs={"track": track},
            )


def _enter_pettingzoo() -> None:
    from pettingzoo import parallel_registry
    from pettingzoo import register as enter

    home = "wildscav_engine.envs.parallel"
    for track in TRACK_NAMES:
        if zoo_id(track).replace("_v", "-v") not in parallel_registry:
            enter("parallel", zoo_id(track), entry_point=f"{home}:parallel_env", kwargs={"track": track})
            enter("aec", zoo_id(track), entry_point=f"{home}:aec_env", kwargs={"track": track})


class _Watch(MetaPathFinder):
    """Waits until a library is imported."""

    def __init__(self, library: str, enter: Callable[[], None]) -> None:
        self._library, self._enter, self._asking = library, enter, False

    def find_spec(
        self,
        fullname: str,
        path: Sequence[str] | None,  # noqa: ARG002
        target: ModuleType | None = None,  # noqa: ARG002
    ) -> ModuleSpec | None:
        """Find the library as everybody else would, with a word to say once it is there."""
        if fullname != self._library or self._asking:
            return None
        self._asking = True
        try:
            spec = find_spec(fullname)
        finally:
            self._asking = False
        if spec is not None and spec.loader is not None:
            spec.loader = _Loader(spec.loader, self._loaded)
        return spec

    def _loaded(self) -> None:
        """Enter the ids, and watch no longer: those who asked before only looked whether it is there."""
        if self in sys.meta_path:
            sys.meta_path.remove(self)
        self._enter()


class _Loader(Loader):
    """Loads a library, then enters the ids."""

    def __init__(self, loader: Loader, enter: Callable[[], None]) -> None:
        self._loader, self._enter = loader, enter

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Return what the library's own loader makes."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Run the library, then enter the ids."""
        module.__loader__ = self._loader
        if module.__spec__ is not None:
            module.__spec__.loader = self._loader
        self._loader.exec_module(module)
        self._enter()
