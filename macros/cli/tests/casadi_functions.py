"""Compares the functions of a cart-pole that CasADi loads: Jacobians with central differences, steps with
each other."""

import casadi
import numpy as np

numbers = np.random.default_rng(0)


def external(name, prefix="fixed"):
    return casadi.external(f"{prefix}_{name}", f"./lib{prefix}.so")


def check_jacobian(name):
    f = external(name)
    given = [np.full(1, 0.01) if f.name_in(i) == "h" else numbers.uniform(-1, 1, f.size1_in(i)) for i in range(f.n_in())]
    blocks = f.jacobian()(*given, *[casadi.DM(*f.size_out(i)) for i in range(f.n_out())])
    blocks = list(blocks) if isinstance(blocks, tuple) else [blocks]

    def results(at):
        found = f(*at)
        return [np.array(x).ravel() for x in (found if isinstance(found, tuple) else (found,))]

    for o in range(f.n_out()):
        for i in range(f.n_in()):
            block = np.array(blocks.pop(0))
            for c in range(f.size1_in(i)):
                step = 1e-5 * np.eye(f.size1_in(i))[c]
                ends = [results([x + side * step if k == i else x for k, x in enumerate(given)])[o] for side in (1, -1)]
                slope = (ends[0] - ends[1]) / 2e-5
                assert np.abs(slope - block[:, c]).max() < 1e-7, (name, o, i, c)


for name in ["forward_dynamics", "inverse_dynamics", "rk4_step", "semi_implicit_euler_step", "position_pole"]:
    check_jacobian("casadi_" + name)

# The step and its Jacobian by CasADi equal those that acados loads.
x, u = casadi.MX.sym("x", 4), casadi.MX.sym("u", 1)
end = casadi.vertcat(*external("casadi_rk4_step")(x[:2], x[2:], u, 0.01))
step = casadi.Function("step", [x, u], [end, casadi.jacobian(end, casadi.vertcat(u, x)).T])
state, push = [0.1, 0.2, 0.3, 0.4], [0.5]
for found, expected in zip(external("dyn_disc_phi_fun_jac")(state, push, [0.01]), step(state, push)):
    assert np.abs(np.array(found) - np.array(expected)).max() < 1e-14
assert np.abs(np.array(external("dyn_disc_phi_fun")(state, push, [0.01])) - np.array(step(state, push)[0])).max() < 1e-14

# State derivatives, and forward and adjoint sensitivities.
rates, a, b = (np.array(m) for m in external("expl_vde_forw")(state, np.eye(4), np.zeros((4, 1)), push, []))
assert np.abs(np.array(external("expl_ode_fun")(state, push, [])) - rates).max() < 1e-14
adjoint = np.array(external("expl_vde_adj")(state, [1, 2, 3, 4], push, [])).ravel()
assert np.abs(adjoint - np.concatenate([a.T, b.T]) @ [1, 2, 3, 4]).max() < 1e-12
acceleration = external("casadi_forward_dynamics")
assert np.abs(rates[2:].ravel() - np.array(acceleration(state[:2], state[2:], [0.5, 0])).ravel()).max() < 1e-12

# Parameters that are not fixed are an additional argument.
open_step = external("dyn_disc_phi_fun", "open")
assert open_step.size1_in(2) == 4
assert np.abs(np.array(open_step(state, push, [0.01, 0.3, 0.8, 0.4])) - np.array(step(state, push)[0])).max() < 1e-14

# Swing-up of the pole by direct multiple shooting.
problem = casadi.Opti()
states, pushes = problem.variable(4, 51), problem.variable(1, 50)
for k in range(50):
    at = external("casadi_rk4_step")(states[:2, k], states[2:, k], pushes[:, k], 0.04)
    problem.subject_to(states[:, k + 1] == casadi.vertcat(*at))
problem.subject_to(states[:, 0] == 0)
problem.subject_to(states[:, 50] == [0, np.pi, 0, 0])
problem.minimize(casadi.sumsqr(pushes))
problem.solver("ipopt", {"print_time": False}, {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory"})
solution = problem.solve()
q, v = [0, 0], [0, 0]
for k in range(50):
    q, v = external("casadi_rk4_step")(q, v, solution.value(pushes)[k], 0.04)
assert np.abs(np.array(q).ravel() - [0, np.pi]).max() < 1e-4, q
