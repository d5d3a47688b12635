"""Compares the printed equations of ten mechanisms with SymPy's: equality by numerical evaluation, and the number of names,
numbers, exponents and functions in each. SymPy's form is the shortest of some hundred in which every second derivative occurs
once, with its inertia as a factor; the last column is the shortest of all forms.

equations.py LINKWORK: the command `linkwork` prints the equations."""

import json
import re
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

import sympy as sp
from sympy import cos, sin

t = sp.Symbol("t")


@dataclass
class Mechanism:
    name: str
    gravity: str
    fields: str
    coordinates: str
    lagrangian: object  # a function of a mapping from names to parameters, coordinates and their rates
    forces: dict = field(default_factory=dict)


def velocity(*place):
    return sum(sp.diff(p, t) ** 2 for p in place)


def pendulum(s):
    return s.m * velocity(s.l * sin(s.theta), -s.l * cos(s.theta)) / 2 + s.m * s.g * s.l * cos(s.theta)


def cart_pole(s):
    x, y = s.rail - s.l / 2 * sin(s.hinge), s.l / 2 * cos(s.hinge)
    turning = s.m * s.l**2 / 24 * sp.diff(s.hinge, t) ** 2
    return s.cart * velocity(s.rail) / 2 + s.m * velocity(x, y) / 2 + turning - s.m * s.g * y


def double_pendulum(s):
    a, b = s.theta1, s.theta1 + s.theta2
    one = (s.l1 * sin(a), -s.l1 * cos(a))
    two = (one[0] + s.l2 * sin(b), one[1] - s.l2 * cos(b))
    return (s.m1 * velocity(*one) + s.m2 * velocity(*two)) / 2 - s.g * (s.m1 * one[1] + s.m2 * two[1])


def bead(s):
    turned, out = s.omega * t, s.r * sin(s.theta)
    place = (out * cos(turned), out * sin(turned), -s.r * cos(s.theta))
    return s.m * velocity(*place) / 2 - s.m * s.g * place[2]


def elastic_pendulum(s):
    x, y = s.r * sin(s.theta), -s.r * cos(s.theta)
    return s.m * velocity(x, y) / 2 - s.m * s.g * y - s.k * (s.r - s.free) ** 2 / 2


def spherical_pendulum(s):
    out = s.l * sin(s.theta)
    place = (out * cos(s.phi), out * sin(s.phi), -s.l * cos(s.theta))
    return s.m * velocity(*place) / 2 - s.m * s.g * place[2]


def train(s):
    stretch = (s.x2 - s.x1) ** 2 + (s.x3 - s.x2) ** 2
    return s.m * velocity(s.x1, s.x2, s.x3) / 2 - s.k * stretch / 2


def turntable(s):
    x, y = s.slide * cos(s.turn), s.slide * sin(s.turn)
    spring = s.k * (s.slide - s.free) ** 2 / 2
    return s.j * velocity(s.turn) / 2 + s.m * velocity(x, y) / 2 - s.m * s.g * y - spring


def top(s):
    psi, theta, phi = (sp.diff(e, t) for e in (s.psi, s.theta, s.phi))
    across = (psi * sin(s.theta)) ** 2 + theta**2
    energy = s.a * across / 2 + s.c * (phi + psi * cos(s.theta)) ** 2 / 2
    return energy - s.m * s.g * s.h * cos(s.theta)


def arm(s):
    a, b = s.shoulder, s.shoulder + s.elbow
    one = (s.l1 / 2 * sin(a), -s.l1 / 2 * cos(a))
    two = (s.l1 * sin(a) + s.l2 / 2 * sin(b), -s.l1 * cos(a) - s.l2 / 2 * cos(b))
    moving = s.m1 * velocity(*one) + s.m2 * velocity(*two)
    turning = (s.m1 * s.l1**2 * velocity(a) + s.m2 * s.l2**2 * velocity(b)) / 12
    return (moving + turning) / 2 - s.g * (s.m1 * one[1] + s.m2 * two[1])


MECHANISMS = [
    Mechanism(
        "Pendulum",
        "-g * y",
        "g: f64, m: f64, l: f64, #[body(mass = m, com = -l * y)] bob: Body, #[joint(ground -> bob, about = z)] theta: Pin",
        "theta",
        pendulum,
    ),
    Mechanism(
        "CartPole",
        "-g * y",
        """g: f64, cart: f64, m: f64, l: f64, #[body(mass = cart)] carriage: Body,
        #[body(mass = m, com = l / 2 * y, inertia = rod(m, l, y))] pole: Body,
        #[joint(ground -> carriage, along = x)] rail: Sleeve, #[joint(carriage -> pole, about = z)] hinge: Pin,
        #[acts(on = rail)] push: Force""",
        "rail hinge",
        cart_pole,
        {"rail": "push"},
    ),
    Mechanism(
        "DoublePendulum",
        "-g * y",
        """g: f64, m1: f64, m2: f64, l1: f64, l2: f64, #[body(mass = m1, com = -l1 * y)] upper: Body,
        #[body(mass = m2, com = -l2 * y)] lower: Body, #[joint(ground -> upper, about = z)] theta1: Pin,
        #[joint(upper.at(-l1 * y) -> lower, about = z)] theta2: Pin""",
        "theta1 theta2",
        double_pendulum,
    ),
    Mechanism(
        "BeadOnHoop",
        "-g * z",
        """g: f64, m: f64, r: f64, omega: f64, theta: Coordinate, #[frame(ground, z(omega * t))] hoop: Frame,
        #[particle(mass = m, at = r * sin(theta) * hoop.x - r * cos(theta) * z)] bead: Particle""",
        "theta",
        bead,
    ),
    Mechanism(
        "ElasticPendulum",
        "-g * y",
        """g: f64, m: f64, k: f64, free: f64, r: Coordinate, theta: Coordinate,
        #[particle(mass = m, at = r * sin(theta) * x - r * cos(theta) * y)] bob: Particle,
        #[energy(k / 2 * (r - free) * (r - free))] spring: Potential""",
        "r theta",
        elastic_pendulum,
    ),
    Mechanism(
        "SphericalPendulum",
        "-g * z",
        """g: f64, m: f64, l: f64, theta: Coordinate, phi: Coordinate,
        #[particle(mass = m, at = l * sin(theta) * cos(phi) * x + l * sin(theta) * sin(phi) * y - l * cos(theta) * z)]
        bob: Particle""",
        "theta phi",
        spherical_pendulum,
    ),
    Mechanism(
        "Train",
        "-9.81 * y",
        """m: f64, k: f64, #[particle(mass = m)] a: Particle, #[particle(mass = m)] b: Particle,
        #[particle(mass = m)] c: Particle, #[joint(ground -> a, along = x)] x1: Sleeve,
        #[joint(ground -> b, along = x)] x2: Sleeve, #[joint(ground -> c, along = x)] x3: Sleeve,
        #[energy(k / 2 * (x2 - x1) * (x2 - x1))] first: Potential,
        #[energy(k / 2 * (x3 - x2) * (x3 - x2))] second: Potential""",
        "x1 x2 x3",
        train,
    ),
    Mechanism(
        "Turntable",
        "-g * y",
        """g: f64, m: f64, j: f64, k: f64, free: f64, #[body(mass = 0, inertia = diagonal(j, j, j))] table: Body,
        #[joint(ground -> table, about = z)] turn: Pin, #[particle(mass = m)] block: Particle,
        #[joint(table -> block, along = x)] slide: Sleeve, #[acts(on = slide, stiffness = k, free_length = free)] coil: Spring,
        #[acts(on = turn)] motor: Torque""",
        "turn slide",
        turntable,
        {"turn": "motor"},
    ),
    Mechanism(
        "Top",
        "-g * z",
        """g: f64, m: f64, h: f64, a: f64, c: f64, #[body(mass = 0, inertia = 0)] first: Body,
        #[body(mass = 0, inertia = 0)] second: Body, #[body(mass = 0, inertia = diagonal(a, a, c))] rotor: Body,
        #[joint(ground -> first, about = z)] psi: Pin, #[joint(first -> second, about = x)] theta: Pin,
        #[joint(second -> rotor, about = z)] phi: Pin, #[energy(m * g * h * cos(theta))] weight: Potential""",
        "psi theta phi",
        top,
    ),
    Mechanism(
        "Arm",
        "-g * y",
        """g: f64, m1: f64, m2: f64, l1: f64, l2: f64, #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
        #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] lower: Body,
        #[joint(ground -> upper, about = z)] shoulder: Pin, #[joint(upper.at(-l1 * y) -> lower, about = z)] elbow: Pin,
        #[acts(on = shoulder)] first: Torque, #[acts(on = elbow)] second: Torque""",
        "shoulder elbow",
        arm,
        {"shoulder": "first", "elbow": "second"},
    ),
]

POWERS = {"²": "**2", "³": "**3", "⁴": "**4"}
TOKEN = re.compile(r"\d+(?:\.\d+)?|[A-Za-z_][A-Za-z_0-9]*'*|[²³⁴]|[()+\-/]")


def printed(command, mechanism, folder):
    """Returns the equations of a mechanism as the command prints them, a line each."""
    path = Path(folder) / f"{mechanism.name}.rs"
    path.write_text(
        f"#[mechanism(gravity = {mechanism.gravity})]\npub struct {mechanism.name} {{ {mechanism.fields} }}\n"
    )
    shown = subprocess.run([command, "show", "--json", str(path)], capture_output=True, text=True)
    if shown.returncode:
        sys.exit(f"{mechanism.name}: {shown.stderr}")
    text = json.loads(shown.stdout)["mechanisms"][0]["equations"]
    lines = []
    for line in text.splitlines():
        if line.startswith(" ") and lines:
            lines[-1] += " " + line.strip()
        else:
            lines.append(line.strip())
    return [line for line in lines if "''" in line and " = " in line and not line.startswith(("L ", "L="))]


def spelled(text):
    """Returns the text as Python: `*` for products, `**` for powers, and names for rates."""
    text = re.sub(r"(sin|cos|tan)([²³⁴])(\([^()]*\))", r"\1\3\2", text)
    out, operand = "", False
    for token in TOKEN.findall(text):
        is_open, is_name = token == "(", re.match(r"[A-Za-z_\d]", token)
        if operand and (is_name or (is_open and not out.endswith(("sin", "cos", "tan")))):
            out += "*"
        out += POWERS.get(token, token.replace("'", "_d"))
        operand = bool(is_name) or token in POWERS or token == ")"
        if token in ("sin", "cos", "tan"):
            operand = False
    return out


def symbols_of(text):
    """Returns the number of names, numbers, exponents and functions; a fraction of two numbers counts as one."""
    return len(re.findall(r"[A-Za-z_]\w*|\d+(?:\.\d+)?(?:/\d+)?", text))


class Names:
    """Parameters and coordinates by name, created at the first access."""

    def __init__(self, coordinates):
        self.__dict__.update({name: sp.Function(name)(t) for name in coordinates})

    def __getattr__(self, name):
        self.__dict__[name] = sp.Symbol(name)
        return self.__dict__[name]


def derived(mechanism):
    """Returns the left sides of Lagrange's equations (zero on the right), in plain symbols."""
    names = mechanism.coordinates.split()
    s = Names(names)
    energy = mechanism.lagrangian(s)
    equations = []
    for name in names:
        q = getattr(s, name)
        rate = sp.diff(q, t)
        force = sp.Symbol(mechanism.forces[name]) if name in mechanism.forces else 0
        equation = sp.diff(sp.diff(energy, rate), t) - sp.diff(energy, q) - force
        for of, ending in [(2, "_d_d"), (1, "_d"), (0, "")]:
            for other in names:
                e = getattr(s, other)
                equation = equation.subs(sp.diff(e, t, of) if of else e, sp.Symbol(other + ending))
        equations.append(sp.trigsimp(sp.expand(equation)))
    return equations


def forms(e):
    """Returns the forms of an equation that SymPy's functions give."""
    first = []
    for e in (e, sp.expand(sp.expand_trig(e))):
        plain = sp.expand(e)
        first += [e, plain, sp.simplify(e), sp.factor(e), sp.trigsimp(e), sp.factor_terms(e), sp.expand_trig(plain)]
        first += [sp.trigsimp(plain), sp.simplify(plain), sp.factor_terms(plain)]
        names = sorted(e.free_symbols, key=str) + sorted(plain.atoms(sp.sin, sp.cos), key=str)
        first += [sp.collect(form, s) for form in (plain, sp.trigsimp(plain)) for s in names]
        for ending in ("_d", "_d_d"):
            rates = [s for s in e.free_symbols if str(s).endswith(ending)]
            first += [sp.collect(plain, rates), sp.collect(plain, rates, sp.factor)]
            first.append(sp.collect(plain, rates, sp.simplify))

    # Forms with sines of multiple angles are excluded.
    def is_plain(form):
        angles = [angle.args[0] for angle in form.atoms(sp.sin, sp.cos)]
        return all(abs(angle.as_coeff_Mul()[0]) == 1 for angle in angles)

    return [form for form in first + [sp.factor_terms(form) for form in first] if is_plain(form)]


def has_inertias(form):
    """Whether every second derivative occurs once."""
    rates = re.findall(r"[A-Za-z_0-9]+_d_d", form)
    return len(rates) == len(set(rates))


def is_same(ours, theirs):
    """Whether two expressions have the same values at some points."""
    names = sorted(ours.free_symbols | theirs.free_symbols, key=str)
    for k in range(4):
        at = {s: sp.Float(0.3 + 0.7 * ((17 * (i + 1) + 29 * k) % 23) / 23) for i, s in enumerate(names)}
        a, b = ours.evalf(30, subs=at), theirs.evalf(30, subs=at)
        if abs(a - b) > 1e-9 * (1 + abs(b)):
            return False
    return True


def main(command):
    total, worse = [0, 0, 0, 0], 0
    print("| mechanism | equation | the same | Linkwork | SymPy | any form |\n| --- | --- | --- | ---: | ---: | ---: |")
    pairs = []
    with tempfile.TemporaryDirectory() as folder:
        for mechanism in MECHANISMS:
            ours, theirs = printed(command, mechanism, folder), derived(mechanism)
            if len(ours) != len(theirs):
                sys.exit(f"{mechanism.name}: {len(ours)} equations instead of {len(theirs)}:\n" + "\n".join(ours))
            for name, line, e in zip(mechanism.coordinates.split(), ours, theirs):
                left, right = (spelled(side) for side in line.split(" = "))
                given = {s: sp.Symbol(s) for s in re.findall(r"[A-Za-z_]\w*", left + " " + right)}
                given = {s: e for s, e in given.items() if s not in ("sin", "cos", "tan")}
                same = is_same(sp.sympify(left, locals=given) - sp.sympify(right, locals=given), e)
                all_forms = sorted({str(form) for form in forms(e)}, key=symbols_of)
                shortest = next(form for form in all_forms if has_inertias(form))
                own, other = symbols_of(left + (" " + right if right != "0" else "")), symbols_of(shortest)
                least = symbols_of(all_forms[0])
                total = [a + b for a, b in zip(total, (own, other, least, 1))]
                worse += own > other or not same
                print(f"| {mechanism.name} | {name} | {'yes' if same else 'NO'} | {own} | {other} | {least} |")
                pairs.append((line, shortest))
    print(f"| all | {total[3]} | | {total[0]} | {total[1]} | {total[2]} |\n")
    for line, shortest in pairs:
        print(f"{line}\n    {shortest} = 0")
    sys.exit(worse > 0)


if __name__ == "__main__":
    main(sys.argv[1])
