"""Python classes of compiled mechanisms."""

import copyreg
import ctypes
import importlib
import json
import keyword
import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._equilibrium import Rest, find
from ._functions import ENTRIES, Library, address, function, marked, quoted
from ._names import Error, checked, count, hint, index, number, numbers, safe
from ._results import LinearSystem, Run, Units

#: Type variable of mechanism classes.
M = TypeVar("M", bound="Mechanism")
#: Vector: an array, or values by name.
Entries = ArrayLike | Mapping[str, float]
#: Integration methods, with the setting that determines their accuracy.
_METHODS = {
    "dormand_prince": "tolerance",
    "dormand_prince8": "tolerance",
    "rodas": "tolerance",
    "event_driven": "tolerance",
    "rk4": "step",
    "implicit_midpoint": "step",
    "time_stepping": "step",
    "time_stepping_midpoint": "step",
}


class _Kind(type):
    """Metaclass of mechanisms, whose classes are pickled by the paths of their libraries."""


class Mechanism(metaclass=_Kind):
    """Mechanism with values of its parameters. Subclasses are created by :func:`linkwork.compile`. Parameters
    are keyword arguments; those with a dot in their names are passed in a dictionary."""

    #: Name of the struct.
    name: ClassVar[str] = ""
    #: Names of the entries of `q`, `v` and `u`, and of the parameters, frames and outputs.
    configuration: ClassVar[Sequence[str]] = ()
    velocities: ClassVar[Sequence[str]] = ()
    inputs: ClassVar[Sequence[str]] = ()
    parameter_names: ClassVar[Sequence[str]] = ()
    frames: ClassVar[Sequence[str]] = ()
    outputs: ClassVar[Sequence[str]] = ()
    #: Units of the entries of `q`, `v` and `u`, and of the parameters.
    units: ClassVar[Units] = Units([], [], [], [])
    #: Numbers of entries of `q`, `v` and `u`.
    nq: ClassVar[int] = 0
    nv: ClassVar[int] = 0
    nu: ClassVar[int] = 0
    #: Equations of motion as text; empty if they are too long to be readable.
    equations: ClassVar[str] = ""
    #: Names of generated functions that Python cannot call.
    left_out: ClassVar[Sequence[str]] = ()
    _library: ClassVar[Any] = None
    _description: ClassVar[dict[str, Any]] = {}
    _functions: ClassVar[dict[str, Any]] = {}
    _path: ClassVar[Path] = Path()
    #: Source, if the class was compiled in this process.
    _source: ClassVar[dict[str, Any] | None] = None

    def __init__(self, parameters: Mapping[str, float] | None = None, /, *others: Any, **named: float) -> None:
        if self._library is None:
            raise TypeError("mechanisms are made by `linkwork.compile`")
        values = np.zeros(len(self.parameter_names), self._library.dtype)
        if self._library.defaults is not None:
            self._library.defaults(ctypes.c_void_p(address(values)))
        given = self._given(parameters, others, named)
        for name, value in given.items():
            values[index(self.parameter_names, name, "parameter")] = number(value, f"the parameter {name!r}")
        missing = [n for n, v in zip(self.parameter_names, values) if np.isnan(v) and n not in given]
        if missing:
            raise TypeError(f"{self.name} needs the parameters {', '.join(missing)}")
        values.flags.writeable = False
        self._values = values
        self._own = address(values) if len(values) else None
        if len(values) and self._library.validate(self._own) != 0:
            raise Error(self._library.why())

    @property
    def parameters(self) -> dict[str, float]:
        """Returns the values of the parameters by name."""
        return dict(zip(self.parameter_names, self._values.tolist()))

    def replace(self: M, parameters: Mapping[str, float] | None = None, /, *others: Any, **named: float) -> M:
        """Returns a copy of the mechanism with other values for some parameters."""
        return type(self)({**self.parameters, **self._given(parameters, others, named)})

    @classmethod
    def _given(cls, parameters: Any, others: tuple[Any, ...], named: dict[str, Any]) -> dict[str, Any]:
        """Returns the parameter values of a call by name, and rejects positional values."""
        if not others and (parameters is None or isinstance(parameters, Mapping)):
            return {**dict(parameters or {}), **named}
        words = [f"{name}=…" for name in cls.parameter_names if name.isidentifier()]
        if not cls.parameter_names:
            expected = f"no parameters: {cls.name}()"
        elif words:
            expected = f"its parameters by name: {cls.name}({', '.join(words[:4])}{', …' if len(words) > 4 else ''})"
        else:
            expected = f"its parameters in a dictionary: {cls.name}({{{cls.parameter_names[0]!r}: …}})"
        found = ", ".join(map(repr, (parameters, *others)))
        raise TypeError(f"{cls.name} takes {expected}; found {found}")

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"{self.name}({values if len(values) < 200 else '…'})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (str(self._path), self.parameters)

    @classmethod
    def _origin(cls) -> dict[str, Any]:
        """Returns the source of the class."""
        if cls._source is not None:
            return cls._source
        found: dict[str, Any] = json.loads(Path(cls._path).with_suffix(".json").read_text(encoding="utf-8"))
        return found

    @classmethod
    def stub(cls) -> str:
        """Returns the text of a stub file (NAME.pyi), with types and documentation for editors and type
        checkers."""
        lines = [
            "from collections.abc import Iterable, Mapping",
            "from typing import Any",
            "",
            "from numpy.typing import ArrayLike, NDArray",
            "",
            "import linkwork",
            "",
            f"class {cls.name}(linkwork.Mechanism):",
            f"    {quoted(cls.__doc__ or '')}",
        ]
        values = ", ".join(f"{name}: float = ..." for name in cls.parameter_names if name.isidentifier() and not keyword.iskeyword(name))
        star = f", *, {values}" if values else ""
        lines.append(f"    def __init__(self, parameters: Mapping[str, float] | None = None, /{star}) -> None: ...")
        kinds = {"frame": "str | int", "velocities": "str | int | Iterable[str | int]"}
        for name, about in cls._functions.items():
            if name not in cls.__dict__:
                continue
            arguments = "".join(f", {safe(a['name'])}: {_stub_type(a, kinds)}" for a in about["arguments"])
            position = f"{arguments}, /" if arguments else ""
            results = ["NDArray[Any]" if r["shape"] else "Any" for r in about["results"]]
            result = results[0] if len(results) == 1 else f"tuple[{', '.join(results)}]"
            lines.append(f"    def {name}(self{position}, *, threads: int | None = None, out: Any = None) -> {result}:")
            lines.append(f"        {quoted(getattr(cls, name).__doc__, 8)}")
        return "\n".join(lines) + "\n"

    @classmethod
    @checked
    def save(cls, folder: str | os.PathLike[str] = ".") -> Path:
        """Writes the class as a package to a folder: a module with its library and stubs, which depends only
        on NumPy. The package can be copied to machines without Linkwork and Rust that have the same operating
        system and the same kind of processor; compile with `native=False` for older processors.

        Returns:
            The folder of the package. Its name is that of the class in snake case: `CartPole` is imported
            from `cart_pole`.

        Raises:
            FileExistsError: a folder of this name exists that is not the package of a mechanism.
        """
        try:
            package = importlib.import_module("._package", __package__)
        except ImportError:
            raise Error("this is such a package already: copy its folder") from None

        written: Path = package.save(cls, folder)
        return written

    # Indices

    def index_q(self, name: str) -> int:
        """Returns the index of an entry of `q`, by its name."""
        return index(self.configuration, name, "coordinate")

    def index_v(self, name: str) -> int:
        """Returns the index of an entry of `v`, by its name."""
        return index(self.velocities, name, "velocity")

    def index_u(self, name: str) -> int:
        """Returns the index of an entry of `u`, by its name."""
        return index(self.inputs, name, "input")

    # Motions

    def _vector(self, value: Any, length: int, what: str) -> NDArray[Any]:
        if isinstance(value, Mapping):
            entries = ENTRIES[what]
            names = {"q": self.configuration, "v": self.velocities, "u": self.inputs}[entries]
            vector: NDArray[Any] = self._neutral() if entries == "q" else np.zeros(length, self._library.dtype)
            kind = {"q": "coordinate", "v": "velocity", "u": "input"}[entries]
            for name, entry in value.items():
                vector[index(names, name, kind)] = number(entry, f"the {kind} {name!r}")
            return vector
        vector = np.ascontiguousarray(numbers(value, self._library.dtype, what))
        if vector.shape != (length,):
            raise ValueError(f"{what} has {length} entries, found an array of shape {vector.shape}")
        return vector

    def _method(self, method: str | None, tolerance: float | None, step: float | None) -> tuple[str, float]:
        """Returns the integration method, and its tolerance or step size."""
        if method is None and self._description["contacts"]:
            method = "event_driven" if step is None else "time_stepping"
        elif method is None:
            method = "dormand_prince" if step is None else "rk4"
        if method not in _METHODS:
            raise Error(f"there is no method {method!r}{hint(method, list(_METHODS))}")
        given = {"step": step, "tolerance": tolerance}
        wanted = _METHODS[method]
        other = "tolerance" if wanted == "step" else "step"
        if given[other] is not None:
            of = ", ".join(name for name, setting in _METHODS.items() if setting == other)
            raise TypeError(f"the method {method} takes a `{wanted}`, not a `{other}`, which is for {of}")
        if wanted == "step" and step is None:
            raise TypeError(f"the method {method} needs a step")
        setting = number(given[wanted] if given[wanted] is not None else 1e-8, f"`{wanted}`")
        if not (setting > 0 and np.isfinite(setting)):
            raise ValueError(f"`{wanted}` is a positive number, found {setting!r}")
        return method, setting

    @checked
    def simulate(
        self,
        q: Entries | None = None,
        v: Entries | None = None,
        *,
        duration: float,
        every: float | None = None,
        start: float = 0.0,
        inputs: Entries | None = None,
        control: Callable[[float, NDArray[Any], NDArray[Any]], Entries] | None = None,
        period: float | None = None,
        method: str | None = None,
        tolerance: float | None = None,
        step: float | None = None,
    ) -> Run:
        """Simulates a motion.

        Args:
            q: initial configuration: an array, or values by name. The default is the neutral configuration.
            v: initial velocity: an array, or values by name. The default is zero.
            duration: duration, s.
            every: time between samples, s. The default is a hundredth of the duration.
            start: initial time, s.
            inputs: constant inputs: an array, or values by name.
            control: a function of `t, q, v` that returns the inputs, instead of constant inputs.
            period: time between calls of `control`, s; the inputs are constant in between. Without it,
                `control` is called at every evaluation of the dynamics, and must be continuous.
            method: integration method. Methods with a `tolerance` are `"dormand_prince"`,
                `"dormand_prince8"`, `"rodas"` (for stiff equations) and, with contacts, `"event_driven"`.
                Methods with a `step` are `"rk4"`, `"implicit_midpoint"` and, with contacts,
                `"time_stepping"` and `"time_stepping_midpoint"`; the latter needs two evaluations of the
                dynamics per step instead of four. The default is `"dormand_prince"`, or `"event_driven"`
                with contacts; if `step` is specified, it is `"rk4"`, or `"time_stepping"` with contacts.
            tolerance: relative and absolute error of a step; the default is 1e-8.
            step: step size, s.

        Raises:
            Error: the motion cannot be continued; the attribute `run` has the samples so far.
        """
        library = self._library
        first_q = self._neutral() if q is None else self._vector(q, self.nq, "q")
        first_v = np.zeros(self.nv, library.dtype) if v is None else self._vector(v, self.nv, "v")
        duration = number(duration, "`duration`")
        if not (duration >= 0 and np.isfinite(duration)):
            raise ValueError(f"the duration is a time in seconds, found {duration!r}")
        every = number(every, "`every`") if every is not None else (duration / 100 or 1.0)
        if not (every > 0 and np.isfinite(every)):
            raise ValueError(f"`every` is a positive time in seconds, found {every!r}")
        period = number(period, "`period`") if period is not None else None
        if period is not None and not (period > 0 and np.isfinite(period)):
            raise ValueError(f"`period` is a positive time in seconds, found {period!r}")
        if inputs is not None and control is not None:
            raise TypeError("give either constant inputs or a function `control`")
        if control is not None and not callable(control):
            raise TypeError(f"`control` is a function of t, q, v that returns the inputs, found {control!r}")
        if control is not None and not self.nu:
            raise TypeError(f"{self.name} has no inputs that `control` could give")
        if period is not None and control is None:
            raise TypeError("`period` is the time between calls of `control`, and there is none; samples stand `every` so often")
        method, setting = self._method(method, tolerance, step)
        if inputs is not None:
            constant = self._vector(inputs, self.nu, "u")
            control, period = (lambda t, q, v: constant), every
        raised: list[BaseException] = []
        size = library.dtype.itemsize

        def asked(_user: Any, t: float, q: int, v: int, u: int) -> int:
            try:
                assert control is not None
                own_q, own_v = np.empty(self.nq, library.dtype), np.empty(self.nv, library.dtype)
                ctypes.memmove(address(own_q), q, self.nq * size)
                ctypes.memmove(address(own_v), v, self.nv * size)
                returned = control(t, own_q, own_v)
                if returned is None:
                    raise TypeError("`control` returned nothing")
                found = self._vector(returned, self.nu, "u")
                ctypes.memmove(u, address(found), self.nu * size)
                return 0
            except BaseException as error:  # Cannot pass the library; raised again below.
                raised.append(error)
                return 1

        pointer: Any = library.Control(asked) if control is not None else None
        settings = library.Settings(
            number(start, "`start`"), duration, every, method.encode(), setting, period or 0.0, ctypes.cast(pointer, ctypes.c_void_p), None
        )
        rows = int(np.floor(duration / every * (1 + 1e-9))) + 3
        samples = np.empty((rows, 1 + self.nq + self.nv + self.nu), library.dtype)
        count = ctypes.c_size_t()
        code = library.simulate(
            self._own,
            address(first_q),
            address(first_v),
            ctypes.addressof(settings),
            address(samples),
            rows,
            ctypes.addressof(count),
        )
        done = samples[: count.value]
        at = np.cumsum([1, self.nq, self.nv])
        run = Run(self, done[:, 0], done[:, 1 : at[1]], done[:, at[1] : at[2]], done[:, at[2] :])
        if raised:
            raise raised[0]
        if code != 0:
            error = Error(library.why())
            error.run = run
            raise error
        return run

    @checked
    def roll_out(
        self,
        q: ArrayLike,
        v: ArrayLike,
        inputs: ArrayLike | None = None,
        *,
        steps: int | None = None,
        h: float,
        start: float = 0.0,
        threads: int = 0,
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Simulates many motions by steps of the classical Runge–Kutta method, eight states at a time and on
        all processors. Other threads of Python continue meanwhile.

        Args:
            q: initial configurations, (N, nq).
            v: initial velocities, (N, nv).
            inputs: inputs, constant during each step: (steps, nu) for all states, or (N, steps, nu) for each
                state. The default is zero.
            steps: number of steps; may be omitted if there are inputs.
            h: step size, s.
            start: initial time, s.
            threads: number of threads; 0 for the number of processors. Results do not depend on it.

        Returns:
            Configurations (N, steps + 1, nq) and velocities (N, steps + 1, nv), including the initial ones.
        """
        library = self._library
        first_q, first_v = numbers(q, library.dtype, "q"), numbers(v, library.dtype, "v")
        if first_q.ndim != 2 or first_q.shape[1] != self.nq or first_v.shape != (len(first_q), self.nv):
            raise ValueError(
                f"expected arrays of shapes (N, {self.nq}) and (N, {self.nv}), found {first_q.shape} and {first_v.shape}"
            )
        n, kind, held = len(first_q), 0, None
        steps = None if steps is None else count(steps, "steps")
        threads = count(threads, "threads")
        if inputs is not None:
            held = np.ascontiguousarray(numbers(inputs, library.dtype, "inputs"))
            found = held.shape[-2] if held.ndim >= 2 else None
            if steps is not None and found is not None and steps != found:
                raise ValueError(f"there are inputs of {found} steps, not of {steps}")
            steps = found
            if held.shape == (steps, self.nu):
                kind = 1
            elif held.shape == (n, steps, self.nu):
                kind = 2
            else:
                raise ValueError(f"inputs have the shape (steps, {self.nu}) or ({n}, steps, {self.nu}), not {held.shape}")
        if steps is None:
            raise TypeError("give the number of `steps`, or `inputs` for each of them")
        all_q = np.empty((n, steps + 1, self.nq), library.dtype)
        all_v = np.empty((n, steps + 1, self.nv), library.dtype)
        all_q[:, 0], all_v[:, 0] = first_q, first_v
        settings = library.Rollout(number(start, "`start`"), number(h, "`h`"), steps, n, threads, kind)
        given = address(held) if held is not None else None
        code = library.roll_out(self._own, ctypes.addressof(settings), given, address(all_q), address(all_v))
        if code != 0:
            error = Error(library.why())
            error.q, error.v = all_q, all_v
            raise error
        return all_q, all_v

    # Steady states and linear systems

    @checked
    def equilibrium(
        self,
        q: Entries | None = None,
        inputs: Entries | None = None,
        *,
        held: str | int | Iterable[str | int] = (),
        tolerance: float = 1e-12,
        iterations: int = 50,
    ) -> NDArray[Any]:
        """Returns an equilibrium configuration near `q` under constant inputs, by Newton's method with step
        halving and generated derivatives. The configuration satisfies the constraints, whose multipliers are
        solved for at the same time; derivatives of the constraint forces are differences of the generated
        Jacobian. Joint limits are ignored: an equilibrium far from `q` may violate them.

        Args:
            q: initial guess: an array, or values by name.
            inputs: constant inputs: an array, or values by name.
            held: names or indices of velocities whose coordinates are fixed.
            tolerance: change of the coordinates, relative to one plus their magnitude, at which the iteration
                ends.
            iterations: maximum number of iterations.

        Raises:
            Error: no equilibrium was found nearby, or the mechanism has contacts or no derivatives.
        """
        if self._description["contacts"]:
            raise Error("equilibria at contacts are found by the crate linkwork-design")
        self._need("inverse_dynamics_derivatives", "derivatives")
        first = self._neutral() if q is None else self._vector(q, self.nq, "q")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        free = marked(held, self.velocities, self._library.dtype) == 0
        tolerance, iterations = number(tolerance, "`tolerance`"), count(iterations, "iterations")
        return find(Rest(self, u, free), first, tolerance, iterations) if free.any() else first

    @checked
    def linear_system(
        self, q: Entries, v: Entries | None = None, inputs: Entries | None = None, *, t: float = 0.0
    ) -> LinearSystem:
        """Returns the linear system about a state, which must satisfy the constraints. About a state that is
        not an equilibrium, A and B describe deviations from the motion. By default, every joint of a robot
        file has an input; the option `inputs` changes this.

        Raises:
            Error: the mechanism was compiled without derivatives, or the configuration violates the
                constraints; `assemble` returns one that satisfies them.
        """
        self._need("linearize", "derivatives")
        time = [number(t, "`t`")] if self._description["time"] else []
        at_q = self._vector(q, self.nq, "q")
        if "constraint_residuals" in self._functions:
            off = float(np.abs(self._call("constraint_residuals", *time, at_q)).max(initial=0))
            if not off <= 1e-6:
                raise Error(f"the configuration is off the constraints by {off:.3g} (m, rad): `assemble` brings it onto them")
        at_v = np.zeros(self.nv) if v is None else self._vector(v, self.nv, "v")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        if self._description["constraints"]:
            a, b, coordinates, speeds = self._call("linearize", *time, at_q, at_v, u, [])
            names = [self.velocities[int(k)] for k in coordinates]
            names += [f"{self.velocities[int(k)]}.rate" for k in speeds]
        else:
            a, b = self._call("linearize", *time, at_q, at_v, u)
            names = list(self.velocities) + [f"{name}.rate" for name in self.velocities]
        return LinearSystem(a, b, names, list(self.inputs))

    def _call(self, name: str, *arguments: Any) -> Any:
        """Calls a generated function by its name."""
        return getattr(self, name)(*arguments)

    def _neutral(self) -> NDArray[Any]:
        """Returns the neutral configuration, in which all coordinates are zero."""
        return np.array(self._call("neutral"))

    def _forces(self, time: list[float], q: NDArray[Any], v: NDArray[Any], u: NDArray[Any]) -> Any:
        if not self.nu:
            return np.zeros(self.nv)
        given = [q, v, u] if self._takes("generalized_forces", "v") else [q, u]
        return self._call("generalized_forces", *time, *given)

    def _takes(self, function: str, argument: str) -> bool:
        return any(a["name"] == argument for a in self._functions[function]["arguments"])

    def _need(self, function: str, word: str) -> None:
        if function not in self._functions:
            raise Error(f"this needs the function `{function}`: compile with `{word}=True`")


def _stub_type(argument: dict[str, Any], kinds: dict[str, str]) -> str:
    """Returns the type of an argument in a stub."""
    by_name = argument["kind"] == "array" and argument["name"] in ENTRIES
    return "ArrayLike | Mapping[str, float]" if by_name else kinds.get(argument["kind"], "ArrayLike")


def _documentation(description: dict[str, Any]) -> str:
    """Returns the documentation of a class: the documentation of the struct, then tables of the coordinates,
    inputs, parameters and outputs."""
    limits = {limit["index"]: limit for limit in description["limits"]}
    shown: Callable[[Any], str] = lambda value: "" if value is None else value if isinstance(value, str) else f"{value:g}"
    velocities = []
    for k, entry in enumerate(description["velocities"]):
        limit = limits.get(k, {})
        bounds = [shown(limit.get(key)) for key in ("lower", "upper", "velocity", "effort")]
        velocities.append([entry["name"], entry["unit"], *bounds])
    head = ["name", "unit", "lower limit", "upper limit", "velocity limit", "effort limit"]
    named: Callable[[str], list[list[str]]] = lambda key: [[entry["name"], entry["unit"]] for entry in description[key]]
    tables = [
        ("Configuration `q`", ["name", "unit"], named("configuration")),
        ("Velocities `v`, with the limits of the joints in SI units", head, velocities),
        ("Inputs `u`", ["name", "unit"], named("inputs")),
        ("Parameters", ["name", "unit"], named("parameters")),
        ("Outputs", ["name", "unit"], named("outputs")),
    ]
    parts = [description["documentation"] or f"The mechanism {description['name']}."]
    parts += [f"{title}:\n{_align_columns([head, *rows])}" for title, head, rows in tables if rows]
    if description["frames"]:
        parts.append(f"Frames: {', '.join(description['frames'])}.")
    return "\n\n".join(parts)


def _align_columns(rows: list[list[str]]) -> str:
    """Formats rows of text as aligned columns. Empty columns are omitted."""
    columns = [column for column in zip(*rows) if any(column[1:])]
    widths = [max(map(len, column)) for column in columns]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths)).rstrip() for row in zip(*columns)]
    return "\n".join(f"    {line}" for line in lines)


def _restore(path: str, parameters: dict[str, float]) -> "Mechanism":
    """Returns an unpickled mechanism."""
    return load(Path(path))(parameters)


def _reduce_class(kind: Any) -> Any:
    return (load, (kind._path,)) if kind._library is not None else kind.__qualname__


copyreg.pickle(_Kind, _reduce_class)

if TYPE_CHECKING:

    class Compiled(Mechanism):
        """Mechanism with generated functions, whose names type checkers cannot know."""

        def __getattr__(self, name: str) -> Any: ...

else:
    Compiled = Mechanism


def load(path: Path) -> type[Compiled]:
    """Returns the class of a compiled library."""
    library = Library(path)
    d = library.description
    names: Callable[[str], list[str]] = lambda key: [entry["name"] for entry in d[key]]
    units: Callable[[str], list[str]] = lambda key: [entry["unit"] for entry in d[key]]
    members = {
        "__doc__": _documentation(d),
        "__module__": "linkwork",
        "name": d["name"],
        "configuration": names("configuration"),
        "velocities": names("velocities"),
        "inputs": names("inputs"),
        "parameter_names": names("parameters"),
        "outputs": names("outputs"),
        "frames": d["frames"],
        "units": Units(units("configuration"), units("velocities"), units("inputs"), units("parameters")),
        "nq": len(d["configuration"]),
        "nv": len(d["velocities"]),
        "nu": len(d["inputs"]),
        "equations": d["equations"],
        "left_out": d["left_out"],
        "_library": library,
        "_description": d,
        "_path": path,
        "_functions": {f["name"]: f for f in d["functions"]},
    }
    for k, about in enumerate(d["functions"]):
        if about["name"] not in members and not hasattr(Mechanism, about["name"]):
            members[about["name"]] = function(library, k, about, d["name"])
    kind: Any = _Kind(d["name"], (Compiled,), members)
    made: type[Compiled] = kind
    return made
