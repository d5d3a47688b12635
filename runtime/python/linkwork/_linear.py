"""Linear systems of mechanisms with constraints."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


def pivots(jacobian: Array) -> list[int]:
    """Returns the velocities that constraints determine from the others: the pivots of an elimination."""
    rest = np.array(jacobian, dtype=float)
    scale, found = np.abs(rest).max(initial=0.0), []
    for _ in range(len(rest)):
        row, column = np.unravel_index(np.abs(rest).argmax(), rest.shape)
        pivot = rest[row, column]
        # Further rows depend on those before.
        if abs(pivot) <= 1e-9 * scale:
            break
        found.append(int(column))
        rest -= np.outer(rest[:, column], rest[row] / pivot)
        rest[row] = 0.0
        rest[:, column] = 0.0
    return found


def completion(jacobian: Array) -> tuple[list[int], Array]:
    """Returns the independent velocities, and the matrix that all velocities are the product of with these."""
    n = jacobian.shape[1]
    dependent = pivots(jacobian)
    independent = [k for k in range(n) if k not in dependent]
    matrix = np.zeros((n, len(independent)))
    matrix[independent, range(len(independent))] = 1.0
    if dependent:
        matrix[dependent] = -np.linalg.lstsq(jacobian[:, dependent], jacobian[:, independent], rcond=None)[0]
    return independent, matrix


def at_rest(m: Any, time: list[float], q: Array, u: Array) -> tuple[Array, Array, list[int], list[int]]:
    """Returns the matrices of the linear system about a state at rest, and the indices of the velocities of its
    independent displacements and velocities."""
    zero = np.zeros(m.nv)
    jacobian = m.constraint_jacobian(*time, q)
    holonomic = len(m.constraint_residuals(*time, q)) if "constraint_residuals" in m._functions else 0
    displacements, by_displacements = completion(jacobian[:holonomic])
    velocities, by_velocities = completion(jacobian)
    tau = m._forces(time, q, zero, u)
    by_q, by_v, by_tau = m.forward_dynamics_derivatives(*time, q, zero, tau)
    by_u = np.zeros((m.nv, m.nu))
    if m.nu:
        forces = m.generalized_forces_derivatives(*time, q, zero, u)
        by_q, by_v, by_u = by_q + by_tau @ forces[0], by_v + by_tau @ forces[1], by_tau @ forces[2]
    n = len(displacements)
    a = np.zeros((n + len(velocities),) * 2)
    a[:n, n:] = by_velocities[displacements]
    a[n:, :n] = (by_q @ by_displacements)[velocities]
    a[n:, n:] = (by_v @ by_velocities)[velocities]
    return a, np.vstack([np.zeros((n, m.nu)), by_u[velocities]]), displacements, velocities
