"""Tests of exact gradients: closed forms, and differences of the libraries for learning where they are installed."""

import importlib.util
import unittest

import numpy as np

import linkwork
from linkwork._gradients import Operation, Rollout

from mechanisms import BEAD, PENDULUM, SLIDER, compiled

# A free body with an arm on a ball joint, a motor, a spring and friction.
SPINNER = """
#[mechanism(gravity = -9.81 * z)]
pub struct Spinner {
    pub mass: f64,
    pub stiffness: f64,
    #[body(mass = mass, inertia = diagonal(0.3, 0.2, 0.15))]
    base: Body,
    #[body(mass = 0.5, com = 0.1 * x, inertia = diagonal(0.01, 0.02, 0.025))]
    arm: Body,
    #[body(mass = 0.4, com = 0.2 * y, inertia = diagonal(0.01, 0.02, 0.025))]
    hand: Body,
    #[joint(ground -> base)]
    free: Free,
    #[joint(base.at(0.2 * x) -> arm, about = y)]
    hinge: Pin,
    #[joint(arm.at(0.3 * x) -> hand)]
    wrist: Ball,
    #[acts(on = hinge, stiffness = stiffness)]
    spring: Spring,
    #[acts(on = hinge)]
    motor: Torque,
}
"""
def arguments(kind, operation, lead, seed):
    """Returns random values of parameters and arguments, with quaternions of any length near one."""
    rng = np.random.default_rng(seed)
    given = [rng.uniform(0.5, 1.5, lead + operation.shapes[0])]
    names = [name for name, shape in operation.function.arguments if shape is not None]
    for name, shape in zip(names, operation.shapes[1:]):
        value = rng.normal(0, 0.4, lead + shape)
        if name in ("q", "from", "to") and kind.nq != kind.nv:
            value = value + kind(dict.fromkeys(kind.parameter_names, 1.0)).neutral()
        given.append(value)
    return given


def differences(evaluate, given, factors, k):
    """Returns derivatives by argument `k` as central differences."""
    found = np.zeros(np.shape(given[k]))
    for at in np.ndindex(*found.shape):
        sides = []
        for step in (1e-6, -1e-6):
            moved = [np.array(value, dtype=float) for value in given]
            moved[k][at] += step
            sides.append(sum((a * b).sum() for a, b in zip(evaluate(moved), factors)))
        found[at] = (sides[0] - sides[1]) / 2e-6
    return found


class AgainstDifferences(unittest.TestCase):
    """Vector–Jacobian products of all functions that have them."""

    def check(self, evaluate, pull_back, given, results, seed):
        rng = np.random.default_rng(seed)
        factors = [rng.normal(size=np.shape(result)) for result in results]
        for k, found in enumerate(pull_back(factors)):
            expected = differences(evaluate, given, factors, k)
            scale = 1 + np.abs(expected).max(initial=0)
            np.testing.assert_allclose(found, expected, rtol=0, atol=2e-7 * scale)

    def check_functions(self, kind):
        names = []
        for name in kind._functions:
            operation = Operation(kind, name, 0)
            given = arguments(kind, operation, (), 3)
            try:
                operation.pull_back(given, [np.ones(shape) for shape in operation.results])
            except linkwork.Error as error:
                self.assertRegex(str(error), "has no vector–Jacobian product")
                continue
            with self.subTest(name):
                names.append(name)
                self.check(operation.evaluate, lambda f: operation.pull_back(given, f), given, operation.evaluate(given), 4)
        return names

    def test_functions_of_a_tree(self):
        names = self.check_functions(compiled(SPINNER))
        expected = """mass_matrix bias_forces inverse_dynamics forward_dynamics generalized_forces kinetic_energy
            potential_energy center_of_mass integrate difference tangent_rate step frame_placement frame_velocity
            frame_acceleration frame_jacobian""".split()
        self.assertLessEqual(set(expected), set(names))

    def test_functions_of_time(self):
        self.assertIn("step", self.check_functions(linkwork.gallery("KapitzaPendulum")))

    def test_functions_of_constraints_and_tables(self):
        self.assertIn("constraint_jacobian", self.check_functions(compiled(BEAD)))
        table = ([[-2.0, 0.0, 1.0, 2.0]], [16.0, 0.0, 3.0, 16.0], "smooth")
        self.assertIn("potential_energy", self.check_functions(compiled(SLIDER, tables={"energy": table})))

    def test_rollouts(self):
        kind = compiled(SPINNER)
        rng = np.random.default_rng(5)
        q = kind(mass=1.0, stiffness=1.0).neutral() + rng.normal(0, 0.2, (2, kind.nq))
        given = [np.array([1.2, 3.0]), q, rng.normal(0, 0.5, (2, kind.nv)), rng.normal(size=(4, 1))]
        rollout = Rollout(kind, 0.05)
        results = rollout.evaluate(given)
        self.assertEqual(results[0].shape, (2, 5, kind.nq))
        self.check(rollout.evaluate, lambda f: rollout.pull_back(given, results, f), given, results, 6)

    def test_a_closed_form(self):
        # τ = m g l/2 sin θ at rest.
        operation = Operation(compiled(PENDULUM), "inverse_dynamics")
        by_parameters, by_q, _, by_a = operation.pull_back([[2.0, 1.5], [0.4], [0.0], [0.0]], [[1.0]])
        np.testing.assert_allclose(by_parameters, [9.81 * 0.75 * np.sin(0.4), 2.0 * 9.81 / 2 * np.sin(0.4)], rtol=1e-14)
        np.testing.assert_allclose(by_q, [2.0 * 9.81 * 0.75 * np.cos(0.4)], rtol=1e-14)
        np.testing.assert_allclose(by_a, [2.0 * 1.5**2 / 3], rtol=1e-14)

    def test_errors(self):
        kind = compiled(PENDULUM)
        with self.assertRaisesRegex(KeyError, "did you mean 'mass_matrix'"):
            Operation(kind, "mass_matrx")
        with self.assertRaisesRegex(ValueError, "expected the shape"):
            Operation(kind, "mass_matrix").evaluate([[2.0, 1.5], [0.0, 0.0]])
        with self.assertRaisesRegex(TypeError, "takes 1 arguments, found 2"):
            Operation(kind, "mass_matrix").evaluate([[2.0, 1.5], [0.0], [0.0]])
        with self.assertRaisesRegex(linkwork.Error, "has no vector–Jacobian product"):
            Operation(kind, "linearize").pull_back([[2.0, 1.5], [0.0], [0.0], [0.0]], [np.eye(2), np.zeros((2, 1))])


@unittest.skipUnless(importlib.util.find_spec("torch"), "PyTorch is not installed")
class WithTorch(unittest.TestCase):
    """Operations of PyTorch."""

    def test_gradients(self):
        import torch

        import linkwork.torch

        kind = compiled(PENDULUM)
        tensor = lambda *shape: torch.rand(*shape, dtype=torch.float64, requires_grad=True)
        mass, q, v, a, u = tensor(3), tensor(3, 1), tensor(3, 1), tensor(1), tensor(3, 4, 1)
        functions = lambda m: linkwork.torch.Operations(kind, mass=1.0 + m, length=1.5)
        self.assertTrue(torch.autograd.gradcheck(lambda m, *x: functions(m).inverse_dynamics(*x), (mass, q, v, a)))
        self.assertTrue(torch.autograd.gradcheck(lambda m, *x: functions(m).forward_dynamics(*x), (mass, q, v, a)))
        self.assertTrue(torch.autograd.gradcheck(lambda m, q: functions(m).frame_placement("rod", q), (mass, q)))
        self.assertTrue(torch.autograd.gradcheck(lambda m, *x: functions(m).roll_out(*x, h=0.05), (mass, q, v, u)))


@unittest.skipUnless(importlib.util.find_spec("jax"), "JAX is not installed")
class WithJax(unittest.TestCase):
    """Operations of JAX."""

    def test_gradients(self):
        import jax
        from jax.test_util import check_grads

        import linkwork.jax

        jax.config.update("jax_enable_x64", True)
        kind = compiled(PENDULUM)
        rng = np.random.default_rng(1)
        mass, q, v, a, u = (rng.uniform(size=shape) for shape in [(3,), (3, 1), (3, 1), (1,), (3, 4, 1)])
        functions = lambda m: linkwork.jax.Operations(kind, mass=1.0 + m, length=1.5)
        for function, given in [
            (lambda m, *x: functions(m).inverse_dynamics(*x), (mass, q, v, a)),
            (lambda m, *x: functions(m).forward_dynamics(*x), (mass, q, v, a)),
            (lambda m, q: functions(m).frame_placement("rod", q), (mass, q)),
            (lambda m, *x: functions(m).roll_out(*x, h=0.05), (mass, q, v, u)),
        ]:
            check_grads(function, given, order=1, modes=["rev"])
        one = linkwork.jax.Operations(kind, mass=2.0, length=1.5)
        torque = lambda q: one.inverse_dynamics(q, jax.numpy.zeros(1), jax.numpy.zeros(1))[0]
        found = jax.jit(jax.vmap(jax.grad(torque)))(q)
        np.testing.assert_allclose(found, 2.0 * 9.81 * 0.75 * np.cos(q), rtol=1e-12)


if __name__ == "__main__":
    unittest.main()
