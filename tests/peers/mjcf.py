"""Compares Linkwork's functions with MuJoCo's on the robot files of Python packages.

    python mjcf.py EVALUATE [PACKAGE ...]

EVALUATE is the example of this name of linkwork-compiler. Every file of the packages that MuJoCo reads and that has degrees of
freedom is compared at random states, without contacts, limits and soft constraints: the mass matrix, the bias forces (with springs,
dampers, friction and the constant forces of servos), the forces of the actuators and the accelerations. If Linkwork does not support
an element of a file, the option that its message suggests omits the element, in MuJoCo, too.

Differences are relative to the largest entry, or to one if all entries are smaller. MuJoCo computes the principal axes of an inertia
with errors of some 1e-11, which light links and ill-conditioned mass matrices amplify. Files with too large differences are therefore
compared again with the masses, centres and principal axes that MuJoCo has computed.
"""

import collections
import pathlib
import re
import subprocess
import sys
import threading

import mujoco
import numpy as np

PACKAGES = ["gymnasium", "gymnasium_robotics", "metaworld", "dm_control", "robosuite", "mujoco"]
TOLERANCE = 1e-9
STATES = 2
# Maximum number of velocities of a robot, and maximum seconds per robot.
MOST = 128
PATIENCE = 240
# The velocity width of the smooth friction that approximates Coulomb's, rad/s and m/s.
SLIP = 0.01

FREE, BALL, SLIDE, HINGE = range(4)


class Refused(Exception):
    """Linkwork's message for a file that it rejects."""


class Evaluated:
    """A file as read by Linkwork."""

    def __init__(self, program, path, options):
        command = [program, "mjcf", str(path), *options]
        pipes = dict(stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        self.process = subprocess.Popen(command, text=True, **pipes)
        self.clock = threading.Timer(PATIENCE, self.process.kill)
        self.clock.start()
        head = [self.process.stdout.readline().rstrip("\n").split("\t") for _ in range(4)]
        if head[0][0] != "configuration":
            message = self.process.stderr.read()
            self.close()
            raise Refused(message or "takes too long")
        names = [[name for name in line[1:] if name] for line in head]
        self.configuration, self.velocities, self.inputs, self.left_out = names

    def at(self, q, v, u, tau):
        numbers = np.concatenate([q, v, u, tau])
        self.process.stdin.write(" ".join(repr(float(x)) for x in numbers) + "\n")
        self.process.stdin.flush()
        lines = [self.process.stdout.readline() for _ in range(6)]
        return [np.array([float(x) for x in line.split()]) for line in lines]

    def close(self):
        self.clock.cancel()
        self.process.kill()
        self.process.communicate()


def load(path, options):
    """Returns MuJoCo's model without the elements that both sides omit."""
    model = mujoco.MjModel.from_xml_path(str(path))
    off = mujoco.mjtDisableBit
    flags = off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_EQUALITY | off.mjDSBL_FRICTIONLOSS | off.mjDSBL_CLAMPCTRL
    if "passive = ignore" in options:
        flags |= off.mjDSBL_PASSIVE
        model.opt.density = model.opt.viscosity = 0
        model.dof_frictionloss[:] = 0
        model.tendon_frictionloss[:] = 0
    if "inputs = none" in options:
        flags |= off.mjDSBL_ACTUATION
    model.opt.disableflags |= int(flags)
    model.actuator_forcelimited[:] = 0
    model.jnt_actfrclimited[:] = 0
    return model


def rows(model):
    """Returns the linear conditions of joints and fixed tendons: weights of the velocities, and the value of the sum."""
    at = model.jnt_dofadr
    zero = {at[joint]: model.qpos0[model.jnt_qposadr[joint]] for joint in range(model.njnt)}

    def weights(kind, number):
        if kind == mujoco.mjtEq.mjEQ_JOINT:
            return {at[number]: 1.0}
        first, count = model.tendon_adr[number], model.tendon_num[number]
        wraps = range(first, first + count)
        if any(model.wrap_type[k] != mujoco.mjtWrap.mjWRAP_JOINT for k in wraps):
            return {}
        return {at[model.wrap_objid[k]]: model.wrap_prm[k] for k in wraps}

    for k in np.flatnonzero(model.eq_active0 == 1):
        kind, (a0, a1, *higher) = model.eq_type[k], model.eq_data[k, :5]
        if kind not in (mujoco.mjtEq.mjEQ_JOINT, mujoco.mjtEq.mjEQ_TENDON):
            continue
        row = weights(kind, model.eq_obj1id[k])
        if model.eq_obj2id[k] >= 0:
            if any(higher):
                continue
            for dof, weight in weights(kind, model.eq_obj2id[k]).items():
                row[dof] = row.get(dof, 0.0) - a1 * weight
        yield row, a0 + sum(weight * zero[dof] for dof, weight in row.items())


def couplings(model, velocities):
    """Returns q0 and P of q = q0 + P y and v = P w, where y and w belong to the independent joints, which Linkwork retains."""
    dofs = {model.joint(joint).name: model.jnt_dofadr[joint] for joint in range(model.njnt)}
    single = {name for name, joint in zip(dofs, range(model.njnt)) if model.jnt_type[joint] in (SLIDE, HINGE)}
    led = {dofs[name] for name in single if name and name not in velocities}
    P, q0 = np.eye(model.nv), np.zeros(model.nv)
    todo, conditions = set(led), list(rows(model))
    for _ in led:
        for row, total in conditions:
            unknown = todo & set(row)
            if len(unknown) == 1:
                dof = unknown.pop()
                others = [(other, weight) for other, weight in row.items() if other != dof]
                P[dof] = -sum((weight * P[other] for other, weight in others), np.zeros(model.nv)) / row[dof]
                q0[dof] = (total - sum(weight * q0[other] for other, weight in others)) / row[dof]
                todo.remove(dof)
    kept = [k for k in range(model.nv) if k not in led]
    return P[:, kept], q0, kept


def random_state(model, P, q0, kept, rng):
    """Returns a state for both: q of MuJoCo, q of Linkwork, and v of Linkwork with T and its rate, where T v is MuJoCo's velocity."""
    nv = model.nv
    v, T, rate = P @ rng.normal(size=len(kept)), np.eye(nv), np.zeros((nv, nv))
    q, own, alone = np.zeros(model.nq), [], np.zeros(nv)
    for joint in range(model.njnt):
        a, b, kind = model.jnt_qposadr[joint], model.jnt_dofadr[joint], model.jnt_type[joint]
        if kind in (FREE, BALL):
            turn = rng.normal(size=4)
            turn /= np.linalg.norm(turn)
            at = a + 3 if kind == FREE else a
            q[at : at + 4] = turn
            if kind == FREE:
                q[a : a + 3] = rng.normal(size=3)
                R = np.zeros(9)
                mujoco.mju_quat2Mat(R, turn)
                T[b : b + 3, b : b + 3] = R.reshape(3, 3)
                x, y, z = v[b + 3 : b + 6]
                rate[b : b + 3, b : b + 3] = R.reshape(3, 3) @ np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
                own += list(q[a : a + 3])
            own += list(turn[[1, 2, 3, 0]])
            continue
        alone[b] = model.qpos0[a] + rng.normal() * (0.7 if kind == HINGE else 0.2)
        if b in kept:
            own.append(alone[b])
    single = [joint for joint in range(model.njnt) if model.jnt_type[joint] in (SLIDE, HINGE)]
    placed = q0 + P @ alone[kept]
    for joint in single:
        q[model.jnt_qposadr[joint]] = placed[model.jnt_dofadr[joint]]
    return q, np.array(own), v, T, rate


def friction(model, data):
    total = model.dof_frictionloss * np.tanh(data.qvel / SLIP)
    lengths = data.ten_J.reshape(model.ntendon, model.nv)
    for row, loss in zip(lengths, model.tendon_frictionloss):
        total = total + row * loss * np.tanh(row @ data.qvel / SLIP)
    return total


def difference(found, expected):
    if found.shape != expected.shape or not np.isfinite(found).all():
        return np.inf
    return np.abs(found - expected).max() / max(1.0, np.abs(expected).max()) if expected.size else 0.0


def compare(program, path, options):
    """Returns the largest differences of mass matrix, bias forces, actuators' forces and accelerations."""
    model = load(path, options)
    if model.nv > MOST:
        raise Refused(f"more than {MOST} velocities")
    linkwork = Evaluated(program, path, options)
    try:
        P, q0, kept = couplings(model, linkwork.velocities)
        if len(linkwork.velocities) != len(kept):
            return dict.fromkeys("Mhga", np.inf)
        driven = "inputs = none" not in options
        worst = dict.fromkeys("Mhga", 0.0)
        rng = np.random.default_rng(26)
        for _ in range(STATES):
            q, own, v, T, rate = random_state(model, P, q0, kept, rng)
            data = mujoco.MjData(model)
            data.qpos[:], data.qvel[:] = q, T @ v
            mujoco.mj_forward(model, data)
            idle = data.qfrc_actuator.copy()
            u = rng.normal(size=len(linkwork.inputs))
            if driven:
                data.ctrl[:] = u
            mujoco.mj_forward(model, data)
            inertia = np.zeros((model.nv, model.nv))
            mujoco.mj_fullM(model, inertia, data.qM)
            loss = friction(model, data)
            passive = data.qfrc_bias - data.qfrc_passive + loss - idle
            TP = T @ P
            M = TP.T @ inertia @ TP
            h = TP.T @ (passive + inertia @ (rate @ v))
            g = TP.T @ (data.qfrc_actuator - idle)
            # Without friction, which is a constraint in MuJoCo.
            a = np.linalg.solve(M, g - h + TP.T @ loss)
            if len(kept) == model.nv:
                a = np.linalg.solve(T, data.qacc - rate @ v)
            found = linkwork.at(own, v[kept], u, g + TP.T @ loss)
            worst["M"] = max(worst["M"], difference(found[0], M.flatten()))
            worst["h"] = max(worst["h"], difference(found[1], h))
            if driven:
                worst["g"] = max(worst["g"], difference(found[2], g))
            # Mechanisms with loops are evaluated by another function.
            if found[3].size:
                worst["a"] = max(worst["a"], difference(found[3], a))
        return worst
    finally:
        linkwork.close()


def options_of(message):
    """Returns the options that the help of a message suggests."""
    found = set(re.findall(r"`#\[mechanism\(…, ([^)]*)\)\]`", message))
    return {"inputs = none" if option.startswith("inputs") else option for option in found}


def reasons(message):
    lines = [line for line in message.splitlines() if line and not line.strip().startswith("=")]
    texts = (re.sub(r"^.*?:\d+:\d+: ", "", line) for line in lines)
    return sorted({re.sub(r"`[^`]*` is a mocap body", "a mocap body holds another", text) for text in texts})


def files(package):
    """Yields the files that MuJoCo reads and that have degrees of freedom."""
    folder = pathlib.Path(mujoco.__file__).parent.parent / package
    for path in sorted(folder.rglob("*.xml")):
        try:
            model = mujoco.MjModel.from_xml_path(str(path))
        except (ValueError, OSError):
            continue
        if model.nv:
            yield path.relative_to(folder.parent), path


def bodies(body):
    """Yields a body and its descendants, in the order of the compiled model."""
    yield body
    for child in body.bodies:
        yield from bodies(child)


def write_anew(path):
    """Returns the file with the inertial parameters and principal axes that MuJoCo has computed."""
    spec = mujoco.MjSpec.from_file(str(path))
    model = spec.compile()
    for k, body in enumerate(bodies(spec.worldbody)):
        if model.body_mass[k] > 0:
            body.explicitinertial = True
            body.fullinertia = np.full(6, np.nan)
            body.mass, body.inertia = model.body_mass[k], model.body_inertia[k]
            body.ipos, body.iquat = model.body_ipos[k], model.body_iquat[k]
    compiler = spec.compiler
    compiler.inertiafromgeom, compiler.balanceinertia, compiler.settotalmass = 0, 0, -1
    compiler.boundmass = compiler.boundinertia = 0
    spec.compile()
    return spec.to_xml()


def compare_written(program, path, options):
    """Returns the differences for a copy of the file that MuJoCo writes next to it, where meshes are found."""
    written = path.with_name("linkwork_written.xml")
    try:
        written.write_text(write_anew(path), encoding="utf-8")
        return compare(program, written, options)
    except (Refused, ValueError, mujoco.FatalError):
        return dict.fromkeys("Mhga", np.inf)
    finally:
        written.unlink(missing_ok=True)


def look(program, path):
    """Returns the differences, the options that were needed, and the reasons."""
    options, why = [], []
    for _ in range(4):
        try:
            return compare(program, path, options), options, why
        except Refused as refused:
            more = options_of(str(refused)) - set(options)
            why += reasons(str(refused))
            if not more:
                return None, options, why
            options = sorted(set(options) | more)
    return None, options, why


def main():
    program, packages = sys.argv[1], sys.argv[2:] or PACKAGES
    needed, left, apart = collections.defaultdict(list), collections.defaultdict(list), []
    print("| package | files | agree | with options | with its principal axes | apart | not read | M | h | a |")
    print("| --- " + "| ---: " * 9 + "|")
    for package in packages:
        counts, worst = collections.Counter(), dict.fromkeys("Mhga", 0.0)
        for name, path in files(package):
            differences, options, why = look(program, path)
            if differences is None:
                kind = "not read"
                left["; ".join(why)].append(name)
            else:
                kind = "options" if options else "agree"
                if max(differences.values()) > TOLERANCE:
                    kind = "written"
                    first, differences = differences, compare_written(program, path, options)
                    apart.append((name, first, differences))
                if max(differences.values()) > TOLERANCE:
                    kind = "apart"
                else:
                    worst = {key: max(worst[key], differences[key]) for key in worst}
            if options and differences is not None:
                for reason in why:
                    needed[reason].append(name)
            counts[kind] += 1
            counts["files"] += 1
            print(f"{name}: {kind} {', '.join(options)}", file=sys.stderr, flush=True)
        cells = [counts[kind] for kind in ("files", "agree", "options", "written", "apart", "not read")]
        cells += [f"{worst[key]:.0e}" for key in "Mha"]
        print(f"| {package} | " + " | ".join(str(cell) for cell in cells) + " |", flush=True)
    for title, found in (("left out by an option", needed), ("not read", left)):
        print(f"\n{title}:")
        for reason, names in sorted(found.items(), key=lambda item: -len(item[1])):
            print(f"  {len(names):3} × {reason}: {names[0]}" + (" …" if len(names) > 1 else ""))
    print(f"\nfurther apart than {TOLERANCE:.0e}, and with its principal axes:")
    for name, *both in apart:
        texts = (", ".join(f"{key} {value:.1e}" for key, value in differences.items()) for differences in both)
        print(f"  {name}: " + "; ".join(texts))


if __name__ == "__main__":
    main()
