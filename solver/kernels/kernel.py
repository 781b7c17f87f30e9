"""How every kernel is compiled: single-threaded, cached on disk, no bounds checks, no NaN swallowed.

Nothing is contracted or reordered (no fastmath): each operation rounds as IEEE 754 has it, so that a run is the same to
the bit whatever was inlined where, and on every CPU (docs/decisions/0005). Divide by a constant by multiplying.

A kernel that is called from Python gives up the interpreter's lock. Else a run of short steps could keep another thread
of its process waiting for a second: one that holds the lock for less than the switch interval is never asked for it.

Kernels own no arrays. They read and write those that they are given, and small ones on the stack (`scratch`), which are
gone when they return. So nothing counts references, which took half of the code of many. Those few that make arrays, to
return them or for themselves, are `allocating`.

Numba's cache does not see that a kernel called from another file has changed. So the cache lives in a folder
named by a digest of the whole solver: another version of the code has another cache, and nothing compiles twice.
That digest says nothing of records of others, a test's or a user's: what the solver's kernels make of them is compiled
in each process. (Numba's index of a kernel names their modules: no process without these could read it.)
"""

from __future__ import annotations

import hashlib
import logging
import os
import stat
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache, wraps
from pathlib import Path
from typing import Any, TypeVar

import numba
from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, UserProvidedCacheLocator
from numba.core.registry import cpu_target
from numba.extending import overload

from solver.kernels import compiler

log = logging.getLogger(__name__)

Function = TypeVar("Function", bound=Callable[..., Any])

OPTIONS: dict[str, Any] = {"no_cfunc_wrapper": True, "error_model": "numpy", "nogil": True, "_nrt": False}

OWN = __name__.split(".")[0]
"""The solver's package."""

UPSTAIRS = "run"
"""The folder of the solver that has no kernels, and that nothing else in it may import."""

APART = "HOCKLE_COMPILES"
"""The environment variable that tells a process that it is the one that compiles."""

SPARE_COLLECTIONS = "import gc; gc.set_threshold(700, 10, 100); "
"""What a process that compiles does first: what numba makes is there to stay, and to look through all of it whenever it
has grown by a quarter, as Python does, takes a sixth of the time."""

PLAIN_MESSAGES = "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING"
"""The environment variable that spares numba to colour the messages of what it tries in vain, and nobody reads."""


@cache
def code_digest() -> str:
    """What tells this version of the kernels from every other: a digest of all sources that they may depend on."""
    digest, solver = hashlib.sha256(), Path(__file__).parents[1]
    for source in sorted(solver.rglob("*.py")):
        if source.relative_to(solver).parts[0] != UPSTAIRS:
            digest.update(source.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path | None:
    """The folder of this version's compiled kernels: the one that NUMBA_CACHE_DIR names, or below the user's cache.

    Where nobody can write there, nor has anybody compiled them there, one of this user alone among the temporary files;
    None where there is no such place either. Then each process compiles for itself.
    """
    wanted = _wanted_folder()
    if wanted and (_is_writable(wanted) or any(wanted.glob("*.compiled"))):
        return wanted
    folder = _temporary_folder()
    log.warning("the compiled solver cannot be kept in %s, it is kept in %s (NUMBA_CACHE_DIR names another folder)",
                wanted or "a home directory", folder or "no file")
    if folder:
        os.environ["NUMBA_CACHE_DIR"] = str(folder)  # of the processes that this one starts too
    return folder


def _wanted_folder() -> Path | None:
    if named := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(named)
    try:
        home = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    except RuntimeError:  # this user has no home
        return None
    return home / "hockle" / f"kernels-{code_digest()}"


def _is_writable(folder: Path) -> bool:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK | os.X_OK)


def _temporary_folder() -> Path | None:
    """A folder that no other user can write to, since what lies in it is executed: the same one for each process,
    unless somebody else has taken its name."""
    try:
        own = Path(tempfile.gettempdir()) / f"hockle-{getattr(os, 'geteuid', int)()}"
        with suppress(FileExistsError):
            own.mkdir(mode=0o700)
        status = own.lstat()
        if not (stat.S_ISDIR(status.st_mode) and status.st_uid == os.geteuid() and not status.st_mode & 0o077):
            own = Path(tempfile.mkdtemp(prefix="hockle-"))
        folder = own / f"kernels-{code_digest()}"
        return folder if _is_writable(folder) else None
    except OSError:
        return None


compiler.spare()
numba.config.CACHE_DIR = str(cache_folder() or "")  # type: ignore[attr-defined]


def compile_apart(name: str, statement: str) -> None:
    """Have `statement` compile kernels in a process of its own, once for each cache; `name` says which.

    LLVM takes hundreds of MB, which are not a job's. Where it cannot be done, kernels are compiled as they are called.
    """
    if not numba.config.CACHE_DIR:  # type: ignore[attr-defined]
        return  # nothing would come of it
    done = Path(numba.config.CACHE_DIR) / f"{name}-{_good_for()}.compiled"  # type: ignore[attr-defined]
    if done.exists() or os.environ.get(APART):
        return
    path = os.pathsep.join([str(_sources()), *filter(None, [os.environ.get("PYTHONPATH")])])
    environment = os.environ | {"PYTHONPATH": path, APART: "1", PLAIN_MESSAGES: "1"}
    command = [sys.executable, "-c", SPARE_COLLECTIONS + statement]
    with _alone(done.with_suffix(".lock")) as lock:
        if done.exists():
            return  # another process has compiled them meanwhile
        ended = subprocess.run(command, env=environment, check=False, pass_fds=lock)
        if ended.returncode == 0:
            with suppress(OSError):
                done.touch()


@contextmanager
def _alone(path: Path) -> Iterator[list[int]]:
    """Wait until no other process is in here, nor one that it has started with these descriptors, which hold the lock.

    Workers whose processes are killed while kernels are compiled would else start one compilation after the other.
    Where files cannot be locked, or the folder can only be read, nobody waits.
    """
    lock: list[int] = []
    with suppress(OSError, ImportError):
        import fcntl

        lock.append(os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600))
        fcntl.flock(lock[0], fcntl.LOCK_EX)
    try:
        yield lock
    finally:
        for descriptor in lock:
            os.close(descriptor)


def _sources() -> Path:
    """The folder from which this solver is imported."""
    return Path(__file__).absolute().parents[2]


@cache
def _good_for() -> str:
    """A digest of all by which numba tells whether a kernel in a cache is the one that is called: the code and its
    place, numba's and Python's versions, the CPU."""
    cpu = cpu_target.target_context.codegen().magic_tuple()
    parts = (code_digest(), str(_sources()), numba.__version__, sys.version_info[:2], cpu)
    return hashlib.sha256(repr(parts).encode()).hexdigest()[:16]


@cache
def _make(folder: str) -> None:
    """Make one of the cache's folders, once; of those that it is asked for for each kernel there are some thirty."""
    Path(folder).mkdir(parents=True, exist_ok=True)


class _Folder(UserProvidedCacheLocator):
    """The cache's folder, which may be one that can only be read."""

    def ensure_cache_path(self) -> None:
        with suppress(OSError):
            _make(self.get_cache_path())  # type: ignore[no-untyped-call]


class _Results(CompileResultCacheImpl):
    def __init__(self, function: Any) -> None:
        self._locator_classes = [_Folder]
        super().__init__(function)  # type: ignore[no-untyped-call]


class _Cache(FunctionCache):
    """A kernel's compiled variants on disk, without those for records of others."""

    _impl_class = _Results

    def save_overload(self, sig: Any, data: Any) -> None:
        if _holds_arrays(data.signature.return_type) and not data.target_context.enable_nrt:
            raise TypeError(f"{self._py_func.__qualname__} returns arrays, so it must be `allocating`")
        if self._py_func.__module__.split(".")[0] != OWN or all(map(_is_own, data.signature.args)):
            with suppress(OSError):  # read-only, or full: another process compiles it once more
                super().save_overload(sig, data)  # type: ignore[no-untyped-call]


def _holds_arrays(kind: Any) -> bool:
    """Whether a value of one of numba's types is an array, or a tuple that holds one."""
    return isinstance(kind, types.Array) or any(map(_holds_arrays, getattr(kind, "types", ())))


def _is_own(kind: Any) -> bool:
    """Whether all records in one of numba's types are of the solver."""
    record = getattr(kind, "instance_class", None)
    if record is not None and record.__module__.split(".")[0] != OWN:
        return False
    parts = getattr(kind, "types", ()) or getattr(kind, "field_dict", {}).values()
    return all(map(_is_own, parts))


def _compiled(function: Function, **options: Any) -> Function:
    dispatcher = numba.njit(**(OPTIONS | options))(function)
    _take_constants_as_numbers(dispatcher._compiler)
    if numba.config.CACHE_DIR:  # type: ignore[attr-defined]
        dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return dispatcher  # type: ignore[no-any-return]


def _take_constants_as_numbers(compiler: Any) -> None:
    """Let an argument that is written in figures be any number of its type, else numba compiles a function for each."""
    fold = compiler.fold_argument_types

    def fold_numbers(arguments: Any, named: Any) -> Any:
        signature, kinds = fold(arguments, named)
        return signature, tuple(map(types.unliteral, kinds))

    compiler.fold_argument_types = fold_numbers


def kernel(function: Function) -> Function:
    """Compile a function of plain arrays and numbers."""
    return _compiled(function)


def allocating(function: Function) -> Function:
    """Compile a function that makes arrays."""
    return _compiled(function, _nrt=True)


def inner(function: Function) -> Function:
    """Compile a function that only kernels call: without what Python would need to call it, which takes long."""
    return _compiled(function, no_cpython_wrapper=True)


def by_type(choose: Function) -> Function:
    """Make a function that only kernels call. Which one that is, `choose` says of the types of its arguments."""

    @wraps(choose)
    def call(*_arguments: Any) -> Any:
        raise TypeError(f"{choose.__name__} is for kernels")

    overloads(call, choose)
    return call  # type: ignore[return-value]


def overloads(call: Callable[..., Any], choose: Callable[..., Any]) -> None:
    """Let kernels that call `call` get what `choose` gives for the types of the arguments."""
    options: Any = OPTIONS
    overload(call, jit_options=options, strict=False)(choose)


def inlined_late(function: Function) -> Function:
    """Compile a function that LLVM puts into its callers, always: one that a kernel calls in several places.

    It is compiled once. What is `inlined` is typed and written out for LLVM again wherever it is called.
    """
    return _compiled(function, no_cpython_wrapper=True, forceinline=True)


def inlined(function: Function) -> Function:
    """Compile a function that is to vanish into its callers: one that is called for every node or interval.

    LLVM does not always inline what is small, and one call that is left in such a loop makes it a third slower in
    processes that load their kernels from the cache. Why is not known.
    """
    return _compiled(function, inline="always")
