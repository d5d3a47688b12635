"""Crocoddyl on the problems of `benches/src/bin/optimal/main.rs`: times of the phases of an iteration, and the costs of its iterates.

    python optimal.py URDF_FOLDER LINKWORK_PROGRAM [--quick]

Runs the program, compares the costs of all iterates, and prints a table of nanoseconds per node.
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
from crocoddyl.utils.quadruped import SimpleQuadrupedalGaitProblem

NODES, PERIOD, ITERATIONS = 100, 0.01, 8
PARTS = ["linearise", "backward", "rollout"]


def panda(folder):
    whole = pin.buildModelFromUrdf(f"{folder}/panda.urdf")
    fingers = [whole.getJointId(f"panda_finger_joint{k}") for k in (1, 2)]
    return pin.buildReducedModel(whole, fingers, pin.neutral(whole))


def solo(folder):
    return pin.buildModelFromUrdf(f"{folder}/solo12.urdf", pin.JointModelFreeFlyer())


def problem(model, own, gravity):
    """Returns a problem with the start and the goal of Linkwork's."""
    model.damping[:] = 0
    model.friction[:] = 0
    state = crocoddyl.StateMultibody(model)
    nv, floating = model.nv, model.nq != model.nv
    if not gravity:
        model.gravity = pin.Motion.Zero()
    actuation = crocoddyl.ActuationModelFloatingBase(state) if floating else crocoddyl.ActuationModelFull(state)
    start, goal = (np.concatenate([own[of], np.zeros(nv)]) for of in ("start", "goal"))

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


def trot(folder, own):
    """Returns the trot of Crocoddyl's example (`crocoddyl.utils.quadruped`): its models of swing and touchdown, with Linkwork's gait."""
    model = solo(folder)
    model.damping[:] = 0
    model.friction[:] = 0
    start = np.array(own["start"])
    model.referenceConfigurations["standing"] = start
    feet = ["FL_FOOT", "FR_FOOT", "HL_FOOT", "HR_FOOT"]
    gait = SimpleQuadrupedalGaitProblem(model, *feet)
    ids = [model.getFrameId(name) for name in feet]

    def node(phase):
        held = [ids[k] for k in range(4) if phase["holds"][k]]
        aims = [(ids[k], np.array(aim)) for k, aim in enumerate(phase["feet"]) if aim]
        task = [[foot, pin.SE3(np.eye(3), aim)] for foot, aim in aims] or None
        if phase["lands"]:
            return gait.createImpulseModel(held, task)
        centre = phase["centre"] and np.array(phase["centre"])
        action = gait.createSwingFootModel(PERIOD, held, centre, task)
        # No state comes near the limits of the file.
        action.differential.costs.removeCost("stateBounds")
        return action

    nodes = [node(phase) for phase in own["phases"]]
    return crocoddyl.ShootingProblem(np.concatenate([start, np.zeros(model.nv)]), nodes[:-1], nodes[-1])


def least(function, repeats, nodes):
    best = float("inf")
    for _ in range(repeats):
        begin = time.process_time_ns()
        function()
        best = min(best, time.process_time_ns() - begin)
    return best / nodes


def measure(shooting, own, repeats):
    shooting.nthreads = 1
    us = [np.array(u[: model.nu]) for u, model in zip(own["inputs"], shooting.runningModels)]
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
    found["linearise"] = least(lambda: (shooting.calc(xs, us), shooting.calcDiff(xs, us)), repeats, len(us))
    found["backward"] = least(solver.backwardPass, repeats, len(us))
    found["rollout"] = least(lambda: solver.forwardPass(1.0), repeats, len(us))
    return found


def main():
    folder, program = sys.argv[1:3]
    repeats = 30 if "--quick" in sys.argv else 200
    own = json.loads(subprocess.run([program], check=True, capture_output=True, text=True).stdout)
    print("| problem | | linearise | backward | rollout | iteration |")
    print("| --- | --- | ---: | ---: | ---: | ---: |")
    problems = {
        "panda": problem(panda(folder), own["panda"], True),
        "solo": problem(solo(folder), own["solo"], False),
        "trot": trot(folder, own["trot"]),
    }
    for name, shooting in problems.items():
        mine = own[name]
        peer = measure(shooting, mine, repeats)
        # Linkwork linearises and runs backwards in one pass, which stores only the matrices of the policies.
        peer["iteration"] = sum(peer[part] for part in PARTS)
        mine["iteration"] = mine["sweep"] + mine["rollout"]
        for who, times in (("Crocoddyl", peer), ("Linkwork", mine)):
            row = " | ".join(f"{times[part]:.0f}" for part in [*PARTS, "iteration"])
            print(f"| {name} | {who} | {row} |")
        row = " | ".join(f"{peer[part] / mine[part]:.1f} ×" for part in [*PARTS, "iteration"])
        print(f"| | ratio | {row} |")
        theirs, ours = np.array(peer["costs"]), np.array(mine["costs"])
        count = min(len(theirs), len(ours))
        off = np.max(np.abs(theirs[:count] - ours[:count]) / np.abs(theirs[:count]))
        print(f"\ncosts of {count} iterates differ by {off:.1e} at most; steps {peer['steps']}: {theirs}\n")
        assert count >= 3 and off < 1e-6, (theirs, ours)


main()
