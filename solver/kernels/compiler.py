"""What spares numba work when it compiles kernels: by its internals, and none of it changes what a kernel computes.

Half of the time is numba's own Python, which types every call of every kernel. Of `a + b` it asks all that may ever be
meant by +, each time; here it asks once for each kind of a and b. After each of its passes it looks which variables
live where, which only the last pass and generators need. And it makes machine code of each kernel by itself, also of
those that only kernels call, which are part of their callers' code, and has LLVM optimize it twice before; here that
code and the second round are only for what somebody asks the address of (docs/decisions/0005).
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numba.core.codegen import JITCodeLibrary
from numba.core.postproc import PostProcessor, VariableLifetime
from numba.core.registry import cpu_target
from numba.core.targetconfig import ConfigStack
from numba.core.transforms import canonicalize_cfg
from numba.core.types.functions import BaseFunction


class _Resolved(NamedTuple):
    """What numba takes a call for: its signature, and the key of what implements it."""

    signature: Any
    implementation: Any


class Calls:
    """The calls that were typed already: by function, kinds of arguments, and how their caller is compiled."""

    def __init__(self) -> None:
        self._resolve = BaseFunction.get_call_type
        self.known: dict[Any, _Resolved] = {}
        self._alike: dict[Any, Any] = {}
        """Of all flags that are equal the first, whose identity stands for them: they are slow to compare."""
        self._flags: Any = None
        self._first: Any = None

    def resolve(self, function: Any, context: Any, arguments: Any, named: Any) -> Any:
        """The signature of a call, as numba's own `get_call_type`."""
        if named:
            return self._resolve(function, context, arguments, named)
        key = function, context, tuple(arguments), id(self._flags_like_those_of_the_caller())
        call = self.known.get(key)
        if call is None:
            signature = self._resolve(function, context, arguments, named)
            call = self.known[key] = _Resolved(signature, function.get_impl_key(signature))
        function._impl_keys[call.signature.args] = call.implementation
        return call.signature

    def _flags_like_those_of_the_caller(self) -> Any:
        flags = ConfigStack.top_or_none()
        if flags is not self._flags or self._first is None:
            self._flags, self._first = flags, self._alike.setdefault(flags, flags)
        return self._first


class _Library(JITCodeLibrary):
    """A kernel's code with all that it calls: machine code once somebody asks for an address in it."""

    has_machine_code = False

    def _optimize_final_module(self) -> None:
        """Numba's first round, in which calls are inlined; see `_make_machine_code` for the second."""
        self._optimize(loop_vectorize=self._codegen._loopvect, slp_vectorize=False, opt=self._codegen._opt_level,
                       cost="cheap")  # fmt: skip

    def _optimize(self, **options: Any) -> None:
        passes, builder = self._codegen._module_pass_manager(**options)
        passes.run(self._final_module, builder)

    def get_pointer_to_function(self, name: str) -> Any:
        """The address of one of its functions; 0 if it has none of that name."""
        self._ensure_finalized()
        if not self.has_machine_code and any(function.name == name for function in self.get_defined_functions()):
            self._make_machine_code()
        return super().get_pointer_to_function(name)

    def serialize_using_object_code(self) -> Any:
        """What a cache keeps of it."""
        return super().serialize_using_object_code() if self.has_machine_code else self.serialize_using_bitcode()

    @property
    def _is_from_a_cache(self) -> bool:
        return bool(getattr(self, "_compiled_object", None))

    def _finalize_final_module(self) -> None:
        if self._is_from_a_cache:
            self._make_machine_code()
            return
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def _make_machine_code(self) -> None:
        self.has_machine_code = True
        if not self._is_from_a_cache:
            self._optimize()
        super()._finalize_final_module()
        for variable in self._final_module.global_variables:
            if variable.name in _WAITING:
                _SET_AT_ONCE(variable.name, _WAITING.pop(variable.name))


def _after_pass(processor: Any, emit_dels: bool = False, extend_lifetimes: bool = False) -> None:
    """What numba does after a pass; without `emit_dels` there is another one to come."""
    function = processor.func_ir
    if emit_dels or function.is_generator:
        _AFTER_PASS(processor, emit_dels, extend_lifetimes)
        return
    function.blocks = canonicalize_cfg(function.blocks)
    function.variable_lifetime = VariableLifetime(function.blocks)
    function.generator_info = None


def _set_environment(name: str, environment: Any) -> None:
    """Tell a function what it raises its exceptions with: at once, or when there is machine code of it."""
    if CODE._engine.get_global_value_address(name):
        _SET_AT_ONCE(name, environment)
    else:
        _WAITING[name] = environment


CALLS, CODE = Calls(), cpu_target.target_context.codegen()
_SET_AT_ONCE, _WAITING = CODE.set_env, dict[str, Any]()
_AFTER_PASS = PostProcessor.run


def spare() -> None:
    """Have numba work like this from now on."""
    BaseFunction.get_call_type = lambda *call: CALLS.resolve(*call)  # type: ignore[method-assign]
    PostProcessor.run = _after_pass  # type: ignore[method-assign, assignment]
    CODE._library_class, CODE.set_env = _Library, _set_environment
