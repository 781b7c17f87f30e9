"""Loops over nodes or segments, eight abreast, from a function that is written as for one.

The arrays hold what belongs to a node side by side, which a compiler cannot compute on several nodes at a time. So a
loop gathers what eight nodes hold into rows of eight, computes along the rows, where every operation is that of one
node on eight numbers at once, and scatters the results: to the bit what one after the other would give. `abreast`
writes that loop:

    @abreast("theta: 3, omega: 3 -> moved: 3, R: 3x3")
    @no_type_check
    def turn(theta, omega, dt):
        cosine, sinc, square = ...
        return theta + dt * omega, entries(cosine, sinc * theta[0], ...)

is the kernel turn(theta, omega, dt, moved, R), with arrays (n, >= 3) and (n, 3, 3), or (n,) for 1, for what is named
before and after the arrow, and numbers for all else. To leave out a result, take it out of the line, of the `return`
and of the calls.

What may be written: assignments and one `return`. Names that stand for several numbers (arguments, results of kernels
that return tuples, tuples) are added and multiplied number by number, taken apart by an index in figures, and handed
over by a star.

What is exact for small angles only (`series`) is computed along the rows, then mended lane by lane where an argument is
beyond its bound: there the loop is split, and names that are needed on both sides of it get rows of their own.

The last lanes are copies of the last line, so all arrays of one kernel must have as many lines.
"""

from __future__ import annotations

import ast
import inspect
import textwrap
from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, NamedTuple, get_args, get_type_hints

from solver.kernels.kernel import inner
from solver.kernels.scratch import scratch

LANES = 8
"""Nodes abreast: 512 bits, or two times 256."""


class Series(NamedTuple):
    """`beyond` says of the same arguments whether a function is not exact, and `otherwise` is what is."""

    beyond: Any
    otherwise: Any


_SERIES: dict[Any, Series] = {}


def series(function: Any, beyond: Any, otherwise: Any) -> None:
    """Let loops eight abreast mend what `function` gives by `otherwise` where `beyond` is true."""
    _SERIES[function] = Series(beyond, otherwise)


def abreast(arrays: str) -> Callable[[Callable[..., Any]], Any]:
    """Make a function for kernels, over all lines of arrays from a function of one line; see the module."""
    return lambda function: inner(_Loop(function, arrays).compiled())


class _Loop:
    """The kernel that a function of one line becomes.

    `widths`: how many numbers each name stands for; vector `a` of the function is a_0, a_1 ... in the kernel. `phases`:
    the lines of each loop along the rows; `mends`: what mends the lanes after each but the last. Within a phase a name
    is a number, between phases it is a row, `_a`, as arguments and results are. Names of the loops begin with `__`.
    """

    def __init__(self, function: Callable[..., Any], arrays: str) -> None:
        self.function, self.known = function, dict(function.__globals__)
        source = textwrap.dedent(inspect.getsource(function))
        tree: Any = ast.parse(source).body[0]
        self.body: list[ast.stmt] = tree.body
        self.line = function.__code__.co_firstlineno
        before, after = arrays.split("->")
        self.inputs, self.outputs = _shapes(before), _shapes(after)
        self.widths = {name: _width(shape) for name, shape in self.inputs.items()}
        self.parameters = [argument.arg for argument in tree.args.args]
        self.phases: list[list[str]] = [[]]
        self.mends: list[list[str]] = []

    def compiled(self) -> Any:
        """The Python function whose source this is; its file and line are those of the function that it is made of."""
        for statement in self.body:
            if isinstance(statement, ast.Return):
                self._give(statement.value)
            elif isinstance(statement, ast.Assign):
                self._assign(statement.targets[0], statement.value)
            elif not (isinstance(statement, ast.Expr) and isinstance(statement.value, ast.Constant)):
                raise SyntaxError(f"{self.function.__qualname__} eight abreast: only assignments and a return")
        tree = ast.parse(self.source())
        for node in ast.walk(tree):  # so that numba's cache finds the file, and an error its place
            if hasattr(node, "lineno"):
                node.lineno = node.end_lineno = self.line  # type: ignore[attr-defined]
        names: dict[str, Any] = self.known | {"_scratch": scratch}
        exec(compile(tree, self.function.__code__.co_filename, "exec"), names)  # noqa: S102
        loop = names[self.function.__name__]
        loop.__qualname__, loop.__doc__ = self.function.__qualname__, self.function.__doc__
        return loop

    def source(self) -> str:
        """The kernel."""
        loops, kept = list[str](), self._kept()
        if kept & (self.inputs.keys() | self.outputs.keys()):
            raise SyntaxError(f"{self.function.__qualname__} eight abreast: a name stands for two things")
        for at, phase in enumerate(self.phases):
            loops += [f"for __m in range({LANES}):", *_indented([*self._loaded(at, kept), *phase,
                                                               *self._stored(at, kept)])]  # fmt: skip
            loops += self.mends[at] if at < len(self.mends) else []
        rows = [(name, self.widths[name]) for name in self.inputs]
        rows += [(name, _width(shape)) for name, shape in self.outputs.items()]
        rows += [(name, 1) for name in sorted(kept)]
        body = [f"_{name} = _scratch(({width}, {LANES}))" for name, width in rows]
        body += [f"__lines = len({next(iter(self.outputs))})", f"for __first in range(0, __lines, {LANES}):"]
        block = [line for name, shape in self.inputs.items() for line in _moved(name, shape, "gather")]
        block += loops + [line for name, shape in self.outputs.items() for line in _moved(name, shape, "scatter")]
        head = f"def {self.function.__name__}({', '.join([*self.parameters, *self.outputs])}):"
        return "\n".join([head, *_indented(body + _indented(block))])

    def _assign(self, target: ast.expr, value: ast.expr) -> None:
        """Write `target = value`, number by number; split the loop where the value is a series."""
        names = self._targets(target, self._length(value))
        text = f"{', '.join(names)} = {', '.join(self._numbers(value))}"
        exact = self._series(value)
        self.phases[-1].append(text)
        if exact is not None:
            self._split(names, value, exact)

    def _split(self, names: list[str], call: Any, exact: Series) -> None:
        label, arguments = call.func.id, [argument.id for argument in call.args]
        self.known[f"_beyond_{label}"], self.known[f"_any_{label}"] = exact
        at = ", ".join(f"_{name}[0, __m]" for name in arguments)
        to = ", ".join(f"_{name}[0, __m]" for name in names)
        mend = [f"for __m in range({LANES}):", f"    if _beyond_{label}({at}):", f"        {to} = _any_{label}({at})"]
        self.mends.append(mend)
        self.phases.append([])

    def _give(self, value: Any) -> None:
        """Write the results into their rows."""
        values = value.elts if isinstance(value, ast.Tuple) and len(self.outputs) > 1 else [value]
        for (name, shape), result in zip(self.outputs.items(), values, strict=True):
            to = [f"_{name}[{k}, __m]" for k in range(_width(shape))]
            self.phases[-1].append(f"{', '.join(to)} = {', '.join(self._numbers(result))}")

    def _targets(self, target: ast.expr, width: int) -> list[str]:
        """The names of the numbers that are assigned."""
        if isinstance(target, ast.Tuple):
            return [name for part in target.elts for name in self._targets(part, 1)]
        if not isinstance(target, ast.Name) or target.id in self.inputs:
            raise SyntaxError(f"{self.function.__qualname__} eight abreast: {ast.unparse(target)} cannot be assigned")
        self.widths[target.id] = width
        return [target.id] if width == 1 else [f"{target.id}_{k}" for k in range(width)]

    def _length(self, value: ast.expr) -> int:
        """How many numbers a value is."""
        if isinstance(value, ast.Tuple):
            return len(value.elts)
        if isinstance(value, ast.Call):
            result = get_type_hints(self.known[value.func.id].py_func)["return"]  # type: ignore[attr-defined]
            return len(get_args(result)) or 1
        if isinstance(value, ast.Name):
            return self.widths.get(value.id, 1)
        if isinstance(value, (ast.BinOp, ast.UnaryOp)):
            return max(self._length(part) for part in ast.iter_child_nodes(value) if isinstance(part, ast.expr))
        return 1

    def _numbers(self, value: ast.expr) -> list[str]:
        """The numbers that a value is, as they are computed; a single text for a call."""
        if isinstance(value, ast.Call):
            arguments = [text for argument in value.args for text in self._handed(argument)]
            return [f"{value.func.id}({', '.join(arguments)})"]  # type: ignore[attr-defined]
        if isinstance(value, ast.Tuple):
            return [self._number(part, 0) for part in value.elts]
        return [self._number(value, k) for k in range(self._length(value))]

    def _handed(self, argument: ast.expr) -> list[str]:
        if isinstance(argument, ast.Starred):
            return self._numbers(argument.value)
        return [self._number(argument, 0)]

    def _number(self, value: ast.expr, k: int) -> str:
        """Number k of an expression."""
        return ast.unparse(_Number(self, k).visit(ast.parse(ast.unparse(value), mode="eval")))

    def component(self, name: str, k: int) -> str:
        """Number k of a name, or the only one."""
        width = self.widths.get(name, 1)
        if width > 1 and k >= width:
            raise SyntaxError(f"{self.function.__qualname__} eight abreast: {name} is {width} numbers, not more")
        if name in self.inputs:
            return f"_{name}[{k if width > 1 else 0}, __m]"
        return f"{name}_{k}" if width > 1 else name

    def _series(self, value: ast.expr) -> Series | None:
        if isinstance(value, ast.Call) and isinstance(value.func, ast.Name):
            return _SERIES.get(self.known.get(value.func.id))
        return None

    def _kept(self) -> set[str]:
        """The names of numbers that are needed in another phase than the one that computes them, or to mend."""
        kept, written = set[str](), set[str]()
        for at, phase in enumerate(self.phases):
            read, new = _names(tuple(phase))
            kept |= read & written
            written |= new
            if at < len(self.mends):
                mended, _ = _names(("\n".join(self.mends[at]),))
                kept |= {name for name in written if f"_{name}" in mended}
        return kept

    def _loaded(self, at: int, kept: set[str]) -> list[str]:
        read, _ = _names(tuple(self.phases[at]))
        return [f"{name} = _{name}[0, __m]" for name in sorted(read & kept) if at > 0]

    def _stored(self, at: int, kept: set[str]) -> list[str]:
        _, written = _names(tuple(self.phases[at]))
        return [f"_{name}[0, __m] = {name}" for name in sorted(written & kept)]


@cache
def _names(lines: tuple[str, ...]) -> tuple[frozenset[str], frozenset[str]]:
    """The names that are read in these lines before they are written, and all that are written."""
    read, written = set[str](), set[str]()
    for line in lines:
        names = [node for node in ast.walk(ast.parse(line)) if isinstance(node, ast.Name)]
        read |= {node.id for node in names if isinstance(node.ctx, ast.Load)} - written
        written |= {node.id for node in names if isinstance(node.ctx, ast.Store)}
    return frozenset(read), frozenset(written)


class _Number(ast.NodeTransformer):
    """What makes an expression of several numbers that of number k."""

    def __init__(self, loop: _Loop, k: int) -> None:
        self.loop, self.k = loop, k

    def visit_Name(self, node: ast.Name) -> ast.expr:
        return _parsed(self.loop.component(node.id, self.k))

    def visit_Subscript(self, node: ast.Subscript) -> ast.expr:
        return _parsed(self.loop.component(node.value.id, node.slice.value))  # type: ignore[attr-defined]

    def visit_Call(self, node: ast.Call) -> ast.expr:
        return _parsed(self.loop._numbers(node)[0])


def _parsed(text: str) -> ast.expr:
    return ast.parse(text, mode="eval").body


def _shapes(line: str) -> dict[str, str]:
    """The shapes by name: "a: 3, b: 3x3"."""
    return {name.strip(): shape.strip() for name, shape in (part.split(":") for part in line.split(","))}


def _width(shape: str) -> int:
    """How many numbers a line has."""
    rows, _, columns = shape.partition("x")
    return int(rows) * int(columns or 1)


def _moved(name: str, shape: str, how: str) -> list[str]:
    """The loops that gather eight lines of an array into rows, or scatter them."""
    rows, _, columns = shape.partition("x")
    loops, row, entry = [f"for __k in range({rows}):"], "__k", "__line, __k"
    if columns:
        loops = [f"for __i in range({rows}):", f"    for __k in range({columns}):"]
        row, entry = f"{columns} * __i + __k", "__line, __i, __k"
    elif shape == "1":
        loops, row, entry = [], "0", "__line"
    there, here = f"{name}[{entry}]", f"_{name}[{row}, __lane]"
    move = f"{here} = {there}" if how == "gather" else f"{there} = {here}"
    return [f"for __lane in range({LANES}):", "    __line = min(__first + __lane, __lines - 1)",
            *_indented(loops), "    " * (1 + len(loops)) + move]  # fmt: skip


def _indented(lines: Sequence[str]) -> list[str]:
    return [f"    {part}" for line in lines for part in line.split("\n")]
