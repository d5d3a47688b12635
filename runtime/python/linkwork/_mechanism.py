"""Compiled mechanisms as classes of Python."""

import ctypes
import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from ._equilibrium import Rest, find
from ._functions import ENTRIES, Library, address, function, marked, quoted
from ._names import Error, checked, hint, index, number, numbers, safe
from ._results import LinearSystem, Run, Units


#: Methods of simulations, and what says how exact they are.
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

    def __init__(self, parameters=None, /, *others, **named):
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
    def parameters(self):
        """Values of the parameters by name."""
        return dict(zip(self.parameter_names, self._values.tolist()))

    def replace(self, parameters=None, /, *others, **named):
        """The mechanism with other values of some parameters."""
        return type(self)({**self.parameters, **self._given(parameters, others, named)})

    @classmethod
    def _given(cls, parameters, others, named):
        """Values of parameters by their names."""
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
            f"    {quoted(cls.__doc__)}",
        ]
        values = ", ".join(f"{name}: float" for name in cls.parameter_names if name.isidentifier())
        star = f", *, {values}" if values else ""
        lines.append(f"    def __init__(self, parameters: dict[str, float] | None = None, /{star}) -> None: ...")
        kinds = {"frame": "str | int", "velocities": "list[str] | list[int]"}
        for name, about in cls._functions.items():
            if name not in cls.__dict__:
                continue
            arguments = "".join(f", {safe(a['name'])}: {kinds.get(a['kind'], 'ArrayLike')}" for a in about["arguments"])
            position = f"{arguments}, /" if arguments else ""
            count = len(about["results"])
            result = "NDArray[Any]" if count == 1 else f"tuple[{', '.join(['NDArray[Any]'] * count)}]"
            lines.append(f"    def {name}(self{position}, *, threads: int | None = None, out: Any = None) -> {result}:")
            lines.append(f"        {quoted(getattr(cls, name).__doc__, 8)}")
        return "\n".join(lines) + "\n"

    @classmethod
    @checked
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
        return index(self.configuration, name, "coordinate")

    def index_v(self, name):
        """The index of an entry of `v`, by its name."""
        return index(self.velocities, name, "velocity")

    def index_u(self, name):
        """The index of an entry of `u`, by its name."""
        return index(self.inputs, name, "input")

    # Motions

    def _vector(self, value, length, what):
        if value is None:
            return None
        if isinstance(value, dict):
            entries = ENTRIES[what]
            names = {"q": self.configuration, "v": self.velocities, "u": self.inputs}[entries]
            vector = self.neutral().copy() if entries == "q" else np.zeros(length, self._library.dtype)
            kind = {"q": "coordinate", "v": "velocity", "u": "input"}[entries]
            for name, entry in value.items():
                vector[index(names, name, kind)] = number(entry, f"the {kind} {name!r}")
            return vector
        vector = np.ascontiguousarray(numbers(value, self._library.dtype, what))
        if vector.shape != (length,):
            raise ValueError(f"{what} has {length} entries, found an array of shape {vector.shape}")
        return vector

    def _method(self, method, tolerance, step):
        """The method, and its tolerance or the length of its steps."""
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
        tolerance=None,
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
                step. With contacts `"event_driven"`, by tolerance, or `"time_stepping"`, by step, or
                `"time_stepping_midpoint"` with two evaluations of the dynamics per step in place of four. By default
                `"dormand_prince"` and `"event_driven"`; with a `step` `"rk4"` and `"time_stepping"`.
            tolerance: error of a step, relative and absolute, of methods by tolerance; 1e-8 if it is not given.
            step: length of a step, s, of methods by step.

        Raises:
            Error: the motion cannot go on; the samples so far are in its attribute `run`.
        """
        library = self._library
        q = self.neutral() if q is None else self._vector(q, self.nq, "q")
        v = np.zeros(self.nv, library.dtype) if v is None else self._vector(v, self.nv, "v")
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
        constant = self._vector(inputs, self.nu, "u")
        if constant is not None:
            control, period = (lambda t, q, v: constant), every
        raised = []
        size = library.dtype.itemsize

        def asked(_user, t, q, v, u):
            try:
                own_q, own_v = np.empty(self.nq, library.dtype), np.empty(self.nv, library.dtype)
                ctypes.memmove(address(own_q), q, self.nq * size)
                ctypes.memmove(address(own_v), v, self.nv * size)
                found = control(t, own_q, own_v)
                found = self._vector(found, self.nu, "u")
                if found is None:
                    raise TypeError("`control` returned nothing")
                ctypes.memmove(u, address(found), self.nu * size)
                return 0
            except BaseException as error:  # It cannot pass through the library: it is raised again behind it.
                raised.append(error)
                return 1

        pointer = library.Control(asked) if control is not None else None
        settings = library.Settings(
            number(start, "`start`"), duration, every, method.encode(), setting, period or 0.0, ctypes.cast(pointer, ctypes.c_void_p), None
        )
        rows = int(np.floor(duration / every * (1 + 1e-9))) + 3
        samples = np.empty((rows, 1 + self.nq + self.nv + self.nu), library.dtype)
        count = ctypes.c_size_t()
        code = library.simulate(
            self._own,
            address(q),
            address(v),
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
        settings = library.Rollout(number(start, "`start`"), number(h, "`h`"), steps, n, threads, kind)
        given = address(inputs) if kind else None
        code = library.roll_out(self._own, ctypes.addressof(settings), given, address(all_q), address(all_v))
        if code != 0:
            error = Error(library.why())
            error.q, error.v = all_q, all_v
            raise error
        return all_q, all_v

    # Steady states and linear systems

    @checked
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
        free = marked(held, self.velocities, self._library.dtype) == 0
        return find(Rest(self, u, free), q, tolerance, iterations) if free.any() else q

    @checked
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


def _again(path, parameters):
    return load(path)(parameters)


def load(path):
    """The class of a compiled library."""
    library = Library(path)
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
            members[about["name"]] = function(library, k, about, d["name"])
    return type(d["name"], (Mechanism,), members)
