"""Methods that call the functions of compiled libraries."""

import ctypes
import hashlib
import inspect
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._names import Error, count as whole, hint, index, numbers, safe


def _structures(number: Any) -> tuple[Any, Any, Any]:
    """Returns the structures of the settings of simulations and rollouts, and the type of controllers, for a
    scalar type."""

    class Settings(ctypes.Structure):
        _fields_ = [
            ("start", number),
            ("duration", number),
            ("interval", number),
            ("method", ctypes.c_char_p),
            ("setting", number),
            ("period", number),
            ("control", ctypes.c_void_p),
            ("user", ctypes.c_void_p),
        ]

    class Rollout(ctypes.Structure):
        _fields_ = [
            ("start", number),
            ("step", number),
            ("steps", ctypes.c_size_t),
            ("states", ctypes.c_size_t),
            ("threads", ctypes.c_size_t),
            ("inputs_of", ctypes.c_int),
        ]

    control = ctypes.CFUNCTYPE(
        ctypes.c_int, ctypes.c_void_p, number, ctypes.c_void_p, ctypes.c_void_p, ctypes.c_void_p
    )
    return Settings, Rollout, control


def digest_file(path: Path) -> Path:
    """Returns the path of the file that contains the digest of a library or a command."""
    return path.with_name(f"{path.name}.sha256")


def digest(content: bytes) -> str:
    """Returns the digest of a file's content."""
    return hashlib.sha256(content).hexdigest()


def is_intact(path: Path) -> bool:
    """Returns whether a file has the content that was written to it."""
    try:
        return digest(path.read_bytes()) == digest_file(path).read_text(encoding="ascii", errors="replace")
    except FileNotFoundError:
        return False


class Library:
    """Shared library with its functions and their types."""

    def __init__(self, path: Path, prefix: str = "mechanism") -> None:
        try:
            # A damaged library could crash the interpreter.
            if not is_intact(path):
                raise OSError("its content is not the one that was written")
            self.handle = ctypes.CDLL(str(path))
        except OSError as error:
            raise Error(f"cannot load the library {path}: {error}; compile the mechanism again") from None
        get: Callable[[str], Any] = lambda name: getattr(self.handle, f"{prefix}_{name}")
        describe = get("description")
        describe.restype = ctypes.c_char_p
        self.description: dict[str, Any] = json.loads(describe().decode("utf-8"))
        single = self.description["number"] == "f32"
        self.dtype = np.dtype(np.float32 if single else np.float64)
        number: Any = ctypes.c_float if single else ctypes.c_double
        self.Settings, self.Rollout, self.Control = _structures(number)
        self.message = get("message")
        self.message.restype = ctypes.c_char_p
        self.call = get("call")
        size, pointer = ctypes.c_size_t, ctypes.c_void_p
        self.call.argtypes = [size, pointer, pointer, pointer, size, size]
        self.validate = get("validate")
        self.validate.argtypes = [pointer]
        self.simulate = get("simulate")
        self.simulate.argtypes = [pointer, pointer, pointer, pointer, pointer, size, pointer]
        self.roll_out = get("roll_out")
        self.roll_out.argtypes = [pointer] * 5
        self.defaults = get("defaults") if self.description["parameters"] else None

    def why(self) -> str:
        """Returns the message of the last failure in this thread."""
        return str(self.message().decode("utf-8"))


def address(array: NDArray[Any]) -> int:
    """Returns the address of an array's entries. The fast path does not support empty and read-only
    arrays."""
    try:
        return _addressof(_from_buffer(array))  # type: ignore[arg-type, unused-ignore]
    except (TypeError, ValueError, BufferError):
        return int(array.__array_interface__["data"][0])


_addressof, _from_buffer = ctypes.addressof, ctypes.c_char.from_buffer


#: Kind of the vector for each argument name: configuration `q`, velocity `v` or input `u`.
ENTRIES = {"q": "q", "from": "q", "to": "q", "v": "v", "a": "v", "tau": "v", "dv": "v", "u": "u"}


def marked(chosen: str | int | Iterable[str | int], velocities: Sequence[str], dtype: Any) -> NDArray[Any]:
    """Returns an array that is one at the velocities selected by names or indices, and zero elsewhere."""
    marks = np.zeros(len(velocities), dtype)
    if not isinstance(chosen, (str, int, Iterable)):
        raise TypeError(f"velocities are chosen by names or indices, found {chosen!r}")
    for one in [chosen] if isinstance(chosen, (str, int)) else chosen:
        k = index(velocities, one, "velocity") if isinstance(one, str) else one
        if not isinstance(k, (int, np.integer)) or not 0 <= k < len(velocities):
            raise IndexError(f"velocities have names, or the indices 0 to {len(velocities) - 1}, found {one!r}")
        marks[k] = 1
    return marks


def function(library: Library, k: int, about: dict[str, Any], cls: str) -> Callable[..., Any]:
    """Returns the method that calls the function with index `k`."""
    arguments, results = about["arguments"], about["results"]
    dtype, call, nv = library.dtype, library.call, len(library.description["velocities"])
    shapes: list[tuple[int, ...]] = []
    for a in arguments:
        shapes.append(tuple(a["shape"]) if a["kind"] == "array" else (nv,) if a["kind"] == "velocities" else ())
    kinds = [a["kind"] for a in arguments]
    names = [safe(a["name"]) for a in arguments]
    # Matrices are stored in column-major order, which is the memory layout of their transposes.
    stored = [tuple(r["shape"][:-2] + r["shape"][:-3:-1]) if len(r["shape"]) > 1 else tuple(r["shape"]) for r in results]
    turned = [len(shape) > 1 for shape in stored]
    Arguments: Any = ctypes.c_void_p * max(len(arguments), 1)
    Results: Any = ctypes.c_void_p * len(results)
    count = len(arguments)
    frames = library.description["frames"]
    velocities = [entry["name"] for entry in library.description["velocities"]]

    def prepared(self: Any, i: int, value: Any) -> NDArray[Any]:
        kind = kinds[i]
        if kind == "frame" and isinstance(value, str):
            value = index(frames, value, "frame")
        elif kind == "velocities":
            return marked(value, velocities, dtype)
        elif isinstance(value, Mapping) and arguments[i]["name"] in ENTRIES:
            vector: NDArray[Any] = self._vector(value, shapes[i][0], arguments[i]["name"])
            return vector
        array = numbers(value, dtype, names[i])
        found = array.shape
        if len(shapes[i]) == 2:
            array = np.swapaxes(array, -1, -2)
            expected = shapes[i][::-1]
        else:
            expected = shapes[i]
        if array.shape[array.ndim - len(expected) :] != expected or array.ndim > len(expected) + 1:
            raise ValueError(
                f"{about['name']}: {names[i]} has the shape {shapes[i]}, or (N, …) of N states, not {found}"
            )
        return array if array.flags.c_contiguous else np.ascontiguousarray(array)

    plain = all(kind == "array" and len(shape) == 1 for kind, shape in zip(kinds, shapes))
    ndarray, empty = np.ndarray, np.empty

    def method(self: Any, *given: Any, threads: int | None = None, out: Any = None, **others: Any) -> Any:
        for name in others:
            if name in names:
                raise TypeError(f"{about['name']}({', '.join(names)}): arguments are given without their names")
            raise TypeError(f"{about['name']}() has no argument {name!r}{hint(name, ['threads', 'out'])}")
        # Fast path of control loops: one state, in arrays that need no conversion.
        if plain and out is None and len(given) == count:
            for array, shape in zip(given, shapes):
                if type(array) is not ndarray or array.shape != shape or array.dtype != dtype:
                    break
                if not array.flags.c_contiguous:
                    break
            else:
                found = [empty(shape, dtype) for shape in stored]
                own = Arguments(*[address(array) for array in given])
                if call(k, self._own, own, Results(*[address(array) for array in found]), 1, 1) != 0:
                    raise Error(f"{about['name']}: {library.why()}")
                if len(found) == 1:
                    array = found[0]
                    return array.swapaxes(-1, -2) if turned[0] else array if array.ndim else array[()]
                return tuple(
                    array.swapaxes(-1, -2) if turn else array[()] for array, turn in zip(found, turned)
                )
        return general(self, given, threads, out)

    def placed(out: Any, lead: tuple[int, ...]) -> list[NDArray[Any]]:
        """Returns the arrays for the results, in the layout in which they are stored."""
        given = out if isinstance(out, tuple) else (out,)
        if len(given) != len(stored):
            raise ValueError(f"{about['name']}: `out` has {len(given)} arrays for {len(stored)} results")
        arrays = []
        for array, shape, turn, result in zip(given, stored, turned, results):
            kept = array.swapaxes(-1, -2) if turn and isinstance(array, ndarray) and array.ndim > 1 else array
            fits = isinstance(kept, ndarray) and kept.shape == lead + shape and kept.dtype == dtype
            if not fits or not kept.flags.c_contiguous or not kept.flags.writeable:
                raise ValueError(
                    f"{about['name']}: `out` is what an earlier call with as many states returned; of {result['name']} it is not"
                )
            arrays.append(kept)
        return arrays

    def general(self: Any, given: tuple[Any, ...], threads: int | None, out: Any) -> Any:
        if not hasattr(self, "_own"):
            raise TypeError(f"{about['name']} is a function of a mechanism, not of its class: make one first, with values of its parameters")
        if len(given) != count:
            raise TypeError(f"{about['name']}({', '.join(names)}) takes {count} arguments, found {len(given)}")
        arrays = [prepared(self, i, value) for i, value in enumerate(given)]
        states = None
        for array, shape in zip(arrays, shapes):
            if array.ndim > len(shape):
                if states is not None and states != len(array):
                    raise ValueError(f"{about['name']}: arrays of {states} and of {len(array)} states")
                states = len(array)
        n, lead = (1, ()) if states is None else (states, (states,))
        if states is not None:
            arrays = [
                array if array.ndim > len(shape) else np.ascontiguousarray(np.broadcast_to(array, (n, *array.shape)))
                for array, shape in zip(arrays, shapes)
            ]
        found = [empty(lead + shape, dtype) for shape in stored] if out is None else placed(out, lead)
        if n > 0:
            own = Arguments(*[address(array) for array in arrays])
            wanted = Results(*[address(array) for array in found])
            if threads is None:
                threads = 0 if n >= 256 else 1
            else:
                threads = whole(threads, "threads")
            if call(k, self._own, own, wanted, n, threads) != 0:
                raise Error(f"{about['name']}: {library.why()}")
        found = [array.swapaxes(-1, -2) if turn else array[()] for array, turn in zip(found, turned)]
        return found[0] if len(found) == 1 else tuple(found)

    method.__name__ = about["name"]
    method.__qualname__ = f"{cls}.{about['name']}"
    method.__doc__ = documentation(about, shapes)
    kind = inspect.Parameter
    parameters = [kind("self", kind.POSITIONAL_ONLY)]
    parameters += [kind(name, kind.POSITIONAL_ONLY) for name in names]
    parameters += [kind(name, kind.KEYWORD_ONLY, default=None) for name in ("threads", "out")]
    setattr(method, "__signature__", inspect.Signature(parameters))
    return method


def documentation(about: dict[str, Any], shapes: Sequence[tuple[int, ...]]) -> str:
    """Returns the documentation of a method."""
    lines = [about["documentation"], ""]
    if about["arguments"]:
        lines.append("Args:")
        for a, shape in zip(about["arguments"], shapes):
            text = {
                "number": "a number",
                "frame": "the name of a frame, or its number",
                "velocities": "names of velocities, or their indices",
            }.get(a["kind"], f"shape {shape}")
            by_name = ", or values by name" if a["kind"] == "array" and a["name"] in ENTRIES else ""
            lines.append(f"    {safe(a['name'])}: {text}{by_name}")
        lines.append("")
    lines.append("Returns:")
    unit = f", {about['unit']}" if about["unit"] else ""
    for r in about["results"]:
        size = f"shape {tuple(r['shape'])}" if r["shape"] else "a number"
        lines.append(f"    {r['name']}: {size}{unit}")
    lines.append("")
    if about["errors"]:
        lines += ["Raises:", f"    Error: {about['errors']}", ""]
    lines.append("Arrays of N states, with N before these shapes, give arrays of N results. `threads` says how many share them;")
    lines.append("`out` is what an earlier call with as many states returned, and is written over.")
    return "\n".join(lines)


def quoted(text: str, indent: int = 4) -> str:
    """Returns a text as a docstring literal."""
    text = text.replace("\\", "\\\\").replace('"""', "'''").strip()
    lines = text.split("\n")
    inner = "\n".join([lines[0], *[(" " * indent + line).rstrip() for line in lines[1:]]])
    close = "\n" + " " * indent if len(lines) > 1 else ""
    return f'"""{inner}{close}"""'
