"""Compilation of kernels that only other kernels call, to LLVM bitcode instead of machine code.

Numba generates machine code for every function, and links in and optimizes again everything that it calls, so
a deeply nested function is compiled again at every level above it. Here, a part (a kernel called by kernels)
is only optimized by itself. A kernel that Python calls links its parts, optimizes them together and generates
machine code once.

This relies on internals of Numba's compiler; ``pyproject.toml`` bounds Numba's version for that reason.
"""

import functools
from typing import Any

from llvmlite import binding as llvm
from numba.core import codegen, compiler, compiler_machinery, typed_passes, types

from wildscav_engine.compilation.kernel_cache import Entries, KernelCache
from wildscav_engine.compilation.table_type import mark_tables

# Annotated as Any, because Numba has no types for them.
Library: Any = codegen.JITCodeLibrary
Compiler: Any = compiler.CompilerBase
Pass: Any = compiler_machinery.LoweringPass
register_pass: Any = compiler_machinery.register_pass
compile_result: Any = compiler.compile_result
parse_bitcode: Any = llvm.parse_bitcode
new_passes: Any = llvm.create_new_function_pass_manager
unliteral: Any = types.unliteral


class TableLibrary(Library):  # type: ignore[misc]
    """The code of one kernel, which may get tables of arrays."""

    def add_ir_module(self, ir_module: Any) -> None:
        """Add generated code."""
        mark_tables(ir_module)
        super().add_ir_module(ir_module)


class BitcodeLibrary(TableLibrary):
    """The code of one kernel, to be linked into other kernels."""

    _shared_module: Any

    @property
    def codegen(self) -> "UnloadedCodegen":
        """The code generator of the part."""
        return UnloadedCodegen(self._codegen)

    def _optimize_functions(self, module: Any) -> None:
        """Reduce the code at little cost; the kernels that link it run the full optimization."""
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
        """Finalize the part without linking its callees; the kernels that link the part do that."""
        self._raise_if_finalized()
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.external:
                function.linkage = "linkonce_odr"
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:  # noqa: ARG002
        """Return null: there is no machine code."""
        self._ensure_finalized()
        return 0

    def _get_module_for_linking(self) -> Any:
        """Return the code linked with everything that it calls, for functions that are no kernels of ours."""
        self._ensure_finalized()
        if self._shared_module is None:
            self._shared_module = self._final_module.clone()
            _link_callees(self, self._shared_module)
        return self._shared_module

    def bitcodes(self) -> list[bytes]:
        """Return the code of the part, and that of all that it calls, each after all of its callers."""
        return [_bitcode_of(library) for library in (self, *_callees(self))]

    @classmethod
    def restore(cls, codegen: Any, name: str, bitcodes: list[bytes]) -> "BitcodeLibrary":
        """Return a part from its cached bitcode and that of all that it calls."""
        part = cls(codegen, name)
        part._final_module = parse_bitcode(bitcodes[0])
        part._linking_libraries = [_restore_callee(codegen, bitcode) for bitcode in bitcodes[:0:-1]]
        part._finalized = True
        return part


class UnloadedCodegen:
    """A code generator whose code is not loaded into memory, so that there is no environment to set."""

    def __init__(self, codegen: Any) -> None:
        self._codegen = codegen

    def __getattr__(self, name: str) -> Any:
        return getattr(self._codegen, name)

    def set_env(self, name: str, environment: Any) -> None:
        """Do nothing: an environment holds Python objects, and kernels use none."""


def _callees(part: BitcodeLibrary) -> list[Any]:
    """Return the libraries that a part calls, directly or indirectly, each after all of its callers.

    In another order some would be lost: the linker drops a function to which nothing refers yet.
    """
    found: dict[Any, None] = {}

    def find(library: Any) -> None:
        for called in library._linking_libraries:
            if called not in found:
                find(called)
        found[library] = None

    find(part)
    return list(found)[-2::-1]


def _code_of(library: Any) -> Any:
    """Return the code of a library, without what it calls if that is listed by itself."""
    is_part = type(library) is BitcodeLibrary
    return library._final_module if is_part else library._get_module_for_linking()


def _link_callees(library: Any, module: Any) -> None:
    """Link into a module everything that a library calls."""
    for callee in _callees(library):
        module.link_in(_code_of(callee), preserve=True)


@functools.cache
def _bitcode_of(library: Any) -> bytes:
    return bytes(_code_of(library).as_bitcode())


@functools.cache
def _restore_callee(codegen: Any, bitcode: bytes) -> BitcodeLibrary:
    """Return something that a cached part calls, once for all parts that call it."""
    return BitcodeLibrary.restore(codegen, "", [bitcode])


class LinkedLibrary(TableLibrary):
    """The code of a kernel that Python calls, linked with all parts that it calls."""

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments)
        self.enable_object_caching()

    def finalize(self) -> None:
        """Link every part once, optimize the whole, and generate machine code."""
        for library in self._linking_libraries:
            self._reload_init.update(library._reload_init)
        _link_callees(self, self._final_module)
        self._linking_libraries.clear()
        super().finalize()

    def _optimize_final_module(self) -> None:
        """Optimize once. Numba does so twice, to remove more reference counting; kernels have hardly any.

        No other code can call the parts: the optimizer may drop them once they are inlined, and change their
        arguments. As their names are private, the loader does not take them for the same parts elsewhere.
        """
        for function in self._final_module.functions:
            if not function.is_declaration and function.linkage == llvm.Linkage.linkonce_odr:
                function.linkage = "private"
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


class CreateLibrary(Pass):  # type: ignore[misc]
    """A compiler pass that creates the library into which a function is compiled."""

    library: type[Any]

    def __init__(self) -> None:
        Pass.__init__(self)

    def run_pass(self, state: Any) -> bool:
        """Create the library; return False, because the function itself is not modified."""
        state.library = self.library(state.targetctx.codegen(), state.func_id.func_qualname)
        return False


@register_pass(mutates_CFG=False, analysis_only=True)
class CreateBitcodeLibrary(CreateLibrary):
    """A compiler pass that creates the library of a kernel that kernels call."""

    _name = "create_bitcode_library"
    library = BitcodeLibrary


@register_pass(mutates_CFG=False, analysis_only=True)
class CreateLinkedLibrary(CreateLibrary):
    """A compiler pass that creates the library of a kernel that Python calls."""

    _name = "create_linked_library"
    library = LinkedLibrary


class BitcodeCompiler(Compiler):  # type: ignore[misc]
    """Numba's compiler with a ``BitcodeLibrary`` as its output."""

    first: type[CreateLibrary] = CreateBitcodeLibrary

    def define_pipelines(self) -> list[Any]:
        """Return the passes to run."""
        builder: Any = compiler.DefaultPassBuilder
        passes = builder.define_nopython_pipeline(self.state)
        passes.add_pass_after(self.first, typed_passes.AnnotateTypes)
        passes.finalize()
        passes._ENFORCING = False  # it checks Numba's own passes, after each of them
        return [passes]


class DisjointBitcodeCompiler(BitcodeCompiler):
    """The same for functions whose array arguments never share memory."""

    def define_pipelines(self) -> list[Any]:
        """Return the passes to run."""
        self.state.flags.noalias = True
        return super().define_pipelines()


class LinkedCompiler(BitcodeCompiler):
    """Numba's compiler with a ``LinkedLibrary`` as its output."""

    first = CreateLinkedLibrary


def for_all_numbers(dispatcher: Any) -> Any:
    """Make a dispatcher compile its function once for all values of a literal argument; return it.

    Numba would compile the function again for each constant that a caller passes. LLVM propagates constants
    itself where that is worthwhile.
    """
    template_for = dispatcher.get_call_template

    def get_call_template(arguments: Any, keywords: Any) -> Any:
        return template_for(
            tuple(unliteral(one) for one in arguments),
            {name: unliteral(one) for name, one in keywords.items()},
        )

    dispatcher.get_call_template = get_call_template
    return dispatcher


class BitcodeEntries(Entries):
    """The cache entries of a compiled part."""

    def reduce(self, result: Any) -> tuple[Any, ...]:
        """Return what is cached."""
        library, function = result.library, result.fndesc
        function.typemap = function.calltypes = None  # large, and cannot be pickled
        bitcodes = library.bitcodes()
        return library.name, bitcodes, function, result.environment, result.signature, result.reload_init

    def rebuild(self, target_context: Any, cached: tuple[Any, ...]) -> Any:
        """Return a compiled part from what was cached."""
        name, bitcodes, function, environment, signature, reload_init = cached
        for load in reload_init:
            load()
        library = BitcodeLibrary.restore(target_context.codegen(), name, bitcodes)
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


class BitcodeCache(KernelCache):
    """The cache of one kernel's parts, which are the same for all processors of an operating system."""

    entries = BitcodeEntries

    def _index_key(self, signature: Any, codegen: Any) -> Any:
        """Return what distinguishes the parts of a kernel, without the processor."""
        signature, (system, *_), function = super()._index_key(signature, codegen)
        return signature, system, function
