// Simulation of a mechanism by its functions in WebAssembly. It needs no document: pages and tests use it.
"use strict";
const linkwork = (() => {

// ---- Functions

const LAYERS = [[0, -6.5e-3], [11000, 0], [20000, 1e-3], [32000, 2.8e-3], [47000, 0], [51000, -2.8e-3], [71000, -2e-3], [84852, 0]];
// Returns temperature, pressure and lapse rate of the standard atmosphere (ISO 2533) at a geopotential height.
function air(h) {
  let temperature = 288.15, pressure = 101325;
  const ratio = 9.80665 / 287.05287;
  for (let k = 0; k < LAYERS.length; k++) {
    const [base, lapse] = LAYERS[k], end = k + 1 < LAYERS.length ? LAYERS[k + 1][0] : Infinity;
    const depth = Math.min(h, end) - base, next = temperature + depth * lapse;
    pressure *= lapse === 0 ? Math.exp(-ratio * depth / temperature) : (next / temperature) ** (-ratio / lapse);
    temperature = next;
    if (h < end) return [temperature, pressure, lapse];
  }
  return [temperature, pressure, NaN];
}
const IMPORTS = {
  sin: Math.sin, cos: Math.cos, tan: Math.tan, asin: Math.asin, acos: Math.acos, atan: Math.atan,
  sinh: Math.sinh, cosh: Math.cosh, tanh: Math.tanh, exp: Math.exp, ln: Math.log, atan2: Math.atan2, pow: Math.pow,
  signum: x => x !== x ? NaN : x > 0 || Object.is(x, 0) ? 1 : -1,
  isa_temperature: h => air(h)[0], isa_pressure: h => air(h)[1], isa_lapse_rate: h => air(h)[2],
};

// ---- Tables

// Returns the cell of an axis that contains x, and the weights of the four points around it for a derivative
// of the given order. Smooth tables have Bessel's tangents: slopes of parabolas through three points.
function weightsAround(points, x, order, isSmooth, isExtrapolated) {
  const last = points.length - 1, low = points[0], high = points[last], inner = Math.min(Math.max(x, low), high);
  let cell = 0, end = last - 1;
  while (cell < end) {
    const middle = cell + (end - cell + 1 >> 1);
    if (inner >= points[middle]) cell = middle; else end = middle - 1;
  }
  const h = points[cell + 1] - points[cell], s = (inner - points[cell]) / h;
  let weights = order === 0 ? [0, 1 - s, s, 0] : order === 1 ? [0, -1 / h, 1 / h, 0] : [0, 0, 0, 0], slope = [0, -1 / h, 1 / h, 0];
  if (isSmooth) {
    const b = cell > 0 ? points[cell] - points[cell - 1] : 0, a = cell + 2 <= last ? points[cell + 2] - points[cell + 1] : 0;
    // Slopes at both ends of the cell, times its width.
    const first = b > 0 ? [-h * h / (b * (b + h)), (h - b) / b, b / (b + h), 0] : a > 0 ? [0, -(2 * h + a) / (h + a), (h + a) / a, -h * h / (a * (h + a))] : [0, -1, 1, 0];
    const second = a > 0 ? [0, -a / (h + a), (a - h) / a, h * h / (a * (h + a))] : b > 0 ? [h * h / (b * (b + h)), -(b + h) / b, (2 * h + b) / (h + b), 0] : [0, -1, 1, 0];
    // Hermite polynomials of the value at the end and of both slopes.
    const value = [3 * s * s - 2 * s * s * s, 6 * (s - s * s), 6 - 12 * s, -12];
    const m0 = [s * s * s - 2 * s * s + s, 3 * s * s - 4 * s + 1, 6 * s - 4, 6], m1 = [s * s * s - s * s, 3 * s * s - 2 * s, 6 * s - 2, 6];
    const sums = n => [0, 1, 2, 3].map(k => ((k === 1 ? (n === 0 ? 1 : 0) - value[n] : k === 2 ? value[n] : 0) + m0[n] * first[k] + m1[n] * second[k]) / h ** n);
    [weights, slope] = [sums(order), sums(1)];
  }
  const isWithin = x >= low && x <= high;
  if (order === 0) { if (isExtrapolated) weights = weights.map((w, k) => w + (x - inner) * slope[k]); }
  else if (order > 1 || !isExtrapolated) weights = weights.map(w => x !== x ? NaN : isWithin ? w : 0);
  return [cell, weights];
}
// Returns the function that looks up one of several tables. Each variable has two bits of `orders`.
const lookup = tables => (index, orders, ...variables) => {
  const [axes, values, isSmooth, isExtrapolated] = tables[index];
  let sums = [[0, 1]];
  axes.forEach((points, k) => {
    const [cell, weights] = weightsAround(points, variables[k], orders >> 2 * k & 3, isSmooth, isExtrapolated), next = [];
    for (const [at, factor] of sums) weights.forEach((w, i) => { const j = cell + i - 1; if (j >= 0 && j < points.length) next.push([at * points.length + j, factor * w]); });
    sums = next;
  });
  return sums.reduce((sum, [at, factor]) => sum + factor * values[at], 0);
};

// ---- Linear equations

// Solves a square system by elimination with complete pivoting. Columns of zero pivots have zero solutions,
// so that redundant consistent equations do no harm. `a` is stored by rows and overwritten, as are the
// right-hand sides `b`, each of which becomes its solution. Returns the rank.
function solve(n, a, b, tolerance = 1e-10) {
  const order = Array.from({ length: n }, (_, k) => k);
  let first = 0, rank = 0;
  for (; rank < n; rank++) {
    let most = 0, row = rank, column = rank;
    for (let i = rank; i < n; i++) for (let j = rank; j < n; j++) { const x = Math.abs(a[i * n + j]); if (x > most) { most = x; row = i; column = j; } }
    if (rank === 0) first = most;
    if (!(most > tolerance * first)) break;
    if (row !== rank) {
      for (let j = 0; j < n; j++) { const x = a[row * n + j]; a[row * n + j] = a[rank * n + j]; a[rank * n + j] = x; }
      for (const side of b) { const x = side[row]; side[row] = side[rank]; side[rank] = x; }
    }
    if (column !== rank) {
      for (let i = 0; i < n; i++) { const x = a[i * n + column]; a[i * n + column] = a[i * n + rank]; a[i * n + rank] = x; }
      [order[rank], order[column]] = [order[column], order[rank]];
    }
    const pivot = a[rank * n + rank];
    for (let i = rank + 1; i < n; i++) {
      const factor = a[i * n + rank] / pivot;
      if (factor === 0) continue;
      for (let j = rank + 1; j < n; j++) a[i * n + j] -= factor * a[rank * n + j];
      for (const side of b) side[i] -= factor * side[rank];
    }
  }
  for (const side of b) {
    const x = new Float64Array(n);
    for (let i = rank - 1; i >= 0; i--) {
      let sum = side[i];
      for (let j = i + 1; j < rank; j++) sum -= a[i * n + j] * x[order[j]];
      x[order[i]] = sum / a[i * n + i];
    }
    side.set(x);
  }
  return rank;
}

// ---- Quaternions, x y z w

const product = ([a, b, c, d], [x, y, z, w]) => [d * x + a * w + b * z - c * y, d * y + b * w + c * x - a * z, d * z + c * w + a * y - b * x, d * w - a * x - b * y - c * z];
function rotate(q, k, [x, y, z]) {
  const [a, b, c, d] = [q[k], q[k + 1], q[k + 2], q[k + 3]], tx = 2 * (b * z - c * y), ty = 2 * (c * x - a * z), tz = 2 * (a * y - b * x);
  return [x + d * tx + b * tz - c * ty, y + d * ty + c * tx - a * tz, z + d * tz + a * ty - b * tx];
}
function normalise(q, k) {
  const n = Math.hypot(q[k], q[k + 1], q[k + 2], q[k + 3]) || 1;
  for (let i = k; i < k + 4; i++) q[i] /= n;
}

// ---- Methods of integration

// Dormand and Prince, order five with an error estimate of order four.
const NODES = [0, 1 / 5, 3 / 10, 4 / 5, 8 / 9, 1, 1];
const STAGES = [
  [], [1 / 5], [3 / 40, 9 / 40], [44 / 45, -56 / 15, 32 / 9],
  [19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729],
  [9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656],
  [35 / 384, 0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84],
];
const ERRORS = [71 / 57600, 0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40];
// Returns the end of a step, and the error relative to the tolerance.
function explicitStep(f, t, y, h, tolerance) {
  const n = y.length, k = STAGES.map(() => new Float64Array(n)), end = new Float64Array(n);
  STAGES.forEach((row, stage) => {
    for (let i = 0; i < n; i++) { let sum = 0; for (let j = 0; j < stage; j++) sum += row[j] * k[j][i]; end[i] = y[i] + h * sum; }
    f(t + NODES[stage] * h, end, k[stage]);
  });
  let error = 0;
  for (let i = 0; i < n; i++) {
    let sum = 0;
    for (let j = 0; j < 7; j++) sum += ERRORS[j] * k[j][i];
    error = Math.max(error, Math.abs(h * sum) / (tolerance * (1 + Math.max(Math.abs(y[i]), Math.abs(end[i])))));
  }
  return [end, error, 5];
}
// The linearly implicit method of Shampine and Reichelt (The MATLAB ODE suite, 1997), order two, L-stable.
function implicitStep(f, t, y, h, tolerance) {
  const n = y.length, d = 1 / (2 + Math.SQRT2), e = 6 + Math.SQRT2;
  const rate = (t, y) => { const out = new Float64Array(n); f(t, y, out); return out; };
  const f0 = rate(t, y);
  if (!f0.every(Number.isFinite)) return [y, NaN, 3];
  const w = new Float64Array(n * n), there = y.slice();
  for (let j = 0; j < n; j++) {
    const step = 1e-7 * Math.max(1, Math.abs(y[j]));
    there[j] = y[j] + step;
    const f1 = rate(t, there);
    there[j] = y[j];
    for (let i = 0; i < n; i++) w[i * n + j] = (i === j ? 1 : 0) - h * d * (f1[i] - f0[i]) / step;
  }
  const nudge = Math.max(1e-7, 1e-3 * h), later = rate(t + nudge, y), drift = f0.map((x, i) => (later[i] - x) / nudge * h * d);
  const solved = side => { solve(n, w.slice(), [side], 1e-300); return side; };
  const k1 = solved(f0.map((x, i) => x + drift[i])), f1 = rate(t + h / 2, y.map((x, i) => x + h / 2 * k1[i]));
  const k2 = solved(f1.map((x, i) => x - k1[i])).map((x, i) => x + k1[i]), end = y.map((x, i) => x + h * k2[i]);
  const f2 = rate(t + h, end), k3 = solved(f2.map((x, i) => x - e * (k2[i] - f1[i]) - 2 * (k1[i] - f0[i]) + drift[i]));
  const size = i => tolerance * (1 + Math.max(Math.abs(y[i]), Math.abs(end[i])));
  return [end, end.reduce((most, _, i) => Math.max(most, Math.abs(h / 6 * (k1[i] - 2 * k2[i] + k3[i])) / size(i)), 0), 3];
}

// ---- The simulation

const STEP = 1e-3;          // Time step with contacts, s.
const SMALLEST = 1e-9;      // Smallest step, s.
const RELUCTANT = 3000;     // Explicit steps per second above which implicit steps are tried.
const TOUCH = 1e-6;         // Gap of closed contacts, m.
const SWEEPS = 80;          // Iterations over the contacts of a step.

class Simulation {
  // Returns a promise of the simulation of a mechanism; `data` is the JSON that the command writes.
  static async open(data) {
    const raw = atob(data.module), bytes = new Uint8Array(raw.length);
    for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
    const names = Object.entries(data.functions), sizes = new Map([["parameters", data.parameters.length]]);
    for (const [, { args }] of names) for (const [name, length] of args) sizes.set(name, Math.max(sizes.get(name) ?? 0, length));
    const total = [...sizes.values()].reduce((sum, n) => sum + n, 0) + names.reduce((sum, [, f]) => sum + f.length, 0);
    const memory = new WebAssembly.Memory({ initial: 1 + Math.ceil(8 * total / 65536) });
    const { instance } = await WebAssembly.instantiate(bytes, { m: { ...IMPORTS, lookup: lookup(data.tables), memory } });
    return new Simulation(data, instance.exports, memory, sizes);
  }

  constructor(data, code, memory, sizes) {
    this.data = data;
    this.nq = data.configuration.length;
    this.nv = data.velocities.length;
    this.nx = data.states.length;
    let at = 0;
    const room = length => { const view = new Float64Array(memory.buffer, at, length); at += 8 * length; return view; };
    this.inputs = Object.fromEntries([...sizes].map(([name, length]) => [name, room(length)]));
    this.functions = {};
    for (const [name, { args, length }] of Object.entries(data.functions)) {
      const out = room(length), pointers = ["parameters", ...args.map(([name]) => name)].map(name => this.inputs[name].byteOffset);
      this.functions[name] = () => { code[name](...pointers, out.byteOffset); return out; };
    }
    this.inputs.parameters.set(data.parameterValues);
    this.u = new Float64Array(data.u);
    this.pull = null;
    this.tolerance = 1e-8;
    this.reluctant = RELUCTANT;
    this.isImplicit = false;
    this.isBound = data.constraints + data.contacts.length > 0;
    this.reset(data);
  }

  // Begins again at a state, which is changed to satisfy the constraints; the coordinate with the index
  // `fixed` keeps its value if possible.
  reset({ q, v, x }, fixed = -1) {
    this.t = 0;
    this.q = new Float64Array(q);
    this.v = new Float64Array(v);
    this.x = new Float64Array(x);
    this.h = 1e-3;
    this.isImplicit = false;
    const chart = this.data.charts.find(([kind, i]) => kind === 0 && i === fixed);
    if (chart && this.data.holonomic && !this.has("rates_of_speeds")) {
      this.project(chart[2]);
      if (this.violation() < 1e-9) return;
      [this.q, this.v] = [new Float64Array(q), new Float64Array(v)];
    }
    this.project();
  }

  // Evaluates a function at a state.
  at(name, t = this.t, q = this.q, v = this.v) {
    const { inputs, data } = this;
    if (inputs.t) inputs.t[0] = t;
    inputs.q?.set(q);
    inputs.v?.set(v);
    inputs.u?.set(this.u);
    data.states.forEach(([k], i) => { inputs.parameters[k] = this.x[i]; });
    return this.functions[name]();
  }
  has(name) { return name in this.functions; }

  // Returns joint velocities of generalized velocities.
  rates(q, v) {
    if (!this.has("rates_of_speeds")) return v;
    this.inputs.q.set(q);
    this.inputs.v.set(v);
    return this.functions.rates_of_speeds();
  }

  // Writes the rate of the configuration.
  turn(q, v, out) {
    const w = this.rates(q, v);
    for (const [kind, i, j] of this.data.charts) {
      if (kind === 0) { out[i] = w[j]; continue; }
      if (kind === 2) { const p = rotate(q, i + 3, [w[j], w[j + 1], w[j + 2]]); for (let k = 0; k < 3; k++) out[i + k] = p[k]; }
      const [a, b] = kind === 2 ? [i + 3, j + 3] : [i, j], rate = product([q[a], q[a + 1], q[a + 2], q[a + 3]], [w[b], w[b + 1], w[b + 2], 0]);
      for (let k = 0; k < 4; k++) out[a + k] = rate[k] / 2;
    }
  }
  normalise(q) {
    for (const [kind, i] of this.data.charts) if (kind) normalise(q, kind === 2 ? i + 3 : i);
  }
  // Returns the configuration after a small motion.
  moved(q, v, h) {
    const rate = new Float64Array(this.nq), half = new Float64Array(this.nq);
    this.turn(q, v, rate);
    for (let k = 0; k < this.nq; k++) half[k] = q[k] + h / 2 * rate[k];
    this.normalise(half);
    this.turn(half, v, rate);
    for (let k = 0; k < this.nq; k++) half[k] = q[k] + h * rate[k];
    this.normalise(half);
    return half;
  }

  // Returns the mass matrix with the Jacobian of the constraints, scaled. The velocity with the index `fixed`
  // gets a large inertia.
  saddle(t, q, fixed) {
    const { nv, data } = this, m = this.at("mass_matrix", t, q).slice(), rows = data.constraints, n = nv + rows, all = new Float64Array(n * n);
    const jacobian = rows ? this.functions.constraint_jacobian() : null;
    if (fixed >= 0) m[fixed * nv + fixed] = 1e8 * (m[fixed * nv + fixed] || 1);
    const scale = new Float64Array(n).fill(1);
    for (let k = 0; k < nv; k++) { const x = m[k * nv + k]; if (x > 0) scale[k] = 1 / Math.sqrt(x); }
    for (let k = 0; k < rows; k++) {
      let size = 0;
      for (let j = 0; j < nv; j++) size = Math.max(size, Math.abs(jacobian[j * rows + k] * scale[j]));
      scale[nv + k] = size > 0 ? 1 / size : 1;
    }
    for (let i = 0; i < nv; i++) {
      for (let j = 0; j < nv; j++) all[i * n + j] = m[j * nv + i] * scale[i] * scale[j];
      for (let k = 0; k < rows; k++) all[i * n + nv + k] = all[(nv + k) * n + i] = jacobian[i * rows + k] * scale[i] * scale[nv + k];
    }
    return { n, all, scale };
  }
  // Solves `M a + Jᵀ λ = force`, `J a = side` for several right-hand sides.
  solved(t, q, sides, fixed = -1) {
    const { n, all, scale } = this.saddle(t, q, fixed);
    for (const side of sides) for (let k = 0; k < n; k++) side[k] *= scale[k];
    solve(n, all, sides);
    for (const side of sides) for (let k = 0; k < n; k++) side[k] *= scale[k];
    return sides;
  }

  // Returns the generalized forces of inputs and of the pulled point.
  forces(t, q, v) {
    const tau = new Float64Array(this.nv);
    if (this.has("generalized_forces") && this.u.length) tau.set(this.at("generalized_forces", t, q, v));
    if (this.pull) {
      const { jacobian, stiffness, damping, target } = this.pull, place = this.point(t, q);
      for (let i = 0; i < 3; i++) {
        let speed = 0;
        for (let k = 0; k < this.nv; k++) speed += jacobian[3 * k + i] * v[k];
        const f = stiffness * (target[i] - place[i]) - damping * speed;
        for (let k = 0; k < this.nv; k++) tau[k] += jacobian[3 * k + i] * f;
      }
    }
    return tau;
  }

  accelerations(t, q, v) {
    const { nv, data, inputs } = this, tau = this.forces(t, q, v);
    if (!this.isBound) {
      inputs.tau.set(tau);
      return this.at("forward_dynamics", t, q, v);
    }
    if (data.slipping.length) return this.slipping(t, q, v, tau);
    const bias = this.at("bias_forces", t, q, v), side = new Float64Array(nv + data.constraints);
    for (let k = 0; k < nv; k++) side[k] = tau[k] - bias[k];
    if (data.constraints) { const b = this.at("constraint_bias", t, q, v); for (let k = 0; k < data.constraints; k++) side[nv + k] = -b[k]; }
    return this.solved(t, q, [side])[0].subarray(0, nv);
  }
  // Returns accelerations with sliding friction: the signs of its normal forces are those that it finds.
  slipping(t, q, v, tau) {
    const { inputs, data, nv } = this, rows = data.slipping;
    inputs.tau.set(tau);
    inputs.sides.fill(1);
    for (let round = 0; round <= 2 * rows.length; round++) {
      const found = this.at("__constrained_dynamics", t, q, v);
      const wrong = rows.map((row, k) => found[nv + row] * inputs.sides[k] < 0);
      if (!wrong.includes(true)) return found.subarray(0, nv);
      wrong.forEach((is, k) => { if (is) inputs.sides[k] *= -1; });
    }
    return new Float64Array(nv).fill(NaN);
  }

  // Moves the state onto the constraints.
  project(fixed = -1) {
    const { data, nv } = this;
    this.normalise(this.q);
    if (!data.constraints) return;
    if (data.holonomic) {
      let before = Infinity;
      for (let round = 0; round < 25; round++) {
        const r = this.at("constraint_residuals").slice(), size = r.reduce((most, x) => Math.max(most, Math.abs(x)), 0);
        if (size < 1e-14 || size >= before && round > 8 || !Number.isFinite(size)) break;
        before = size;
        const side = new Float64Array(nv + data.constraints);
        for (let k = 0; k < data.holonomic; k++) side[nv + k] = -r[k];
        const [dq] = this.solved(this.t, this.q, [side], fixed);
        this.q = this.moved(this.q, dq.subarray(0, nv), 1);
      }
    }
    const rates = this.at("constraint_rates"), side = new Float64Array(nv + data.constraints);
    for (let k = 0; k < data.constraints; k++) side[nv + k] = -rates[k];
    const [dv] = this.solved(this.t, this.q, [side]);
    for (let k = 0; k < nv; k++) this.v[k] += dv[k];
  }
  // Largest violation of the constraints on configurations.
  violation() {
    return this.data.holonomic ? this.at("constraint_residuals").reduce((most, x) => Math.max(most, Math.abs(x)), 0) : 0;
  }

  // Writes the rates of configuration, velocities and states of first order.
  derivative(t, y, out) {
    const { nq, nv, nx } = this, q = y.subarray(0, nq), v = y.subarray(nq, nq + nv), x = this.x;
    this.x = y.subarray(nq + nv, nq + nv + nx);
    this.turn(q, v, out);
    out.set(this.accelerations(t, q, v), nq);
    this.data.states.forEach(([, rate], k) => { out[nq + nv + k] = this.at(rate, t, q, v)[0]; });
    this.x = x;
  }

  // Advances by a time, s. Returns the time that was left when `stop` returned true.
  advance(time, stop = () => false) {
    const end = this.t + time;
    let steps = 0, from = this.t;
    while (this.t < end - 1e-12) {
      if (this.pull) this.grip();
      if (this.data.contacts.length) this.contactStep(Math.min(STEP, end - this.t));
      else this.smoothStep(end);
      if (!this.isFinite()) throw new RangeError("the motion cannot be continued: it is singular there, or too fast");
      steps++;
      if (!this.isImplicit && steps > 40 && steps > this.reluctant * (this.t - from)) { this.isImplicit = true; this.h = Math.max(this.h, 1e-4); }
      if (stop()) break;
    }
    return Math.max(0, end - this.t);
  }
  isFinite() { return [...this.q, ...this.v, ...this.x].every(Number.isFinite); }

  // Takes a step with an error below the tolerance, at most to a time.
  smoothStep(end) {
    const { nq, nv } = this, y = Float64Array.from([...this.q, ...this.v, ...this.x]);
    const f = (t, y, out) => this.derivative(t, y, out);
    for (let trial = 0; trial < 60; trial++) {
      const h = Math.min(this.h, end - this.t);
      const [next, error, order] = (this.isImplicit ? implicitStep : explicitStep)(f, this.t, y, h, this.isImplicit ? Math.max(1e-5, this.tolerance) : this.tolerance);
      const factor = error > 0 ? 0.9 * error ** (-1 / order) : 5;
      if (error <= 1) {
        this.q = next.slice(0, nq);
        this.v = next.slice(nq, nq + nv);
        this.x = next.slice(nq + nv);
        this.t += h;
        if (h >= this.h) this.h = Math.min(h * Math.min(5, Math.max(0.2, factor)), 0.1);
        this.project();
        return;
      }
      this.h = h * (Number.isFinite(error) ? Math.min(0.8, Math.max(0.1, factor)) : 0.1);
      if (this.h < SMALLEST) {
        if (!this.isImplicit) { this.isImplicit = true; this.h = 1e-4; } else break;
      }
    }
    throw new RangeError("the motion cannot be continued: it is singular there, or too stiff");
  }

  // ---- Contacts

  // Takes a step of this length, or up to the first impact. The motion is first that without contact forces;
  // impulses at its end then satisfy Coulomb's law and Newton's law of restitution. They act throughout a
  // step without impacts, so that they displace by half of the changes of velocities.
  contactStep(h) {
    const { data, nq, nv } = this, own = data.contacts.map((_, k) => k).filter(k => data.contacts[k].pressedBy === k);
    const start = this.at("contact_gaps").slice(), before = this.at("contact_rates").slice();
    const y = Float64Array.from([...this.q, ...this.v, ...this.x]), f = (t, y, out) => this.derivative(t, y, out);
    const free = h => { const [end, error] = explicitStep(f, this.t, y, h, 1e-3), q = end.slice(0, nq); this.normalise(q); return { error, q, v: end.slice(nq, nq + nv), x: end.slice(nq + nv), gaps: this.at("contact_gaps", this.t + h, q).slice() }; };
    let end = free(h);
    while (!(end.error <= 1) && h > 1e-6) { h /= 4; end = free(h); }
    let hit = h;
    for (const k of own) if (start[k] > TOUCH && end.gaps[k] < 0) hit = Math.min(hit, h * start[k] / (start[k] - end.gaps[k]));
    if (hit < h) { hit = Math.max(hit, h / 50); end = free(hit); }
    [this.q, this.v, this.x, this.t] = [end.q, end.v, end.x, this.t + hit];
    const change = this.resolve(end.gaps, before, h);
    if (change && hit === h) this.q = this.moved(this.q, change, h / 2);
    this.separate();
    this.project();
  }
  // Returns the closed contacts at gaps, with rows of the Jacobian and their responses `M⁻¹ Gᵀ`.
  closed(isClosed) {
    const { nv, data } = this, list = [];
    const rates = this.at("contact_rates").length, g = this.functions.contact_jacobian().slice(), laws = this.functions.__contact_laws();
    const rows = [], sides = [];
    data.contacts.forEach(({ first, count, pressedBy }, k) => {
      if (!isClosed(pressedBy)) return;
      list.push({ k, pressedBy, first: rows.length, count, friction: laws[3 * k], restitution: laws[3 * k + 1] });
      for (let i = first; i < first + count; i++) {
        const side = new Float64Array(nv + data.constraints);
        for (let j = 0; j < nv; j++) side[j] = g[j * rates + i];
        rows.push(side.slice(0, nv));
        sides.push(side);
      }
    });
    if (rows.length) this.solved(this.t, this.q, sides);
    const dot = (row, column) => { let sum = 0; for (let j = 0; j < nv; j++) sum += row[j] * column[j]; return sum; };
    return { list, rows, sides, w: rows.map(row => sides.map(side => dot(row, side))) };
  }
  // Changes velocities by the impulses of contacts (projected Gauss–Seidel), and returns the change.
  resolve(gaps, before, h) {
    const { data } = this, { list, rows, sides, w } = this.closed(k => gaps[k] < TOUCH);
    if (!list.length) return null;
    const free = this.at("contact_rates"), rate = [];
    for (const { k, count } of list) for (let i = 0; i < count; i++) rate.push(free[data.contacts[k].first + i]);
    const impulses = new Float64Array(rows.length), normal = new Map(), start = rate.slice();
    const change = (row, by) => { impulses[row] += by; for (let i = 0; i < rows.length; i++) rate[i] += w[i][row] * by; };
    for (let sweep = 0; sweep < SWEEPS; sweep++) {
      let most = 0;
      for (const { k, pressedBy, first, count, friction, restitution } of list) {
        let from = first;
        if (pressedBy === k) {
          const goal = before[data.contacts[k].first] < -20 * h ? -restitution * start[first] : 0;
          const next = Math.max(0, impulses[first] + (goal - rate[first]) / (w[first][first] || Infinity)), by = next - impulses[first];
          if (by) { change(first, by); most = Math.max(most, Math.abs(by)); }
          normal.set(k, next);
          from++;
        }
        const end = first + count, limit = friction * (normal.get(pressedBy) ?? 0);
        if (from < end) {
          const trace = Math.max(...Array.from({ length: end - from }, (_, i) => w[from + i][from + i])) * (end - from > 1 ? 1.2 : 1);
          const wished = Array.from({ length: end - from }, (_, i) => impulses[from + i] - rate[from + i] / (trace || Infinity));
          const size = Math.hypot(...wished), part = size > limit ? limit / size : 1;
          wished.forEach((x, i) => { const by = x * part - impulses[from + i]; if (by) { change(from + i, by); most = Math.max(most, Math.abs(by)); } });
        }
      }
      if (most < 1e-12 * (1 + impulses.reduce((sum, x) => Math.max(sum, Math.abs(x)), 0))) break;
    }
    const velocities = new Float64Array(this.nv);
    impulses.forEach((impulse, row) => { for (let j = 0; j < this.nv; j++) velocities[j] += impulse * sides[row][j]; });
    for (let j = 0; j < this.nv; j++) this.v[j] += velocities[j];
    return velocities;
  }
  // Removes overlaps by displacements.
  separate() {
    const { data, nv } = this, gaps = this.at("contact_gaps").slice();
    if (!gaps.some((gap, k) => data.contacts[k].pressedBy === k && gap < -1e-9)) return;
    const { list, sides, w } = this.closed(k => gaps[k] < -1e-9), own = list.filter(({ k, pressedBy }) => k === pressedBy);
    const push = new Float64Array(own.length);
    for (let sweep = 0; sweep < 30; sweep++)
      own.forEach(({ k, first }, i) => {
        const moved = own.reduce((sum, other, j) => sum + w[first][other.first] * push[j], 0);
        push[i] = Math.max(0, push[i] + (-gaps[k] - moved) / (w[first][first] || Infinity));
      });
    const dq = new Float64Array(nv);
    own.forEach(({ first }, i) => { for (let j = 0; j < nv; j++) dq[j] += push[i] * sides[first][j]; });
    this.q = this.moved(this.q, dq, 1);
  }

  // ---- Pulling a point

  // Returns the placements of the frames: for each a rotation matrix by rows, then a position.
  placements(t = this.t, q = this.q) { return this.at("placements", t, q); }
  // Returns the position of the pulled point.
  point(t, q) {
    const { frame, local } = this.pull, p = this.placements(t, q), k = 12 * frame;
    return [0, 1, 2].map(i => p[k + 9 + i] + p[k + 3 * i] * local[0] + p[k + 3 * i + 1] * local[1] + p[k + 3 * i + 2] * local[2]);
  }
  // Begins to pull a point of a frame towards a position by a spring; `null` ends it.
  hold(frame, local, target) {
    if (frame === null) { this.pull = null; return; }
    this.pull = { frame, local, target, stiffness: 0, damping: 0, jacobian: new Float64Array(3 * this.nv) };
    this.grip();
    const { jacobian } = this.pull, a = this.accelerations(this.t, this.q, this.v).slice();
    let give = 0, count = 0;
    // Mean acceleration of the point for unit forces; the spring has a frequency of 14 rad/s with its
    // inverse, the effective mass.
    for (let i = 0; i < 3; i++) {
        const forces = this.forces;
      this.forces = (t, q, v) => { const tau = forces.call(this, t, q, v); for (let k = 0; k < this.nv; k++) tau[k] += jacobian[3 * k + i]; return tau; };
      const b = this.accelerations(this.t, this.q, this.v);
      delete this.forces;
      let sum = 0;
      for (let k = 0; k < this.nv; k++) sum += jacobian[3 * k + i] * (b[k] - a[k]);
      if (sum > 1e-12) { give += sum; count++; }
    }
    const mass = give > 0 ? count / give : 0;
    Object.assign(this.pull, { stiffness: 200 * mass, damping: 14 * mass });
  }
  // Computes the Jacobian of the pulled point by central differences.
  grip() {
    const h = 1e-6, unit = new Float64Array(this.nv);
    for (let k = 0; k < this.nv; k++) {
      unit[k] = 1;
      const a = this.point(this.t, this.moved(this.q, unit, -h)), b = this.point(this.t, this.moved(this.q, unit, h));
      unit[k] = 0;
      for (let i = 0; i < 3; i++) this.pull.jacobian[3 * k + i] = (b[i] - a[i]) / (2 * h);
    }
  }

  // ---- Results

  energies() {
    const value = name => this.has(name) ? this.at(name)[0] : NaN, [kinetic, potential] = [value("kinetic_energy"), value("potential_energy")];
    return [kinetic, potential, kinetic + potential];
  }
  // Returns the values of an output; an output that needs more than the state has none.
  output(name) {
    const f = this.data.functions[name], known = ["t", "q", "v", "a", "u"];
    if (!f || f.args.some(([name]) => !known.includes(name))) return null;
    if (f.args.some(([name]) => name === "a")) this.inputs.a.set(this.accelerations(this.t, this.q, this.v).slice());
    return this.at(name);
  }
  setParameter(k, value) {
    this.inputs.parameters[k] = value;
    this.h = Math.min(this.h, 1e-3);
    this.project();
  }
}

return { Simulation, solve };
})();
if (typeof module !== "undefined") module.exports = linkwork;
