"""Methods of mechanisms: conversion of arguments, and documentation."""

import inspect
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._names import count as whole, hint, index, numbers, safe
from ._native import Function

#: Kind of the vector for each argument name: configuration `q`, velocity `v` or input `u`.
ENTRIES = {"q": "q", "from": "q", "to": "q", "v": "v", "a": "v", "tau": "v", "dv": "v", "u": "u"}


def marked(chosen: str | int | Iterable[str | int], velocities: Sequence[str]) -> NDArray[Any]:
    """Returns an array that is one at the velocities selected by names or indices, and zero elsewhere."""
    marks = np.zeros(len(velocities))
    if not isinstance(chosen, (str, int, Iterable)):
        raise TypeError(f"velocities are chosen by names or indices, found {chosen!r}")
    for one in [chosen] if isinstance(chosen, (str, int)) else chosen:
        k = index(velocities, one, "velocity") if isinstance(one, str) else one
        if not isinstance(k, (int, np.integer)) or not 0 <= k < len(velocities):
            raise IndexError(f"velocities have names, or the indices 0 to {len(velocities) - 1}, found {one!r}")
        marks[k] = 1
    return marks


def call(function: Function, mechanism: Any, given: tuple[Any, ...], named: dict[str, Any] | None) -> Any:
    """Calls a function with arguments of any type that can be converted."""
    name, arguments = function.name_and_documentation[0], function.arguments
    names = [safe(argument) for argument, _ in arguments]
    threads, out = None, None
    for key, value in (named or {}).items():
        if key == "threads":
            threads = value
        elif key == "out":
            out = value
        elif key in names:
            raise TypeError(f"{name}({', '.join(names)}): arguments are given without their names")
        else:
            raise TypeError(f"{name}() has no argument {key!r}{hint(key, ['threads', 'out'])}")
    if len(given) != len(arguments):
        raise TypeError(f"{name}({', '.join(names)}) takes {len(arguments)} arguments, found {len(given)}")
    frame, states = 0, mechanism._sets
    arrays = []
    for value, (argument, shape) in zip(given, arguments):
        if shape is None:
            frame = _frame(mechanism, value)
            continue
        array = _array(mechanism, name, argument, tuple(shape), value)
        if array.ndim > len(shape):
            if states is not None and states != len(array):
                raise ValueError(f"{name}: arrays of {states} and of {len(array)} states")
            states = len(array)
            if not states:
                array = array.reshape(0)
        arrays.append(array)
    lead = () if states is None else (states,)
    # Matrices are stored in column-major order, which is the memory layout of their transposes.
    stored = [lead + tuple(shape[::-1]) for _, shape in function.results]
    found = [np.empty(shape) for shape in stored] if out is None else _placed(name, out, stored, function)
    if out is not None:
        # Results may replace arguments.
        arrays = [array.copy() if any(np.may_share_memory(array, own) for own in found) else array for array in arrays]
    if states != 0:
        n = 1 if states is None else states
        threads = (0 if n >= 256 else 1) if threads is None else whole(threads, "threads")
        function.evaluate(mechanism._robot, frame, arrays, found, n, threads)
    results: list[Any] = []
    for array, (_, shape) in zip(found, function.results):
        result = array.swapaxes(-1, -2) if len(shape) > 1 else array
        results.append(result if result.ndim or out is not None else float(result))
    return results[0] if len(results) == 1 else tuple(results)


def _frame(mechanism: Any, value: Any) -> int:
    if isinstance(value, str):
        return index(mechanism.frames, value, "frame")
    if isinstance(value, (int, np.integer)) and 0 <= value < len(mechanism.frames):
        return int(value)
    raise IndexError(f"frames have names, or the indices 0 to {len(mechanism.frames) - 1}, found {value!r}")


def _array(mechanism: Any, name: str, argument: str, shape: tuple[int, ...], value: Any) -> NDArray[Any]:
    if argument == "held" and not isinstance(value, np.ndarray):
        return marked(value, mechanism.velocities)
    if isinstance(value, Mapping) and argument in ENTRIES:
        vector: NDArray[Any] = mechanism._vector(value, shape[0], argument)
        return vector
    array = numbers(value, np.float64, safe(argument))
    if array.shape[array.ndim - len(shape) :] != shape or array.ndim > len(shape) + 1:
        raise ValueError(f"{name}: {safe(argument)} has the shape {shape}, or (N, …) of N states, not {array.shape}")
    return np.ascontiguousarray(array) if array.ndim else array


def _placed(name: str, out: Any, stored: list[tuple[int, ...]], function: Function) -> list[NDArray[Any]]:
    """Returns the arrays for the results, in the layout in which they are stored."""
    given = out if isinstance(out, tuple) else (out,)
    if len(given) != len(stored):
        raise ValueError(f"{name}: `out` has {len(given)} arrays for {len(stored)} results")
    arrays: list[NDArray[Any]] = []
    for array, shape, (result, own) in zip(given, stored, function.results):
        kept = array.swapaxes(-1, -2) if len(own) > 1 and isinstance(array, np.ndarray) and array.ndim > 1 else array
        fits = isinstance(kept, np.ndarray) and kept.shape == shape and kept.dtype == np.float64
        if not fits or not kept.flags.c_contiguous or not kept.flags.writeable or not kept.flags.aligned:
            raise ValueError(
                f"{name}: `out` must be the arrays that a call with as many states returned, but {result} differs"
            )
        if any(np.may_share_memory(kept, other) for other in arrays):
            raise ValueError(f"{name}: the arrays of `out` share memory")
        arrays.append(kept)
    return arrays


def prepare(function: Function, kind: str, unit: str) -> None:
    """Sets names, signature and documentation of a function of a class."""
    own: Any = function
    name = function.name_and_documentation[0]
    own.__name__, own.__qualname__, own.__module__ = name, f"{kind}.{name}", "linkwork"
    parameter = inspect.Parameter
    parameters = [parameter("self", parameter.POSITIONAL_ONLY)]
    parameters += [parameter(safe(argument), parameter.POSITIONAL_ONLY) for argument, _ in function.arguments]
    parameters += [parameter(word, parameter.KEYWORD_ONLY, default=None) for word in ("threads", "out")]
    own.__signature__ = inspect.Signature(parameters)
    own.__doc__ = documentation(function, unit)


def documentation(function: Function, unit: str) -> str:
    """Returns the documentation of a method."""
    # Links of Rust's documentation are the names of functions.
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", function.name_and_documentation[1].split("# Errors")[0]).strip()
    text = re.sub(r"\[(`[^`]*`)\]", r"\1", text)
    lines = [text, ""]
    if function.arguments:
        lines.append("Args:")
        for argument, shape in function.arguments:
            by_name = ", or values by name" if argument in ENTRIES else ""
            if argument == "held":
                lines.append("    held: names of velocities, or their indices")
                continue
            size = "the name of a frame, or its index" if shape is None else f"shape {tuple(shape)}" if shape else "a number"
            lines.append(f"    {safe(argument)}: {size}{by_name}")
        lines.append("")
    lines.append("Returns:")
    for result, shape in function.results:
        size = f"shape {tuple(shape)}" if shape else "a number"
        lines.append(f"    {result}: {size}{', ' + unit if unit else ''}")
    lines.append("")
    lines.append("Arrays of N states, with N before these shapes, return arrays of N results. `threads` is the number of")
    lines.append("threads; `out`, the result of an earlier call with as many states, is overwritten.")
    return "\n".join(lines)


def quoted(text: str, indent: int = 4) -> str:
    """Returns a text as a docstring literal."""
    text = text.replace("\\", "\\\\").replace('"""', "'''").strip()
    lines = text.split("\n")
    inner = "\n".join([lines[0], *[(" " * indent + line).rstrip() for line in lines[1:]]])
    close = "\n" + " " * indent if len(lines) > 1 else ""
    return f'"""{inner}{close}"""'
