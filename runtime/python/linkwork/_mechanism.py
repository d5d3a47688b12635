"""Python classes of compiled mechanisms."""

import copyreg
import keyword
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._equilibrium import Rest, find
from . import _native
from ._functions import ENTRIES, marked, prepare, quoted
from ._linear import at_rest
from ._names import Error, checked, count, hint, index, number, numbers, safe
from ._native import Function, Robot
from ._origin import locate
from ._results import LinearSystem, Run, Units

#: Type variable of mechanism classes.
M = TypeVar("M", bound="Mechanism")
#: Vector: an array, or values by name.
Entries = ArrayLike | Mapping[str, float]
#: Integration methods, with the setting that determines their accuracy.
_METHODS = {
    "automatic": "tolerance",
    "dormand_prince": "tolerance",
    "dormand_prince8": "tolerance",
    "rodas": "tolerance",
    "event_driven": "tolerance",
    "rk4": "step",
    "implicit_midpoint": "step",
    "rosenbrock": "step",
    "semi_implicit_euler": "step",
    "time_stepping": "step",
    "time_stepping_midpoint": "step",
    "time_stepping_leapfrog": "step",
}


class _Kind(type):
    """Metaclass of mechanisms, whose classes are pickled as their sources."""


class _Equations:
    """Equations of motion as text, which are derived when they are first read."""

    def __get__(self, instance: object, owner: Any) -> str:
        if "_printed" not in owner.__dict__:
            owner._printed = _native.load(**locate(owner._origin), equations=True).equations if owner._origin else ""
        printed: str = owner._printed
        return printed


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
    equations: ClassVar[_Equations] = _Equations()
    #: Loaded mechanism without values of its parameters.
    _loaded: ClassVar[Robot | None] = None
    _description: ClassVar[dict[str, Any]] = {}
    _functions: ClassVar[dict[str, Function]] = {}
    #: Source of the class.
    _origin: ClassVar[dict[str, Any]] = {}
    #: Loaded mechanism with values of its parameters.
    _robot: Robot

    def __init__(self, parameters: Mapping[str, Any] | None = None, /, *others: Any, **named: Any) -> None:
        if self._loaded is None:
            raise TypeError("mechanisms are made by `linkwork.compile`")
        given = self._given(parameters, others, named)
        values: list[Any] = self._loaded.parameters()[0].tolist()
        states = None
        for name, value in given.items():
            k = index(self.parameter_names, name, "parameter")
            values[k] = _parameter(name, value)
            if values[k].ndim:
                if states is not None and states != len(values[k]):
                    raise ValueError(f"parameters of {states} and of {len(values[k])} states")
                states = len(values[k])
        missing = [n for n, v in zip(self.parameter_names, values) if n not in given and np.isnan(v)]
        if missing:
            raise TypeError(f"{self.name} needs the parameters {', '.join(missing)}")
        sets = np.empty((1 if states is None else states, len(values)))
        for k, value in enumerate(values):
            sets[:, k] = value
        self._robot = self._loaded.with_parameters(sets, states is not None)

    @classmethod
    def _of(cls: type[M], robot: Robot) -> M:
        """Returns a mechanism with the values of the parameters of a loaded one."""
        made = object.__new__(cls)
        made._robot = robot
        return made

    @property
    def _sets(self) -> int | None:
        return self._robot.parameter_set_count

    @property
    def parameters(self) -> dict[str, Any]:
        """Returns the values of the parameters by name: numbers, or arrays with one value for each state."""
        values = self._robot.parameters()
        if self._sets is None:
            return dict(zip(self.parameter_names, values[0].tolist()))
        is_common = [(column == column[0]).all() if len(column) else False for column in values.T]
        # One array at least says how many states there are.
        is_common[:1] = [is_common[0] and not all(is_common)] if is_common else []
        columns = zip(values.T, is_common)
        return dict(zip(self.parameter_names, [column[0].item() if common else column for column, common in columns]))

    def replace(self: M, parameters: Mapping[str, Any] | None = None, /, *others: Any, **named: Any) -> M:
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
        shown: Callable[[Any], str] = lambda value: f"<{len(value)} values>" if isinstance(value, np.ndarray) else repr(value)
        values = ", ".join(f"{name}={shown(value)}" for name, value in self.parameters.items())
        return f"{self.name}({values if len(values) < 200 else '…'})"

    def __reduce__(self) -> tuple[Any, ...]:
        return _restore, (self._origin, self.parameters)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(name)
            if name in _ABSENT:
                raise AttributeError(f"{self.name} has no function {name!r}: {_ABSENT[name]}")
            raise AttributeError(f"{self.name} has no function {name!r}{hint(name, list(self._functions))}")

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
        values = ", ".join(f"{name}: ArrayLike = ..." for name in cls.parameter_names if name.isidentifier() and not keyword.iskeyword(name))
        star = f", *, {values}" if values else ""
        lines.append(f"    def __init__(self, parameters: Mapping[str, Any] | None = None, /{star}) -> None: ...")
        for name, function in cls._functions.items():
            if name not in cls.__dict__:
                continue
            arguments = "".join(f", {safe(a)}: {_stub_type(a, shape)}" for a, shape in function.arguments)
            position = f"{arguments}, /" if arguments else ""
            results = ["NDArray[Any]" if shape else "Any" for _, shape in function.results]
            result = results[0] if len(results) == 1 else f"tuple[{', '.join(results)}]"
            lines.append(f"    def {name}(self{position}, *, threads: int | None = None, out: Any = None) -> {result}:")
            lines.append(f"        {quoted(getattr(cls, name).__doc__, 8)}")
        return "\n".join(lines) + "\n"

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

    # Limits

    def lower_limits(self) -> NDArray[Any]:
        """Returns the lower bounds of the coordinates, in the order of `v`; minus infinity without a bound."""
        return self._limits(1, -np.inf)

    def upper_limits(self) -> NDArray[Any]:
        """Returns the upper bounds of the coordinates, in the order of `v`; infinity without a bound."""
        return self._limits(2, np.inf)

    def velocity_limits(self) -> NDArray[Any]:
        """Returns the maximum velocities in both directions; infinity without a bound."""
        return self._limits(3, np.inf)

    def effort_limits(self) -> NDArray[Any]:
        """Returns the maximum forces and torques in both directions; infinity without a bound."""
        return self._limits(4, np.inf)

    def clamp_configuration(self, q: ArrayLike) -> NDArray[Any]:
        """Returns configurations within their bounds."""
        found = np.array(numbers(q, np.float64, "q"))
        bounds = zip(self.velocities, self.lower_limits(), self.upper_limits())
        for name, lower, upper in bounds:
            if name in self.configuration:
                k = self.index_q(name)
                found[..., k] = found[..., k].clip(lower, upper)
        return found

    def clamp_velocity(self, v: ArrayLike) -> NDArray[Any]:
        """Returns velocities within their bounds."""
        found: NDArray[Any] = np.clip(numbers(v, np.float64, "v"), -self.velocity_limits(), self.velocity_limits())
        return found

    def clamp_effort(self, tau: ArrayLike) -> NDArray[Any]:
        """Returns forces and torques within their bounds."""
        found: NDArray[Any] = np.clip(numbers(tau, np.float64, "tau"), -self.effort_limits(), self.effort_limits())
        return found

    def _limits(self, which: int, default: float) -> NDArray[Any]:
        values = np.full(self.nv, default)
        for limit in self._robot.limits():
            values[limit[0]] = limit[which]
        return values

    # Motions

    def initial_configuration(self) -> NDArray[Any]:
        """Returns the configuration in which simulations begin.

        It is the neutral configuration. Classes of robot files that place free bodies, or have joints with a
        `ref`, override it: free bodies are where the file places them.
        """
        return np.array(self._call("neutral"))

    def _vector(self, value: Any, length: int, what: str) -> NDArray[Any]:
        if isinstance(value, Mapping):
            entries = ENTRIES[what]
            names = {"q": self.configuration, "v": self.velocities, "u": self.inputs}[entries]
            vector: NDArray[Any] = self.initial_configuration() if entries == "q" else np.zeros(length)
            kind = {"q": "coordinate", "v": "velocity", "u": "input"}[entries]
            for name, entry in value.items():
                vector[index(names, name, kind)] = number(entry, f"the {kind} {name!r}")
            return vector
        vector = np.ascontiguousarray(numbers(value, np.float64, what))
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
            q: initial configuration: an array, or values by name. The default is `initial_configuration()`, which
                also has the values that are not named.
            v: initial velocity: an array, or values by name. The default is zero.
            duration: duration, s.
            every: time between samples, s. The default is a hundredth of the duration.
            start: initial time, s.
            inputs: constant inputs: an array, or values by name.
            control: a function of `t, q, v` that returns the inputs, instead of constant inputs.
            period: time between calls of `control`, s; the inputs are constant in between. Without it,
                `control` is called at every evaluation of the dynamics, and must be continuous.
            method: integration method. Methods with a `tolerance` are `"dormand_prince"`,
                `"dormand_prince8"`, `"rodas"` (for stiff equations), `"automatic"` (Dormand–Prince, and Rodas
                from where the motion is stiff) and, with contacts, `"event_driven"`. Methods with a `step` are
                `"rk4"`, `"implicit_midpoint"`, `"rosenbrock"`, `"semi_implicit_euler"` and, with contacts,
                `"time_stepping"`, `"time_stepping_midpoint"` and `"time_stepping_leapfrog"`, with four, two
                evaluations and one of the dynamics per step. The default is `"dormand_prince"`, or
                `"event_driven"` with contacts; if `step` is specified, it is `"rk4"`, or `"time_stepping"` with contacts.
            tolerance: relative and absolute error of a step; the default is 1e-8.
            step: step size, s.

        Raises:
            Error: the motion cannot be continued; the attribute `run` has the samples so far.
        """
        if self._sets is not None:
            raise TypeError("a simulation has one value of each parameter; `roll_out` takes one for each state")
        first_q = self.initial_configuration() if q is None else self._vector(q, self.nq, "q")
        first_v = np.zeros(self.nv) if v is None else self._vector(v, self.nv, "v")
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
            raise TypeError("`period` is the time between calls of `control`, and there is none; `every` is the time between samples")
        method, setting = self._method(method, tolerance, step)
        constant = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")

        def inputs_at(t: float, q: NDArray[Any], v: NDArray[Any]) -> list[float]:
            assert control is not None
            returned = control(t, q, v)
            if returned is None:
                raise TypeError("`control` returned nothing")
            found: list[float] = self._vector(returned, self.nu, "u").tolist()
            return found

        samples, reason, raised = _native.simulate(
            self._robot,
            first_q.tolist(),
            first_v.tolist(),
            start=number(start, "`start`"),
            duration=duration,
            every=every,
            method=method,
            setting=setting,
            period=period,
            inputs=constant.tolist(),
            control=None if control is None else inputs_at,
        )
        at = np.cumsum([1, self.nq, self.nv, self._description["states"]])
        parts = np.split(samples, at, axis=1)
        run = Run(self, parts[0][:, 0], parts[1], parts[2], parts[4], parts[3])
        if raised is not None:
            raise raised
        if reason is not None:
            error = Error(reason)
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
        """Simulates many motions by steps of the classical Runge–Kutta method on all processors. Other threads of
        Python continue meanwhile. If the mechanism has arrays of parameters, each state has its own values. States
        of mechanisms with constraints satisfy them after each step; mechanisms with contacts move by time stepping.

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
        first_q, first_v = numbers(q, np.float64, "q"), numbers(v, np.float64, "v")
        if first_q.ndim != 2 or first_q.shape[1] != self.nq or first_v.shape != (len(first_q), self.nv):
            raise ValueError(
                f"expected arrays of shapes (N, {self.nq}) and (N, {self.nv}), found {first_q.shape} and {first_v.shape}"
            )
        n, held = len(first_q), None
        steps = None if steps is None else count(steps, "steps")
        threads = count(threads, "threads")
        if self._sets is not None and self._sets != n:
            raise ValueError(f"parameters of {self._sets} states, but {n} states")
        if inputs is not None:
            held = np.ascontiguousarray(numbers(inputs, np.float64, "inputs"))
            found = held.shape[-2] if held.ndim >= 2 else None
            if steps is not None and found is not None and steps != found:
                raise ValueError(f"there are inputs of {found} steps, not of {steps}")
            steps = found
            if held.shape not in [(steps, self.nu), (n, steps, self.nu)]:
                raise ValueError(f"inputs have the shape (steps, {self.nu}) or ({n}, steps, {self.nu}), not {held.shape}")
            held = held if held.ndim == 3 else held[np.newaxis]
        if steps is None:
            raise TypeError("give the number of `steps`, or `inputs` for each of them")
        all_q, all_v = np.empty((n, steps + 1, self.nq)), np.empty((n, steps + 1, self.nv))
        all_q[:, 0], all_v[:, 0] = first_q, first_v
        try:
            self._robot.roll_out(
                all_q, all_v, held, start=number(start, "`start`"), h=number(h, "`h`"), threads=threads
            )
        except Error as error:
            error.q, error.v = all_q, all_v
            raise
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
        first = self.initial_configuration() if q is None else self._vector(q, self.nq, "q")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        free = marked(held, self.velocities) == 0
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
            Error: the mechanism was loaded without derivatives, or the configuration violates the constraints
                (`assemble` returns one that satisfies them), or moves under constraints.
        """
        constrained = bool(self._description["constraints"])
        self._need("forward_dynamics_derivatives" if constrained else "linearize", "derivatives")
        time = [number(t, "`t`")] if self._description["time"] else []
        at_q = self._vector(q, self.nq, "q")
        at_v = np.zeros(self.nv) if v is None else self._vector(v, self.nv, "v")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        if constrained:
            if "constraint_residuals" in self._functions:
                off = float(np.abs(self._call("constraint_residuals", *time, at_q)).max(initial=0))
                if not off <= 1e-6:
                    raise Error(f"the configuration violates the constraints by {off:.3g} (m, rad): `assemble` projects it onto them")
            if at_v.any():
                raise Error("linear systems of mechanisms with constraints are about states at rest")
            a, b, coordinates, speeds = at_rest(self, time, at_q, u)
            names = [self.velocities[k] for k in coordinates]
            names += [f"{self.velocities[k]}.rate" for k in speeds]
        else:
            a, b = self._call("linearize", *time, at_q, at_v, u)
            names = list(self.velocities) + [f"{name}.rate" for name in self.velocities]
        return LinearSystem(a, b, names, list(self.inputs))

    def _call(self, name: str, *arguments: Any) -> Any:
        """Calls a generated function by its name."""
        return getattr(self, name)(*arguments)

    def _forces(self, time: list[float], q: NDArray[Any], v: NDArray[Any], u: NDArray[Any]) -> Any:
        if not self.nu:
            return np.zeros(self.nv)
        given = [q, v, u] if self._takes("generalized_forces", "v") else [q, u]
        return self._call("generalized_forces", *time, *given)

    def _takes(self, function: str, argument: str) -> bool:
        return any(name == argument for name, _ in self._functions[function].arguments)

    def _need(self, function: str, word: str) -> None:
        if function not in self._functions:
            raise Error(f"this needs the function `{function}`: {_ABSENT.get(function, f'compile with `{word}=True`')}")


def _parameter(name: str, value: Any) -> NDArray[Any]:
    """Converts the value of a parameter to an array: a number, or one value for each state."""
    if np.ndim(value) == 1 and not isinstance(value, (str, bytes)):
        array = numbers(value, np.float64, f"the parameter {name!r}")
        if np.shape(value)[0] != 1 or isinstance(value, np.ndarray):
            return array
    return np.array(number(value, f"the parameter {name!r}"))


#: Functions of mechanisms in Rust that loaded mechanisms lack.
_ABSENT = {
    "assemble": "it has no constraints",
    "linearize": "it needs `derivatives=True`, and a mechanism without constraints",
    "forward_dynamics_derivatives": "it needs `derivatives=True`",
    "transition": "it needs `derivatives=True`, and a mechanism without constraints, contacts and states of first order",
    "step": "steps need a mechanism without constraints, contacts and states of first order",
}


def _stub_type(argument: str, shape: list[int] | None) -> str:
    """Returns the type of an argument in a stub."""
    if argument == "held":
        return "str | int | Iterable[str | int]"
    return "str | int" if shape is None else "ArrayLike | Mapping[str, float]" if argument in ENTRIES else "ArrayLike"


def _documentation(description: dict[str, Any], robot: Robot) -> str:
    """Returns the documentation of a class: the documentation of the struct, then tables of the coordinates,
    inputs, parameters and outputs."""
    try:
        limits = {index: bounds for index, *bounds in robot.limits()}
    except Error:
        # They depend on parameters.
        limits = {}
    shown: Callable[[float], str] = lambda value: f"{value:g}" if np.isfinite(value) else ""
    velocities = []
    for k, (name, unit) in enumerate(description["velocities"]):
        velocities.append([name, unit, *map(shown, limits.get(k, [np.inf] * 4))])
    head = ["name", "unit", "lower limit", "upper limit", "velocity limit", "effort limit"]
    named: Callable[[str], list[list[str]]] = lambda key: [list(entry) for entry in description[key]]
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


def _class(origin: dict[str, Any]) -> "type[Compiled]":
    """Returns an unpickled class."""
    from ._load import restore

    return restore(origin)


def _restore(origin: dict[str, Any], parameters: dict[str, Any]) -> "Mechanism":
    """Returns an unpickled mechanism."""
    return _class(origin)(parameters)


def _reduce_class(kind: Any) -> Any:
    return (_class, (kind._origin,)) if kind._loaded is not None else kind.__qualname__


copyreg.pickle(_Kind, _reduce_class)

if TYPE_CHECKING:

    class Compiled(Mechanism):
        """Mechanism with its functions, whose names type checkers cannot know."""

        def __getattr__(self, name: str) -> Any: ...

else:
    Compiled = Mechanism


def kind(robot: Robot, origin: dict[str, Any]) -> "type[Compiled]":
    """Returns the class of a loaded mechanism."""
    d = robot.describe()
    names: Callable[[str], list[str]] = lambda key: [name for name, _ in d[key]]
    units: Callable[[str], list[str]] = lambda key: [unit for _, unit in d[key]]
    functions = {function.name_and_documentation[0]: function for function in robot.functions()}
    members = {
        "__doc__": _documentation(d, robot),
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
        "_loaded": robot,
        "_description": d,
        "_origin": origin,
        "_functions": functions,
    }
    outputs = dict(d["outputs"])
    for name, function in functions.items():
        prepare(function, d["name"], outputs.get(name, ""))
        if name not in members and not hasattr(Mechanism, name):
            members[name] = function
    made: Any = _Kind(d["name"], (Compiled,), members)
    result: type[Compiled] = made
    return result
