"""How kernels that only other kernels call are compiled: up to LLVM's code, but not to machine code.

Numba makes machine code of every function, with all that it calls linked in and optimized anew, so that what
lies deep is compiled again for each level above it. A part is optimized by itself only; a kernel that Python
calls links the parts below it, optimizes them together and makes machine code, once.

This builds on the insides of Numba's compiler, whose versions ``pyproject.toml`` bounds for that reason.
"""

from typing import Any

from llvmlite import binding as llvm
from numba.core import codegen, compiler, compiler_machinery, typed_passes, types

from wildscav_engine.compilation.kernel_cache import Entries, KernelCache

# Typed here, because Numba comes without types.
Library: Any = codegen.JITCodeLibrary
Compiler: Any = compiler.CompilerBase
Pass: Any = compiler_machinery.LoweringPass
register_pass: Any = compiler_machinery.register_pass
compile_result: Any = compiler.compile_result
parse_bitcode: Any = llvm.parse_bitcode
new_passes: Any = llvm.create_new_function_pass_manager
unliteral: Any = types.unliteral


class Part(Library):  # type: ignore[misc]
    """The code of one kernel, to be linked into others."""

    _shared_module: Any

    @property
    def codegen(self) -> "Unplaced":
        """What made the code."""
        return Unplaced(self._codegen)

    def _optimize_functions(self, module: Any) -> None:
        """Make the code smaller, at little cost: those that run it optimize it in earnest."""
        module.data_layout = self._codegen._data_layout
        builder = self._codegen._pass_builder()
        for function in module.functions:
            if not function.is_declaration:
                passes = new_passes()
                passes.add_sroa_pass()
                passes.add_instruction_combine_pass()
                passes.add_simplify_cfg_pass()
                passes.run(function, builder)

    def finalize(self) -> None:
        """Close the part; what it calls is linked by those that run it."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:  # noqa: ARG002
        """Return null: there is no machine code."""
        self._ensure_finalized()
        return 0

    def _get_module_for_linking(self) -> Any:
        """Return the code with all that it calls, directly or not."""
        self._ensure_finalized()
        if self._shared_module is None:
            module = self._final_module.clone()
            for library in _below(self):
                code = library._final_module if type(library) is Part else library._get_module_for_linking()
                module.link_in(code, preserve=True)
            for function in module.functions:
                if not function.is_declaration and function.linkage == llvm.Linkage.external:
                    function.linkage = "linkonce_odr"
            self._shared_module = module
        return self._shared_module

    @classmethod
    def restore(cls, codegen: Any, name: str, bitcode: bytes) -> "Part":
        """Return a part as it was kept, with all that it calls."""
        part = cls(codegen, name)
        part._final_module = part._shared_module = parse_bitcode(bitcode)
        part._finalized = True
        return part


class Unplaced:
    """The generator of code that lies nowhere in memory, so it has no environment to set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing. Kernels use no Python objects, which is what an environment holds."""


def _below(part: Part) -> list[Any]:
    """Return the libraries that a part calls, directly or not, each after all that call it.

    In another order some would be lost: what nobody calls yet is not linked in.
    """
    found: dict[Any, None] = {}

    def find(library: Any) -> None:
        for called in library._linking_libraries:
            if called not in found:
                find(called)
        found[library] = None

    find(part)
    return list(found)[-2::-1]


class Whole(Library):  # type: ignore[misc]
    """The code of a kernel that Python calls, with all parts that it calls."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.enable_object_caching()

    def _optimize_final_module(self) -> None:
        """Optimize it once. Numba does it twice, to find references that need no counting; here are none."""
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


class Make(Pass):  # type: ignore[misc]
    """Give a function a library to be compiled into."""

    library: type[Any]

    def __init__(self) -> None:
        Pass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Do it; the function itself stays as it is."""
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        return False


@register_pass(mutates_CFG=False, analysis_only=True)
class MakePart(Make):
    """Give a function a part to be compiled into."""

    _name = "make_part"
    library = Part


@register_pass(mutates_CFG=False, analysis_only=True)
class MakeWhole(Make):
    """Give a function a whole to be compiled into."""

    _name = "make_whole"
    library = Whole


class PartCompiler(Compiler):  # type: ignore[misc]
    """Numba's compiler, making parts."""

    first: type[Make] = MakePart

    def define_pipelines(self) -> list[Any]:
        """Return the passes to run."""
        builder: Any = compiler.DefaultPassBuilder
        passes = builder.define_nopython_pipeline(self.state)
        passes.add_pass_after(self.first, typed_passes.AnnotateTypes)
        passes.finalize()
        return [passes]


class WholeCompiler(PartCompiler):
    """Numba's compiler, making wholes."""

    first = MakeWhole


def for_all_numbers(dispatcher: Any) -> Any:
    """Let a function be compiled once for all values of a number; return it.

    Numba would compile it anew for each constant that a caller writes. LLVM puts constants in by itself where
    that gains anything.
    """
    template_for = dispatcher.get_call_template

    def get_call_template(arguments: Any, keywords: Any) -> Any:
        return template_for(
            tuple(unliteral(one) for one in arguments),
            {name: unliteral(one) for name, one in keywords.items()},
        )

    dispatcher.get_call_template = get_call_template
    return dispatcher


class PartEntries(Entries):
    """What is kept of a compiled part."""

    def reduce(self, result: Any) -> tuple[Any, ...]:
        """Return what is kept."""
        library, function = result.library, result.fndesc
        function.typemap = function.calltypes = None  # large, and not for pickling
        bitcode = library._get_module_for_linking().as_bitcode()
        return library.name, bitcode, function, result.environment, result.signature, result.reload_init

    def rebuild(self, target_context: Any, kept: tuple[Any, ...]) -> Any:
        """Return a compiled part from what was kept."""
        name, bitcode, function, environment, signature, reload_init = kept
        for load in reload_init:
            load()
        library = Part.restore(target_context.codegen(), name, bitcode)
        return compile_result(
            typing_context=target_context.typing_context,
            target_context=target_context,
            library=library,
            environment=environment,
            entry_point=target_context.get_executable(library, function, environment),
            fndesc=function,
            type_annotation="",
            signature=signature,
            objectmode=False,
            lifted=(),
            typing_error=None,
            call_helper=None,
            metadata=None,
            reload_init=reload_init,
            referenced_envs=(),
        )


class PartCache(KernelCache):
    """The cache of one kernel's parts."""

    entries = PartEntries
