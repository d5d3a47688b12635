"""Compares linkwork-design with python-control and slycot on 200 random systems: differences and times.

    linear_systems.py PROGRAM     PROGRAM is the example `peer` of linkwork-design.
"""
import subprocess
import sys
import time
import warnings

import control
import numpy as np
from scipy import linalg

warnings.filterwarnings("ignore")
rng = np.random.default_rng(20)
KINDS = ["random", "stiff", "lightly damped", "defective", "units apart"]


def system(k):
    kind = KINDS[k % 5]
    n, m, p = int(rng.integers(2, 11)), int(rng.integers(1, 4)), int(rng.integers(1, 4))
    if kind in ("random", "units apart"):
        a = rng.standard_normal((n, n))
        a -= np.eye(n) * (max(linalg.eigvals(a).real) + rng.uniform(0.1, 1))
    elif kind == "stiff":
        q, _ = linalg.qr(rng.standard_normal((n, n)))
        a = q @ (np.diag(-(10.0 ** rng.uniform(-3, 3, n))) + np.triu(rng.standard_normal((n, n)), 1)) @ q.T
    elif kind == "lightly damped":
        h = n // 2 + 1
        n = 2 * h
        w, z = 10.0 ** rng.uniform(-1, 1, h), 10.0 ** rng.uniform(-3, -1, h)
        a = np.block([[np.zeros((h, h)), np.eye(h)], [-np.diag(w**2), -np.diag(2 * z * w)]])
    else:
        q, _ = linalg.qr(rng.standard_normal((n, n)))
        a = q @ (-rng.uniform(0.5, 2) * np.eye(n) + np.diag(np.ones(n - 1), 1)) @ q.T
    b, c = rng.standard_normal((n, m)), rng.standard_normal((p, n))
    d = np.zeros((p, m)) if k % 2 else rng.standard_normal((p, m))
    if kind == "units apart":
        s = 10.0 ** rng.uniform(-3, 3, n)
        a, b, c = a * s[:, None] / s[None, :], b * s[:, None], c / s[None, :]
    return kind, a, b, c, d


def pairs(x):
    x = np.sort_complex(np.asarray(x, complex))
    return np.column_stack([x.real, x.imag]).ravel()


def response(s):
    m = s.frequency_response([0.01, 0.1, 1.0, 10.0, 100.0], squeeze=False).complex
    m = np.moveaxis(np.asarray(m), 2, 0).ravel()
    return np.column_stack([m.real, m.imag]).ravel()


def margins(s):
    gm, pm, sm, *_ = control.stability_margins(s[0, 0], returnall=True)
    up = [g for g in gm if g > 1]
    return [min(up, default=np.inf), min(map(abs, pm), default=np.inf), min(sm, default=np.nan)]


PEERS = {
    "poles": lambda s, z: pairs(s.poles()),
    "zeros": lambda s, z: pairs(s.zeros()),
    "lyap": lambda s, z: control.lyap(s.A, np.eye(s.nstates)).ravel(),
    "care": lambda s, z: control.care(s.A, s.B, np.eye(s.nstates), np.eye(s.ninputs))[0].ravel(),
    "dare": lambda s, z: control.dare((h := s.sample(0.1)).A, h.B, np.eye(s.nstates), np.eye(s.ninputs))[0].ravel(),
    "gram": lambda s, z: control.gram(s, "c").ravel(),
    "h2": lambda s, z: [control.system_norm(control.ss(s.A, s.B, s.C, 0 * s.D), 2, print_warning=False)],
    "hinf": lambda s, z: [control.system_norm(s, "inf", tol=1e-9, print_warning=False)],
    "zoh": lambda s, z: np.concatenate([(h := s.sample(0.1)).A.ravel(), h.B.ravel()]),
    "response": lambda s, z: response(s),
    "margins": lambda s, z: margins(s),
}


def beside(residual, *sizes):
    return linalg.norm(residual) / sum(map(linalg.norm, sizes))


def square(s, x):
    return np.reshape(x, (s.nstates, s.nstates))


def lyapunov_residual(s, x, q):
    x = square(s, x)
    ax = s.A @ x
    return beside(ax + ax.T + q, linalg.norm(s.A) * x, q)


def care_residual(s, x):
    x = square(s, x)
    ax, xb = s.A.T @ x, x @ s.B
    return beside(ax + ax.T - xb @ xb.T + np.eye(s.nstates), linalg.norm(s.A) * x, xb @ xb.T)


def dare_residual(s, x):
    h, x = s.sample(0.1), square(s, x)
    ax, bx = h.A.T @ x @ h.A, h.B.T @ x @ h.A
    gain = linalg.solve(h.B.T @ x @ h.B + np.eye(s.ninputs), bx)
    return beside(ax - x - bx.T @ gain + np.eye(s.nstates), ax, x, bx.T @ gain)


def pole_residual(s, x):
    roots = np.reshape(x, (-1, 2)) @ [1, 1j]
    least = [linalg.svdvals(s.A - root * np.eye(s.nstates))[-1] for root in roots]
    return max(least) / linalg.norm(s.A)


# Backward error: relative residual of a result in its equation.
RESIDUALS = {
    "poles": pole_residual,
    "lyap": lambda s, x: lyapunov_residual(s, x, np.eye(s.nstates)),
    "care": care_residual,
    "dare": dare_residual,
    "gram": lambda s, x: lyapunov_residual(s, x, s.B @ s.B.T),
}


def matched(found, expected):
    """Orders the roots as the expected ones; returns their difference relative to the largest."""
    x, y = found[::2] + 1j * found[1::2], list(expected[::2] + 1j * expected[1::2])
    order = []
    for root in x:
        order.append(y.pop(int(np.argmin([abs(root - other) for other in y]))))
    return max(abs(x - np.array(order)) / (1e-3 * max(abs(x)) + abs(x)), default=0.0)


def difference(name, found, expected):
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    if found.shape != expected.shape:
        return np.inf
    if name in ("poles", "zeros") and len(found):
        return matched(found, expected)
    same = (found == expected) | (np.isnan(found) & np.isnan(expected))
    if name == "margins":
        return float(max(np.where(same, 0, abs(found - expected) / abs(expected))))
    size = linalg.norm(expected)
    return 0.0 if size == 0 else float(linalg.norm(found - expected) / size)


def main():
    systems = [system(k) for k in range(200)]
    text = []
    for _, a, b, c, d in systems:
        numbers = [a.shape[0], b.shape[1], c.shape[0], *a.ravel(), *b.ravel(), *c.ravel(), *d.ravel()]
        text.append(" ".join(repr(float(x)) if i > 2 else str(x) for i, x in enumerate(numbers)))
    out = subprocess.run([sys.argv[1]], input="\n".join(text), capture_output=True, text=True, check=True).stdout
    lines = out.splitlines()
    ours = {words[1]: float(words[2]) for words in map(str.split, lines) if words[0] == "time"}
    lines = [line.split() for line in lines if not line.startswith("time")]
    print(f"python-control {control.__version__}, slycot {__import__('slycot').__version__}, {len(systems)} systems")
    print("differences beside the size of the result; time of one system")
    print(f"{'':10} {'median':>9} {'largest':>9}  of kind         refused  theirs refused   µs  times slower there  residual  theirs")
    for name, peer in PEERS.items():
        worst, all_, refused, theirs, spent, residuals = (0.0, ""), [], 0, 0, 0.0, [0.0, 0.0]
        mine = [line for line in lines if line[0] == name]
        for (kind, a, b, c, d), line in zip(systems, mine):
            s = control.ss(a, b, c, d)
            start = time.perf_counter()
            try:
                expected = peer(s, None)
            except Exception:
                expected = None
            spent += time.perf_counter() - start
            if len(line) > 1 and line[1] == "error":
                refused += 1
                continue
            if expected is None:
                theirs += 1
                continue
            if name in RESIDUALS:
                both = [RESIDUALS[name](s, [float(x) for x in line[1:]]), RESIDUALS[name](s, expected)]
                residuals = [max(pair) for pair in zip(residuals, both)]
            off = difference(name, [float(x) for x in line[1:]], expected)
            all_.append(off)
            worst = max(worst, (off, kind))
        micro = 1e6 * ours[name] / len(systems)
        shown = " ".join(f"{x:9.1e}" for x in residuals) if name in RESIDUALS else ""
        print(
            f"{name:10} {np.median(all_):9.1e} {worst[0]:9.1e}  {worst[1]:15} {refused:7} {theirs:15} {micro:6.1f} "
            f"{spent / ours[name]:8.1f}           {shown}"
        )


main()
