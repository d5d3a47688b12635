"""Functions and rollouts with vector–Jacobian products, on NumPy arrays: the common part of :mod:`linkwork.torch`
and :mod:`linkwork.jax`.

Arguments are a vector of all parameters, then the arguments of the function. Each may have leading dimensions,
which are those of NumPy's broadcasting.
"""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._functions import _frame
from ._mechanism import Mechanism
from ._names import Error, index, number
from ._native import Function, Robot, roll_back

Array = NDArray[Any]


class Operation:
    """A function of a mechanism, for one frame if it takes one."""

    def __init__(self, kind: type[Mechanism], name: str, frame: Any = None) -> None:
        self.kind, self.name = kind, name
        if name not in kind._functions:
            index(list(kind._functions), name, "function")
        self.function: Function = kind._functions[name]
        arguments = self.function.arguments
        self.takes_frame = any(shape is None for _, shape in arguments)
        self.frame = _frame(kind, frame) if self.takes_frame else 0
        #: Shapes of the vector of the parameters and of the arguments.
        self.shapes = [(len(kind.parameter_names),)] + [tuple(shape) for _, shape in arguments if shape is not None]
        self.results = [tuple(shape) for _, shape in self.function.results]

    def lead(self, given: Sequence[Any]) -> tuple[int, ...]:
        """Returns the common leading dimensions of arguments."""
        if len(given) != len(self.shapes):
            raise TypeError(f"{self.name} takes {len(self.shapes) - 1} arguments, found {len(given) - 1}")
        leads = []
        for value, shape in zip(given, self.shapes):
            found = tuple(np.shape(value))
            if found[len(found) - len(shape) :] != shape:
                raise ValueError(f"{self.name}: expected the shape (…, {', '.join(map(str, shape))}), found {found}")
            leads.append(found[: len(found) - len(shape)])
        return np.broadcast_shapes(*leads)

    def _prepare(self, given: Sequence[Any]) -> tuple[Robot, list[Array], tuple[int, ...], int]:
        lead = self.lead(given)
        states = math.prod(lead)
        flat = []
        for value, shape in zip(given, self.shapes):
            array = np.asarray(value, dtype=np.float64)
            if array.shape != shape:
                array = np.broadcast_to(array, lead + shape).reshape(states, *shape)
            flat.append(np.ascontiguousarray(array))
        return _robot(self.kind, flat[0], states), flat[1:], lead, states

    def evaluate(self, given: Sequence[Any]) -> list[Array]:
        """Returns the results."""
        robot, arguments, lead, states = self._prepare(given)
        found = [np.empty((states, *shape[::-1])) for shape in self.results]
        if states:
            self.function.evaluate(robot, self.frame, arguments, found, states, _threads(states))
        results = [array.swapaxes(-1, -2) if array.ndim > 2 else array for array in found]
        return [array.reshape(lead + shape) for array, shape in zip(results, self.results)]

    def pull_back(self, given: Sequence[Any], factors: Sequence[Any]) -> list[Array]:
        """Returns derivatives of the sum of the results, each times a factor, by all arguments."""
        robot, arguments, lead, states = self._prepare(given)
        parts = []
        for value, shape in zip(factors, self.results):
            array = np.broadcast_to(np.asarray(value, dtype=np.float64), lead + shape)
            array = array.swapaxes(-1, -2) if len(shape) > 1 else array
            parts.append(array.reshape(states, math.prod(shape)))
        joined = np.concatenate(parts, axis=1)
        lengths = [math.prod(shape) for shape in self.shapes]
        out = np.zeros((states, sum(lengths)))
        if states:
            self.function.pull_back(robot, self.frame, arguments, joined, out, states, _threads(states))
        # Those by the parameters come last.
        columns = np.split(out, np.cumsum(lengths[1:]), axis=1)
        columns = [columns[-1], *columns[:-1]]
        return [
            _sum(column.reshape(lead + shape), np.shape(value))
            for column, shape, value in zip(columns, self.shapes, given)
        ]


class Rollout:
    """Rollouts by steps of the classical Runge–Kutta method: arguments are parameters, initial configurations and
    velocities, and the inputs of each step."""

    def __init__(self, kind: type[Mechanism], h: float, start: float = 0.0) -> None:
        if kind._description["constraints"] or kind._description["contacts"]:
            raise Error(f"{kind.name}: gradients of rollouts need a mechanism without constraints and contacts")
        self.kind, self.h, self.start = kind, number(h, "`h`"), number(start, "`start`")
        self.ends = [len(kind.parameter_names), kind.nq, kind.nv, kind.nu]

    def lead(self, given: Sequence[Any]) -> tuple[int, ...]:
        """Returns the common leading dimensions of arguments."""
        shapes = [tuple(np.shape(value)) for value in given]
        for shape, end, name in zip(shapes, self.ends, ("parameters", "q", "v", "inputs")):
            if not shape or shape[-1] != end or (name == "inputs" and len(shape) < 2):
                steps = "steps, " if name == "inputs" else ""
                raise ValueError(f"roll_out: {name} has the shape (…, {steps}{end}), not {shape}")
        return np.broadcast_shapes(*[shape[:-1] for shape in shapes[:3]], shapes[3][:-2])

    def _prepare(self, given: Sequence[Any]) -> tuple[Robot, list[Array], tuple[int, ...], int]:
        lead = self.lead(given)
        states = math.prod(lead)
        flat = []
        for k, value in enumerate(given):
            array = np.asarray(value, dtype=np.float64)
            own = array.shape[-2:] if k == 3 else array.shape[-1:]
            if k > 0 or array.ndim > 1:
                array = np.broadcast_to(array, lead + own).reshape(states, *own)
            flat.append(np.ascontiguousarray(array))
        return _robot(self.kind, flat[0], states), flat[1:], lead, states

    def evaluate(self, given: Sequence[Any]) -> list[Array]:
        """Returns configurations and velocities of all steps."""
        robot, (q, v, inputs), lead, states = self._prepare(given)
        rows = inputs.shape[1] + 1
        all_q, all_v = np.empty((states, rows, q.shape[1])), np.empty((states, rows, v.shape[1]))
        all_q[:, 0], all_v[:, 0] = q, v
        if states:
            robot.roll_out(all_q, all_v, inputs, start=self.start, h=self.h, threads=_threads(states * rows))
        return [all_q.reshape(lead + all_q.shape[1:]), all_v.reshape(lead + all_v.shape[1:])]

    def pull_back(self, given: Sequence[Any], results: Sequence[Any], factors: Sequence[Any]) -> list[Array]:
        """Returns derivatives of the sum of the states, each times a factor, by all arguments."""
        robot, (_, _, inputs), lead, states = self._prepare(given)
        q, v = (np.ascontiguousarray(value, dtype=np.float64).reshape(states, *np.shape(value)[-2:]) for value in results)
        by_q, by_v = (np.array(value, dtype=np.float64).reshape(states, *np.shape(value)[-2:]) for value in factors)
        by_inputs, by_parameters = np.zeros(inputs.shape), np.zeros((states, self.ends[0]))
        if states:
            threads = _threads(states * q.shape[1])
            roll_back(
                robot, q, v, inputs, by_q, by_v, by_inputs, by_parameters, start=self.start, h=self.h, threads=threads
            )
        found = [by_parameters, by_q[:, 0], by_v[:, 0], by_inputs]
        return [_sum(array.reshape(lead + array.shape[1:]), np.shape(value)) for array, value in zip(found, given)]


class BaseOperations:
    """The functions of a class as operations of a library with gradients, which subclasses apply."""

    def __init__(self, kind: type[Mechanism]) -> None:
        self.kind = kind

    def _apply(self, operation: Operation | Rollout, given: Sequence[Any]) -> Any:
        """Applies an operation to its arguments, which follow the parameters."""
        raise NotImplementedError

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        takes_frame = Operation(self.kind, name, 0).takes_frame if name.startswith("frame_") else False

        def call(*given: Any) -> Any:
            operation = Operation(self.kind, name, given[0] if takes_frame else None)
            return self._apply(operation, given[1:] if takes_frame else given)

        call.__name__ = name
        call.__doc__ = getattr(self.kind, name).__doc__
        return call

    def roll_out(self, q: Any, v: Any, inputs: Any, *, h: float, start: float = 0.0) -> Any:
        """Simulates motions by steps of the classical Runge–Kutta method, with inputs that are constant during each
        step. Gradients are those of adjoint steps.

        Args:
            q: initial configurations, (…, nq).
            v: initial velocities, (…, nv).
            inputs: inputs of each step, (…, steps, nu).
            h: step size, s.
            start: initial time, s.

        Returns:
            Configurations (…, steps + 1, nq) and velocities (…, steps + 1, nv), including the initial ones.
        """
        return self._apply(Rollout(self.kind, h, start), (q, v, inputs))


def _robot(kind: type[Mechanism], parameters: Array, states: int) -> Robot:
    loaded = kind._loaded
    assert loaded is not None
    many = parameters.ndim > 1
    return loaded.with_parameters(parameters.reshape(states if many else 1, len(kind.parameter_names)), many)


def _threads(states: int) -> int:
    return 0 if states >= 256 else 1


def _sum(array: Array, shape: tuple[int, ...]) -> Array:
    """Returns the sum over the dimensions that an argument does not have, or in which it has the length one."""
    summed = array.sum(axis=tuple(range(array.ndim - len(shape))))
    axes = tuple(k for k, (found, own) in enumerate(zip(summed.shape, shape)) if own == 1 and found != 1)
    total: Array = summed.sum(axis=axes, keepdims=True) if axes else summed
    return total


def parameter_values(kind: type[Mechanism], given: dict[str, Any]) -> list[Any]:
    """Returns the values of all parameters in their order, those of the file if they are not given."""
    if kind._loaded is None:
        raise TypeError(f"expected a class that `linkwork.compile` returns, found {kind!r}")
    values: list[Any] = kind._loaded.parameters()[0].tolist()
    for name, value in given.items():
        values[index(kind.parameter_names, name, "parameter")] = value
    missing = [n for n, v in zip(kind.parameter_names, values) if n not in given and np.isnan(v)]
    if missing:
        raise TypeError(f"{kind.name} needs the parameters {', '.join(missing)}")
    return values
