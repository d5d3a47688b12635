"""Functions of mechanisms as operations of JAX, with exact gradients.

>>> import linkwork, linkwork.jax
>>> Arm = linkwork.compile("robot.urdf")
>>> arm = linkwork.jax.Operations(Arm)
>>> jax.grad(lambda q: arm.inverse_dynamics(q, v, a).sum())(q)

Gradients are vector–Jacobian products that are derived from the functions, not differences. Operations may be compiled
by ``jax.jit`` and mapped by ``jax.vmap``. Parameters may be arrays of JAX, too: ``Operations(Pendulum, mass=mass,
length=1.5)``. Computations are in double precision on the processor; set ``jax_enable_x64`` to keep it.
"""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from ._gradients import BaseOperations, Rollout, parameter_values
from ._mechanism import Mechanism


def _operation(operation: Any) -> Any:
    """Returns an operation as a function of JAX with a vector–Jacobian product."""
    is_rollout = isinstance(operation, Rollout)

    def shapes(given: Any) -> list[tuple[int, ...]]:
        lead = operation.lead(given)
        if is_rollout:
            rows = np.shape(given[3])[-2] + 1
            return [(*lead, rows, operation.ends[1]), (*lead, rows, operation.ends[2])]
        return [lead + shape for shape in operation.results]

    def callback(evaluate: Any, expected: Any, *given: Any) -> Any:
        struct: Any = jax.ShapeDtypeStruct
        types = [struct(shape, jnp.result_type(float)) for shape in expected]

        def compute(*arrays: Any) -> Any:
            found = evaluate([np.asarray(array) for array in arrays])
            return [np.asarray(array, dtype=own.dtype) for array, own in zip(found, types)]

        # Mapped arguments have a further leading dimension.
        return jax.pure_callback(compute, types, *given, vmap_method="broadcast_all")

    @jax.custom_vjp
    def call(*given: Any) -> Any:
        found = callback(operation.evaluate, shapes(given), *given)
        return found[0] if len(found) == 1 else tuple(found)

    def forward(*given: Any) -> Any:
        found = call(*given)
        return found, (given, found if is_rollout else ())

    def backward(saved: Any, factors: Any) -> Any:
        given, results = saved
        own = factors if isinstance(factors, tuple) else (factors,)
        count = len(given)

        def evaluate(arrays: Any) -> Any:
            first, rest = arrays[:count], arrays[count:]
            if is_rollout:
                return operation.pull_back(first, rest[:2], rest[2:])
            return operation.pull_back(first, rest)

        found = callback(evaluate, [np.shape(value) for value in given], *given, *results, *own)
        return tuple(jnp.asarray(array, dtype=jnp.result_type(value)) for array, value in zip(found, given))

    call.defvjp(forward, backward)
    return call


class Operations(BaseOperations):
    """The functions of a class as operations, with values of its parameters: numbers or arrays."""

    def __init__(self, kind: type[Mechanism], **parameters: Any) -> None:
        super().__init__(kind)
        values = [jnp.asarray(value, dtype=float) for value in parameter_values(kind, parameters)]
        self.parameters = jnp.stack(jnp.broadcast_arrays(*values), axis=-1) if values else jnp.zeros(0)

    def _apply(self, operation: Any, given: Any) -> Any:
        return _operation(operation)(self.parameters, *[jnp.asarray(value, dtype=float) for value in given])
