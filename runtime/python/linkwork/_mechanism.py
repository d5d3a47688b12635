"""Compiled mechanisms as classes of Python."""

import csv
import ctypes
import difflib
import html
import inspect
import json
import keyword
import webbrowser
from dataclasses import dataclass
from pathlib import Path

import numpy as np


class Error(Exception):
    """What Linkwork cannot do, in its words."""


@dataclass(frozen=True)
class Page:
    """A page of HTML that shows a motion and opens offline. Notebooks show it in place."""

    #: Where it is.
    path: Path

    def _repr_html_(self):
        text = html.escape(Path(self.path).read_text(encoding="utf-8"), quote=True)
        return f'<iframe srcdoc="{text}" width="100%" height="560" frameborder="0"></iframe>'

    def open(self):
        """Opens it in the browser."""
        webbrowser.open(Path(self.path).resolve().as_uri())


@dataclass(frozen=True)
class Run:
    """A motion: samples of time, configuration, velocity and inputs, a row each."""

    mechanism: "Mechanism"
    #: Times, s.
    t: np.ndarray
    #: Configurations, a row for each time.
    q: np.ndarray
    #: Velocities, a row for each time.
    v: np.ndarray
    #: Inputs, a row for each time.
    u: np.ndarray

    def __len__(self):
        return len(self.t)

    def csv(self, path):
        """Writes the samples as comma-separated values with the columns t, q.…, v.…, u.…, which `linkwork view --motion` reads."""
        m = self.mechanism
        head = ["t"] + [f"q.{n}" for n in m.configuration]
        head += [f"v.{n}" for n in m.velocities] + [f"u.{n}" for n in m.inputs]
        with open(path, "w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(head)
            writer.writerows(np.column_stack([self.t, self.q, self.v, self.u]).tolist())

    def view(self, path=None) -> Page:
        """Writes a page that shows the motion, and opens offline: to `path`, or to the mechanism's name with .html."""
        try:
            from ._build import view
        except ImportError:
            raise Error("pages are made by the package `linkwork`, which this package does not need otherwise") from None

        path = Path(path if path is not None else f"{self.mechanism.name}.html")
        view(self.mechanism._origin(), self, path)
        return Page(path)

    def plot(self, *names, ax=None):
        """Draws entries of the motion over time with matplotlib: of the configuration by default, or those that are named
        (`"hinge"`, `"v.hinge"`, `"u.motor"`). Returns the axes."""
        import matplotlib.pyplot as plt

        m = self.mechanism
        ax = ax if ax is not None else plt.subplots()[1]
        for name in names or m.configuration:
            kind, rest = name.split(".", 1) if name[:2] in ("q.", "v.", "u.") else ("q", name)
            lists = {"q": m.configuration, "v": m.velocities, "u": m.inputs}
            k = _index(lists[kind], rest, {"q": "coordinate", "v": "velocity", "u": "input"}[kind])
            unit = {"q": m.units.configuration, "v": m.units.velocities, "u": m.units.inputs}[kind][k]
            ax.plot(self.t, getattr(self, kind)[:, k], label=f"{name} [{unit}]" if unit else name)
        ax.set_xlabel("t [s]")
        ax.legend()
        return ax


@dataclass(frozen=True)
class LinearSystem:
    """x' = A x + B u about a state: displacements of the configuration, then changes of the velocity, each in the order of `v`."""

    a: np.ndarray
    b: np.ndarray
    #: Names of the states.
    states: list
    #: Names of the inputs.
    inputs: list

    def control(self, c=None, d=None):
        """The system in the type of the package python-control, with all states as outputs if no others are given."""
        import control

        c = np.eye(len(self.a)) if c is None else c
        d = np.zeros((np.shape(c)[0], self.b.shape[1])) if d is None else d
        return control.ss(self.a, self.b, c, d)


@dataclass(frozen=True)
class Units:
    """Units of all entries, in their order."""

    configuration: list
    velocities: list
    inputs: list
    parameters: list


def _index(names, name, what):
    """The index of a name in a list of names."""
    if name in names:
        return names.index(name)
    near = difflib.get_close_matches(str(name), names, n=3)
    hint = f": did you mean {', '.join(map(repr, near))}?" if near else f"; there are {', '.join(names) or 'none'}"
    raise KeyError(f"there is no {what} {name!r}{hint}")


class _Rest:
    """The equations of a mechanism at rest under inputs, of those velocities that are free: forces and those of the constraints
    balance, and the constraints hold."""

    def __init__(self, mechanism, inputs, free):
        self.m, self.u, self.free = mechanism, inputs, free
        self.zero = np.zeros(mechanism.nv)
        self.time = [0.0] if mechanism._description["time"] else []
        self.is_constrained = bool(mechanism._description["constraints"])

    def forces(self, q):
        m = self.m
        return m.inverse_dynamics(*self.time, q, self.zero, self.zero) - m._forces(self.time, q, self.zero, self.u)

    def jacobian(self, q):
        return self.m.constraint_jacobian(*self.time, q) if self.is_constrained else np.zeros((0, self.m.nv))

    def residuals(self, q):
        return self.m.constraint_residuals(*self.time, q) if self.is_constrained else np.zeros(0)

    def multipliers(self, q):
        """Those that balance forces best."""
        jacobian, forces = self.jacobian(q), self.forces(q)[self.free]
        if not (len(jacobian) and np.all(np.isfinite(forces)) and np.all(np.isfinite(jacobian))):
            return np.zeros(len(jacobian))
        return np.linalg.lstsq(jacobian.T[self.free], forces, rcond=1e-13)[0]

    def lacking(self, q, multipliers):
        balance = self.forces(q) - self.jacobian(q).T @ multipliers
        return np.concatenate([balance[self.free], self.residuals(q)])

    def slope(self, q, multipliers):
        m, free = self.m, self.free
        slope = m.inverse_dynamics_derivatives(*self.time, q, self.zero, self.zero)[0]
        if m.nu:
            slope = slope - m.generalized_forces_derivatives(*self.time, q, self.zero, self.u)[0]
        jacobian, count = self.jacobian(q), len(self.residuals(q))
        for k in np.flatnonzero(free) if len(jacobian) else ():
            move = 1e-6 * np.eye(m.nv)[k]
            sides = [self.jacobian(m.integrate(q, side * move)).T @ multipliers for side in (1, -1)]
            slope[:, k] -= (sides[0] - sides[1]) / 2e-6
        above = np.hstack([slope[np.ix_(free, free)], -jacobian.T[free]])
        return np.vstack([above, np.hstack([jacobian[:count, free], np.zeros((count, len(jacobian)))])])

    def moved(self, x, step):
        move = np.zeros(self.m.nv)
        count = self.free.sum()
        move[self.free] = step[:count]
        return self.m.integrate(x[0], move), x[1] + step[count:]


def _structures(number):
    """Settings of simulations and rollouts, and the type of controllers, for a type of numbers."""

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


class _Library:
    """The functions of a shared library with their types."""

    def __init__(self, path, prefix="mechanism"):
        self.handle = ctypes.CDLL(str(path))
        get = lambda name: getattr(self.handle, f"{prefix}_{name}")
        describe = get("description")
        describe.restype = ctypes.c_char_p
        self.description = json.loads(describe().decode("utf-8"))
        single = self.description["number"] == "f32"
        self.dtype = np.dtype(np.float32 if single else np.float64)
        number = ctypes.c_float if single else ctypes.c_double
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

    def why(self):
        return self.message().decode("utf-8")


def _address(array):
    """Where an array's numbers are. The quick way does not go with arrays that are empty or cannot be written to."""
    try:
        return _addressof(_from_buffer(array))
    except (TypeError, ValueError, BufferError):
        return array.__array_interface__["data"][0]


_addressof, _from_buffer = ctypes.addressof, ctypes.c_char.from_buffer


class Mechanism:
    """A mechanism with values of its parameters. Its subclasses are made by :func:`linkwork.compile`; parameters are given by name,
    those that have a dot in their names in a dictionary."""

    #: The struct's name, and what its doc comment says.
    name = None
    #: Names of the entries of `q`, `v` and `u`, of the parameters, the frames and the outputs.
    configuration = velocities = inputs = parameter_names = frames = outputs = ()
    #: Units of all of these.
    units = None
    #: How many entries `q`, `v` and `u` have.
    nq = nv = nu = 0
    #: The equations of motion as text; empty where they are too long to be read.
    equations = ""
    #: Names of generated functions that Python cannot call.
    left_out = ()
    _library = None

    def __init__(self, parameters=None, /, **named):
        if self._library is None:
            raise TypeError("mechanisms are made by `linkwork.compile`")
        values = np.zeros(len(self.parameter_names), self._library.dtype)
        if self._library.defaults is not None:
            self._library.defaults(ctypes.c_void_p(_address(values)))
        given = {**dict(parameters or {}), **named}
        for name, value in given.items():
            values[_index(self.parameter_names, name, "parameter")] = value
        missing = [n for n, v in zip(self.parameter_names, values) if np.isnan(v) and n not in given]
        if missing:
            raise TypeError(f"{self.name} needs the parameters {', '.join(missing)}")
        values.flags.writeable = False
        self._values = values
        self._own = _address(values) if len(values) else None
        if len(values) and self._library.validate(self._own) != 0:
            raise Error(self._library.why())

    @property
    def parameters(self):
        """Values of the parameters by name."""
        return dict(zip(self.parameter_names, self._values.tolist()))

    def replace(self, parameters=None, /, **named):
        """The mechanism with other values of some parameters."""
        return type(self)({**self.parameters, **dict(parameters or {}), **named})

    def __repr__(self):
        values = ", ".join(f"{name}={value!r}" for name, value in self.parameters.items())
        return f"{self.name}({values if len(values) < 200 else '…'})"

    def __reduce__(self):
        return _again, (str(self._path), self.parameters)

    @classmethod
    def _origin(cls):
        """What it was compiled from."""
        return json.loads(Path(cls._path).with_suffix(".json").read_text(encoding="utf-8"))

    @classmethod
    def stub(cls) -> str:
        """The class with types and documentation, as editors and type checkers read it: a file NAME.pyi."""
        lines = [
            "from typing import Any",
            "",
            "from numpy.typing import ArrayLike, NDArray",
            "",
            "import linkwork",
            "",
            f"class {cls.name}(linkwork.Mechanism):",
            f"    {_quoted(cls.__doc__)}",
        ]
        values = ", ".join(f"{name}: float" for name in cls.parameter_names if name.isidentifier())
        star = f", *, {values}" if values else ""
        lines.append(f"    def __init__(self, parameters: dict[str, float] | None = None, /{star}) -> None: ...")
        kinds = {"frame": "str | int", "velocities": "list[str] | list[int]"}
        for name, about in cls._functions.items():
            if name not in cls.__dict__:
                continue
            arguments = "".join(f", {_safe(a['name'])}: {kinds.get(a['kind'], 'ArrayLike')}" for a in about["arguments"])
            position = f"{arguments}, /" if arguments else ""
            count = len(about["results"])
            result = "NDArray[Any]" if count == 1 else f"tuple[{', '.join(['NDArray[Any]'] * count)}]"
            lines.append(f"    def {name}(self{position}, *, threads: int | None = None, out: Any = None) -> {result}:")
            lines.append(f"        {_quoted(getattr(cls, name).__doc__, 8)}")
        return "\n".join(lines) + "\n"

    @classmethod
    def save(cls, folder=".") -> Path:
        """Writes the class as a package into a folder: a module with its library and its stubs, which needs NumPy alone. It can be
        copied to machines without Linkwork and Rust that have the same system and the same kind of processor; compile with
        `native=False` for those with an older one.

        Returns:
            The folder of the package. Its name is that of the class in small letters: `CartPole` is imported from `cart_pole`.

        Raises:
            FileExistsError: something else has this name.
        """
        try:
            from ._package import save
        except ImportError:
            raise Error("this is such a package already: copy its folder") from None

        return save(cls, folder)

    # Indices

    def index_q(self, name):
        """The index of an entry of `q`, by its name."""
        return _index(self.configuration, name, "coordinate")

    def index_v(self, name):
        """The index of an entry of `v`, by its name."""
        return _index(self.velocities, name, "velocity")

    def index_u(self, name):
        """The index of an entry of `u`, by its name."""
        return _index(self.inputs, name, "input")

    # Motions

    def _vector(self, value, length, what):
        if value is None:
            return None
        if isinstance(value, dict):
            names = {"q": self.configuration, "v": self.velocities, "u": self.inputs}[what]
            vector = self.neutral().copy() if what == "q" else np.zeros(length, self._library.dtype)
            kind = {"q": "coordinate", "v": "velocity", "u": "input"}[what]
            for name, entry in value.items():
                vector[_index(names, name, kind)] = entry
            return vector
        vector = np.ascontiguousarray(_numbers(value, self._library.dtype, what))
        if vector.shape != (length,):
            raise ValueError(f"{what} has {length} entries, found an array of shape {vector.shape}")
        return vector

    def simulate(
        self,
        q=None,
        v=None,
        *,
        duration,
        every=None,
        start=0.0,
        inputs=None,
        control=None,
        period=None,
        method=None,
        tolerance=1e-8,
        step=None,
    ):
        """A motion.

        Args:
            q: the configuration at the start: an array, or values by name; the neutral one if none is given.
            v: the velocity at the start, likewise; at rest if none is given.
            duration: how long, s.
            every: time between samples, s; a hundredth of the duration if it is not given.
            start: time at the start, s.
            inputs: constant inputs: an array, or values by name.
            control: a function of `t, q, v` that returns the inputs, instead of constant ones.
            period: time between calls of `control`, s; its inputs are held in between. Without it `control` is called whenever
                the method evaluates the dynamics, and must be continuous.
            method: `"dormand_prince"`, `"dormand_prince8"`, `"rodas"` (stiff), by tolerance; `"rk4"`, `"implicit_midpoint"`, by
                step. With contacts `"event_driven"`, by tolerance, or `"time_stepping"`, by step.
            tolerance: error of a step, relative and absolute.
            step: length of a step, s.

        Raises:
            Error: the motion cannot go on; the samples so far are in its attribute `run`.
        """
        library = self._library
        q = self.neutral() if q is None else self._vector(q, self.nq, "q")
        v = np.zeros(self.nv, library.dtype) if v is None else self._vector(v, self.nv, "v")
        if not (duration >= 0 and np.isfinite(duration)):
            raise ValueError(f"the duration is a time in seconds, found {duration!r}")
        every = every if every is not None else (duration / 100 or 1.0)
        if not (every > 0 and np.isfinite(every)):
            raise ValueError(f"`every` is a positive time in seconds, found {every!r}")
        if period is not None and not (period > 0 and np.isfinite(period)):
            raise ValueError(f"`period` is a positive time in seconds, found {period!r}")
        if inputs is not None and control is not None:
            raise TypeError("give either constant inputs or a function `control`")
        if method is None:
            smooth = not self._description["contacts"]
            method = ("rk4" if step else "dormand_prince") if smooth else ("time_stepping" if step else "event_driven")
        by_step = method in ("rk4", "implicit_midpoint", "time_stepping")
        if by_step and step is None:
            raise TypeError(f"the method {method} needs a step")
        setting = step if by_step else tolerance
        constant = self._vector(inputs, self.nu, "u")
        if constant is not None:
            control, period = (lambda t, q, v: constant), period or every
        raised = []
        size = library.dtype.itemsize

        def asked(_user, t, q, v, u):
            try:
                own_q, own_v = np.empty(self.nq, library.dtype), np.empty(self.nv, library.dtype)
                ctypes.memmove(_address(own_q), q, self.nq * size)
                ctypes.memmove(_address(own_v), v, self.nv * size)
                found = control(t, own_q, own_v)
                found = self._vector(found, self.nu, "u")
                if found is None:
                    raise TypeError("`control` returned nothing")
                ctypes.memmove(u, _address(found), self.nu * size)
                return 0
            except BaseException as error:  # It cannot pass through the library: it is raised again behind it.
                raised.append(error)
                return 1

        pointer = library.Control(asked) if control is not None else None
        settings = library.Settings(
            start, duration, every, method.encode(), setting, period or 0.0, ctypes.cast(pointer, ctypes.c_void_p), None
        )
        rows = int(np.floor(duration / every * (1 + 1e-9))) + 3
        samples = np.empty((rows, 1 + self.nq + self.nv + self.nu), library.dtype)
        count = ctypes.c_size_t()
        code = library.simulate(
            self._own,
            _address(q),
            _address(v),
            ctypes.addressof(settings),
            _address(samples),
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

    def roll_out(self, q, v, inputs=None, *, steps=None, h, start=0.0, threads=0):
        """Many motions by steps of the classical method of Runge and Kutta, eight states at a time and on all processors, while other
        threads of Python go on.

        Args:
            q: configurations at the start, (N, nq).
            v: velocities at the start, (N, nv).
            inputs: held during each step: (steps, nu) for all states alike, or (N, steps, nu); zero if none are given.
            steps: how many, if there are no inputs.
            h: length of a step, s.
            start: time at the start, s.
            threads: how many; as many as there are processors for 0. Results do not depend on it.

        Returns:
            Configurations (N, steps + 1, nq) and velocities (N, steps + 1, nv), those at the start first.
        """
        library = self._library
        q, v = np.asarray(q, library.dtype), np.asarray(v, library.dtype)
        if q.ndim != 2 or q.shape[1] != self.nq or v.shape != (len(q), self.nv):
            raise ValueError(
                f"expected arrays of shapes (N, {self.nq}) and (N, {self.nv}), found {q.shape} and {v.shape}"
            )
        n, kind = len(q), 0
        if inputs is not None:
            inputs = np.ascontiguousarray(inputs, library.dtype)
            found = inputs.shape[-2] if inputs.ndim >= 2 else None
            if steps is not None and found is not None and steps != found:
                raise ValueError(f"there are inputs of {found} steps, not of {steps}")
            steps = found
            if inputs.shape == (steps, self.nu):
                kind = 1
            elif inputs.shape == (n, steps, self.nu):
                kind = 2
            else:
                raise ValueError(f"inputs have the shape (steps, {self.nu}) or ({n}, steps, {self.nu}), not {inputs.shape}")
        if steps is None:
            raise TypeError("how many steps?")
        if threads < 0:
            raise ValueError(f"a number of threads is not {threads!r}")
        if steps < 0 or int(steps) != steps:
            raise ValueError(f"a number of steps is not {steps!r}")
        steps = int(steps)
        all_q = np.empty((n, steps + 1, self.nq), library.dtype)
        all_v = np.empty((n, steps + 1, self.nv), library.dtype)
        all_q[:, 0], all_v[:, 0] = q, v
        settings = library.Rollout(start, h, steps, n, threads, kind)
        given = _address(inputs) if kind else None
        code = library.roll_out(self._own, ctypes.addressof(settings), given, _address(all_q), _address(all_v))
        if code != 0:
            error = Error(library.why())
            error.q, error.v = all_q, all_v
            raise error
        return all_q, all_v

    # Steady states and linear systems

    def equilibrium(self, q=None, inputs=None, *, held=(), tolerance=1e-12, iterations=50):
        """A configuration near `q` in which the mechanism stays at rest under constant inputs: Newton's method with half steps on the
        generated derivatives. Under constraints they hold there, and their forces are found along with it (the change of these with
        the configuration by differences of the generated Jacobian). Limits of joints are not heeded: a long way off `q` it may lie
        beyond them.

        Args:
            q: where the search begins: an array, or values by name.
            inputs: an array, or values by name.
            held: names of velocities whose coordinates stay as they are.
            tolerance: largest change of a coordinate that counts as none.
            iterations: how many steps at most.

        Raises:
            Error: there is none near, or the mechanism has contacts or no derivatives.
        """
        if self._description["contacts"]:
            raise Error("equilibria at contacts are found by the crate linkwork-design")
        self._need("inverse_dynamics_derivatives", "derivatives")
        q = self.neutral() if q is None else self._vector(q, self.nq, "q")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        free = np.ones(self.nv, bool)
        for name in held:
            free[self.index_v(name)] = False
        if not free.any():
            return q
        rest = _Rest(self, u, free)
        x = (q, rest.multipliers(q))
        lacking = rest.lacking(*x)
        if not np.all(np.isfinite(lacking)):
            raise Error("no equilibrium was found: forces are not finite where the search begins")
        for _ in range(iterations):
            slope = rest.slope(*x)
            if not np.all(np.isfinite(slope)):
                break
            step = -np.linalg.lstsq(slope, lacking, rcond=1e-13)[0]
            largest = np.abs(step[: free.sum()]).max()
            part = 1.0
            while part > 1e-6:
                there = rest.moved(x, part * step)
                found = rest.lacking(*there)
                if np.linalg.norm(found) < np.linalg.norm(lacking) or part * largest < tolerance:
                    break
                part /= 2
            x, lacking = there, found
            if part * largest <= tolerance * (1 + np.abs(x[0]).max()):
                if np.abs(lacking).max() <= 1e-8 * (1 + np.abs(slope).max()):
                    return x[0]
                break
        raise Error(
            f"no equilibrium was found near this configuration: forces (N, N m) and gaps of constraints (m, rad) of {np.abs(lacking).max():.3g} are left"
        )

    def linear_system(self, q, v=None, inputs=None, *, t=0.0):
        """The linear system about a state, which fulfils the constraints; of one that is no equilibrium A and B describe what is
        added to its motion. Every joint of a robot file is an input unless the option `inputs` says otherwise.

        Raises:
            Error: without derivatives, or off the constraints: `assemble` brings a configuration onto them.
        """
        self._need("linearize", "derivatives")
        q = self._vector(q, self.nq, "q")
        if "constraint_residuals" in self._functions:
            off = np.abs(self.constraint_residuals(*([t] if self._description["time"] else []), q)).max(initial=0)
            if not off <= 1e-6:
                raise Error(f"the configuration is off the constraints by {off:.3g} (m, rad): `assemble` brings it onto them")
        v = np.zeros(self.nv) if v is None else self._vector(v, self.nv, "v")
        u = np.zeros(self.nu) if inputs is None else self._vector(inputs, self.nu, "u")
        time = [t] if self._description["time"] else []
        if self._description["constraints"]:
            found = self.linearize(*time, q, v, u, [])
            a, b, coordinates, speeds = found
            names = [self.velocities[int(k)] for k in coordinates]
            names += [f"{self.velocities[int(k)]}.rate" for k in speeds]
        else:
            a, b = self.linearize(*time, q, v, u)
            names = list(self.velocities) + [f"{name}.rate" for name in self.velocities]
        return LinearSystem(a, b, names, list(self.inputs))

    def _forces(self, time, q, v, u):
        if not self.nu:
            return np.zeros(self.nv)
        given = [q, v, u] if self._takes("generalized_forces", "v") else [q, u]
        return self.generalized_forces(*time, *given)

    def _takes(self, function, argument):
        return any(a["name"] == argument for a in self._functions[function]["arguments"])

    def _need(self, function, word):
        if function not in self._functions:
            raise Error(f"this needs the function `{function}`: compile with `{word}=True`")


def _numbers(value, dtype, what):
    """An array of numbers, which nothing is lost of that cannot be seen."""
    if np.iscomplexobj(value):
        raise TypeError(f"{what} has complex numbers")
    if isinstance(value, np.ma.MaskedArray) and np.ma.is_masked(value):
        raise TypeError(f"{what} has masked entries")
    return np.asarray(value, dtype)


def _safe(name):
    """A name that is no keyword."""
    return f"{name}_" if keyword.iskeyword(name) else name


def _quoted(text, indent=4):
    """A text as a documentation string."""
    text = text.replace("\\", "\\\\").replace('"""', "'''").strip()
    lines = text.split("\n")
    inner = "\n".join([lines[0], *[(" " * indent + line).rstrip() for line in lines[1:]]])
    close = "\n" + " " * indent if len(lines) > 1 else ""
    return f'"""{inner}{close}"""'


def _again(path, parameters):
    return load(path)(parameters)


def _function(library, k, about, cls):
    """The method that calls a function by its number."""
    arguments, results = about["arguments"], about["results"]
    dtype, call, nv = library.dtype, library.call, len(library.description["velocities"])
    shapes = []
    for a in arguments:
        shapes.append(tuple(a["shape"]) if a["kind"] == "array" else (nv,) if a["kind"] == "velocities" else ())
    kinds = [a["kind"] for a in arguments]
    names = [_safe(a["name"]) for a in arguments]
    # Matrices stand column by column: in memory their transposes.
    stored = [tuple(r["shape"][:-2] + r["shape"][:-3:-1]) if len(r["shape"]) > 1 else tuple(r["shape"]) for r in results]
    turned = [len(shape) > 1 for shape in stored]
    Arguments, Results = ctypes.c_void_p * max(len(arguments), 1), ctypes.c_void_p * len(results)
    count = len(arguments)
    frames = library.description["frames"]
    velocities = [entry["name"] for entry in library.description["velocities"]]

    def prepared(i, value):
        kind = kinds[i]
        if kind == "frame" and isinstance(value, str):
            value = _index(frames, value, "frame")
        elif kind == "velocities":
            marks = np.zeros(nv, dtype)
            for one in value:
                marks[_index(velocities, one, "velocity") if isinstance(one, str) else one] = 1
            return marks
        array = _numbers(value, dtype, names[i])
        if len(shapes[i]) == 2:
            array = np.swapaxes(array, -1, -2)
            expected = shapes[i][::-1]
        else:
            expected = shapes[i]
        if array.shape[array.ndim - len(expected) :] != expected or array.ndim > len(expected) + 1:
            raise ValueError(
                f"{about['name']}: {names[i]} has the shape {shapes[i]}, or (N, …) of N states, not {np.shape(value)}"
            )
        return array if array.flags.c_contiguous else np.ascontiguousarray(array)

    plain = all(kind == "array" and len(shape) == 1 for kind, shape in zip(kinds, shapes))
    ndarray, empty = np.ndarray, np.empty

    def method(self, *given, threads=None, out=None):
        # One state in arrays that need no conversion: the way of control loops.
        if plain and out is None and len(given) == count:
            for array, shape in zip(given, shapes):
                if type(array) is not ndarray or array.shape != shape or array.dtype != dtype:
                    break
                if not array.flags.c_contiguous:
                    break
            else:
                found = [empty(shape, dtype) for shape in stored]
                own = Arguments(*[_address(array) for array in given])
                if call(k, self._own, own, Results(*[_address(array) for array in found]), 1, 1) != 0:
                    raise Error(f"{about['name']}: {library.why()}")
                if len(found) == 1:
                    array = found[0]
                    return array.swapaxes(-1, -2) if turned[0] else array if array.ndim else array[()]
                return tuple(
                    array.swapaxes(-1, -2) if turn else array[()] for array, turn in zip(found, turned)
                )
        return general(self, given, threads, out)

    def placed(out, lead):
        """Arrays that results go into, as they are stored."""
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

    def general(self, given, threads, out):
        if not isinstance(self, Mechanism):
            raise TypeError(f"{about['name']} is a function of a mechanism, not of its class: make one first, with values of its parameters")
        if len(given) != count:
            raise TypeError(f"{about['name']}({', '.join(names)}) takes {count} arguments, found {len(given)}")
        arrays = [prepared(i, value) for i, value in enumerate(given)]
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
            own = Arguments(*[_address(array) for array in arrays])
            wanted = Results(*[_address(array) for array in found])
            if threads is None:
                threads = 0 if n >= 256 else 1
            elif threads < 0:
                raise ValueError(f"a number of threads is not {threads!r}")
            if call(k, self._own, own, wanted, n, threads) != 0:
                raise Error(f"{about['name']}: {library.why()}")
        found = [array.swapaxes(-1, -2) if turn else array[()] for array, turn in zip(found, turned)]
        return found[0] if len(found) == 1 else tuple(found)

    method.__name__ = about["name"]
    method.__qualname__ = f"{cls}.{about['name']}"
    method.__doc__ = _documentation(about, shapes)
    kind = inspect.Parameter
    parameters = [kind("self", kind.POSITIONAL_ONLY)]
    parameters += [kind(name, kind.POSITIONAL_ONLY) for name in names]
    parameters += [kind(name, kind.KEYWORD_ONLY, default=None) for name in ("threads", "out")]
    method.__signature__ = inspect.Signature(parameters)
    return method


def _documentation(about, shapes):
    lines = [about["documentation"], ""]
    if about["arguments"]:
        lines.append("Args:")
        for a, shape in zip(about["arguments"], shapes):
            text = {
                "number": "a number",
                "frame": "the name of a frame, or its number",
                "velocities": "names of velocities, or their indices",
            }.get(a["kind"], f"shape {shape}")
            lines.append(f"    {a['name']}: {text}")
        lines.append("")
    lines.append("Returns:")
    unit = f", {about['unit']}" if about["unit"] else ""
    for r in about["results"]:
        shape = f"shape {tuple(r['shape'])}" if r["shape"] else "a number"
        lines.append(f"    {r['name']}: {shape}{unit}")
    lines.append("")
    lines.append("Arrays of N states, with N before these shapes, give arrays of N results. `threads` says how many share them;")
    lines.append("`out` is what an earlier call with as many states returned, and is written over.")
    return "\n".join(lines)


def load(path):
    """The class of a compiled library."""
    library = _Library(path)
    d = library.description
    names = lambda key: [entry["name"] for entry in d[key]]
    units = lambda key: [entry["unit"] for entry in d[key]]
    members = {
        "__doc__": d["documentation"] or f"The mechanism {d['name']}.",
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
            members[about["name"]] = _function(library, k, about, d["name"])
    return type(d["name"], (Mechanism,), members)
