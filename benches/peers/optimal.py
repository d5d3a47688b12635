"""Crocoddyl on the problems of `benches/src/bin/optimal.rs`: times of the parts of an iteration, and the costs of its iterates.

    python optimal.py URDF_FOLDER LINKWORK_PROGRAM [--quick]

Runs the program, compares the costs of all iterates, and prints a table of nanoseconds a node.
"""

import json
import os
import subprocess
import sys
import time

os.environ.setdefault("OMP_NUM_THREADS", "1")

import crocoddyl
import numpy as np
import pinocchio as pin

NODES, PERIOD, ITERATIONS = 100, 0.01, 8


def panda(folder):
    whole = pin.buildModelFromUrdf(f"{folder}/panda.urdf")
    fingers = [whole.getJointId(f"panda_finger_joint{k}") for k in (1, 2)]
    return pin.buildReducedModel(whole, fingers, pin.neutral(whole))


def solo(folder):
    return pin.buildModelFromUrdf(f"{folder}/solo12.urdf", pin.JointModelFreeFlyer())


def problem(model, floating):
    model.damping[:] = 0
    model.friction[:] = 0
    state = crocoddyl.StateMultibody(model)
    nv, base = model.nv, 6 if floating else 0
    if floating:
        model.gravity = pin.Motion.Zero()
    actuation = crocoddyl.ActuationModelFloatingBase(state) if floating else crocoddyl.ActuationModelFull(state)

    def at(x):
        displacement = np.concatenate([np.zeros(base), np.full(nv - base, x)])
        return np.concatenate([pin.integrate(model, pin.neutral(model), displacement), np.zeros(nv)])

    start, goal = at(0.1), at(-0.2)

    def differential(of_q, of_v, of_u):
        costs = crocoddyl.CostModelSum(state, actuation.nu)
        weights = np.concatenate([np.full(nv, of_q), np.full(nv, of_v)])
        residual = crocoddyl.ResidualModelState(state, goal, actuation.nu)
        costs.addCost("state", crocoddyl.CostModelResidual(state, crocoddyl.ActivationModelWeightedQuad(weights), residual), 1.0)
        if of_u:
            effort = crocoddyl.ResidualModelControl(state, actuation.nu)
            costs.addCost("effort", crocoddyl.CostModelResidual(state, effort), of_u)
        return crocoddyl.DifferentialActionModelFreeFwdDynamics(state, actuation, costs)

    running = crocoddyl.IntegratedActionModelEuler(differential(1.0, 0.1, 1e-2), PERIOD)
    terminal = crocoddyl.IntegratedActionModelEuler(differential(100.0, 1.0, 0.0), 0.0)
    return crocoddyl.ShootingProblem(start, [running] * NODES, terminal)


def least(function, repeats):
    best = float("inf")
    for _ in range(repeats):
        begin = time.process_time_ns()
        function()
        best = min(best, time.process_time_ns() - begin)
    return best / NODES


def measure(shooting, repeats):
    shooting.nthreads = 1
    nu = shooting.runningModels[0].nu
    # What holds an arm still where it begins; nothing holds a flying body.
    model = shooting.runningModels[0].state.pinocchio
    q, nothing = shooting.x0[: model.nq], np.zeros(model.nv)
    held = pin.rnea(model, model.createData(), q, nothing, nothing) if nu == model.nv else np.zeros(nu)
    us = [held] * NODES
    xs = shooting.rollout(us)
    solver = crocoddyl.SolverDDP(shooting)
    logger = crocoddyl.CallbackLogger()
    solver.setCallbacks([logger])
    solver.th_stop, solver.reg_min = 1e-30, 1e-20
    solver.solve(xs, us, ITERATIONS, True, 1e-20)
    costs = list(logger.costs)
    solver.setCallbacks([])
    found = {"costs": costs, "steps": list(logger.steps)}
    xs, us = list(solver.xs), list(solver.us)
    solver.setCandidate(xs, us, True)
    solver.computeDirection(True)
    found["linearise"] = least(lambda: (shooting.calc(xs, us), shooting.calcDiff(xs, us)), repeats)
    found["backward"] = least(solver.backwardPass, repeats)
    found["rollout"] = least(lambda: solver.forwardPass(1.0), repeats)
    return found


def main():
    folder, program = sys.argv[1:3]
    repeats = 30 if "--quick" in sys.argv else 200
    own = json.loads(subprocess.run([program], check=True, capture_output=True, text=True).stdout)
    print("| problem | | linearise | backward | rollout | iteration |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    for name, model, floating in [("panda", panda(folder), False), ("solo", solo(folder), True)]:
        peer = measure(problem(model, floating), repeats)
        mine = own[name]
        parts = ["linearise", "backward", "rollout"]
        for who, times in (("Crocoddyl", peer), ("Linkwork", mine)):
            times["iteration"] = sum(times[part] for part in parts)
            row = " | ".join(f"{times[part]:.0f}" for part in parts + ["iteration"])
            print(f"| {name} | {who} | {row} |")
        row = " | ".join(f"{peer[part] / mine[part]:.1f} ×" for part in parts + ["iteration"])
        print(f"| | ratio | {row} |")
        theirs, ours = np.array(peer["costs"]), np.array(mine["costs"])
        count = min(len(theirs), len(ours))
        off = np.max(np.abs(theirs[:count] - ours[:count]) / np.abs(theirs[:count]))
        print(f"\ncosts of {count} iterates differ by {off:.1e} at most; steps {peer['steps']}: {theirs}\n")
        assert count >= 3 and off < 1e-6, (theirs, ours)


main()
