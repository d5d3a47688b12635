"""Equilibrium configurations."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ._names import Error

if TYPE_CHECKING:
    from ._mechanism import Mechanism

Vector = NDArray[Any]


class Rest:
    """Equations of a mechanism at rest under constant inputs, along its free velocities: applied forces
    balance constraint forces, and the constraints are satisfied."""

    def __init__(self, mechanism: "Mechanism", inputs: Vector, free: Vector) -> None:
        self.m: Any = mechanism
        self.u, self.free = inputs, free
        self.zero = np.zeros(mechanism.nv)
        self.time = [0.0] if mechanism._description["time"] else []
        self.is_constrained = bool(mechanism._description["constraints"])

    def forces(self, q: Vector) -> Any:
        m = self.m
        return m.inverse_dynamics(*self.time, q, self.zero, self.zero) - m._forces(self.time, q, self.zero, self.u)

    def jacobian(self, q: Vector) -> Any:
        return self.m.constraint_jacobian(*self.time, q) if self.is_constrained else np.zeros((0, self.m.nv))

    def residuals(self, q: Vector) -> Any:
        return self.m.constraint_residuals(*self.time, q) if self.is_constrained else np.zeros(0)

    def multipliers(self, q: Vector) -> Any:
        """Returns the multipliers that balance the forces in the least-squares sense."""
        jacobian, forces = self.jacobian(q), self.forces(q)[self.free]
        if not (len(jacobian) and np.all(np.isfinite(forces)) and np.all(np.isfinite(jacobian))):
            return np.zeros(len(jacobian))
        return np.linalg.lstsq(jacobian.T[self.free], forces, rcond=1e-13)[0]

    def lacking(self, q: Vector, multipliers: Vector) -> Vector:
        balance = self.forces(q) - self.jacobian(q).T @ multipliers
        return np.concatenate([balance[self.free], self.residuals(q)])

    def slope(self, q: Vector, multipliers: Vector) -> Vector:
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

    def moved(self, x: tuple[Vector, Vector], step: Vector) -> tuple[Vector, Vector]:
        move = np.zeros(self.m.nv)
        count = self.free.sum()
        move[self.free] = step[:count]
        return self.m.integrate(x[0], move), x[1] + step[count:]


def find(rest: Rest, q: Vector, tolerance: float, iterations: int) -> Vector:
    """Returns an equilibrium configuration near `q`, by Newton's method with step halving."""
    x = (q, rest.multipliers(q))
    lacking = rest.lacking(*x)
    if not np.all(np.isfinite(lacking)):
        raise Error("no equilibrium was found: forces are not finite where the search begins")
    for _ in range(iterations):
        slope = rest.slope(*x)
        if not np.all(np.isfinite(slope)):
            break
        step = -np.linalg.lstsq(slope, lacking, rcond=1e-13)[0]
        largest = np.abs(step[: rest.free.sum()]).max()
        part = 1.0
        while True:
            there = rest.moved(x, part * step)
            found = rest.lacking(*there)
            if np.linalg.norm(found) < np.linalg.norm(lacking) or part * largest < tolerance or part < 2e-6:
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
