// Controls of a page that simulates a mechanism: plots, sliders, and the point that the pointer pulls.
"use strict";
const linkworkControls = (() => {

const MOST_CURVES = 12;
const make = (name, attributes = {}, ...children) => {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
};

// ---- Samples

// Adds plots of the coordinates, velocities, states, energies and outputs, one for each unit.
function addPlots(motion) {
  const { configuration, velocities, stateNames, outputs, functions } = motion.simulated, groups = new Map();
  const add = (title, unit, name, value) => {
    const key = title + unit;
    if (!groups.has(key)) groups.set(key, { title, unit: unitOf(unit), curves: [] });
    groups.get(key).curves.push({ name, values: [NaN], value });
  };
  configuration.forEach(([name, unit], k) => add("Coordinates", unit, name, sim => sim.q[k]));
  velocities.forEach(([name, unit], k) => add("Velocities", unit, name, sim => sim.v[k]));
  stateNames.forEach((name, k) => add("States", "", name, sim => sim.x[k]));
  ["kinetic", "potential", "total"].forEach((name, k) => add("Energies", "J", name, sim => (k ? sim.lastEnergies : sim.lastEnergies = sim.energies())[k]));
  for (const [name, unit] of outputs) {
    const length = functions[name]?.length ?? 0, axes = length === 3 ? [" x", " y", " z"] : null;
    for (let k = 0; k < Math.min(length, MOST_CURVES); k++) add("Outputs", unit, name + (axes ? axes[k] : length > 1 ? " " + (k + 1) : ""), sim => sim.output(name)?.[k] ?? NaN);
  }
  motion.plots = [...groups.values()].filter(plot => plot.curves.length <= MOST_CURVES);
  motion.inputs = motion.simulated.inputs.map(() => [0]);
}

// Returns the quaternion x y z w of a rotation matrix by rows.
function quaternionOf(m, k) {
  const trace = m[k] + m[k + 4] + m[k + 8];
  if (trace > 0) { const s = 2 * Math.sqrt(1 + trace); return [(m[k + 7] - m[k + 5]) / s, (m[k + 2] - m[k + 6]) / s, (m[k + 3] - m[k + 1]) / s, s / 4]; }
  const i = m[k] > m[k + 4] ? (m[k] > m[k + 8] ? 0 : 2) : m[k + 4] > m[k + 8] ? 1 : 2, j = (i + 1) % 3, l = (i + 2) % 3, at = (r, c) => m[k + 3 * r + c];
  const s = 2 * Math.sqrt(1 + at(i, i) - at(j, j) - at(l, l)), q = [];
  [q[i], q[j], q[l], q[3]] = [s / 4, (at(j, i) + at(i, j)) / s, (at(l, i) + at(i, l)) / s, (at(l, j) - at(j, l)) / s];
  return q;
}
// Returns the values of a sample in the order of the motion's lists.
function sampleOf(motion, sim) {
  const placements = sim.placements().slice(), values = [];
  for (const frame of motion.used) values.push(...placements.slice(12 * frame + 9, 12 * frame + 12), ...quaternionOf(placements, 12 * frame));
  for (const plot of motion.plots) for (const curve of plot.curves) values.push(curve.value(sim));
  values.push(...sim.u);
  return values;
}
// Updates the drawing after a change of parameters.
function redraw(motion, sim) {
  const numbers = sim.at("drawing");
  motion.pieces.forEach((piece, k) => {
    const source = motion.sources[k];
    if (source) for (let i = 0; i < source[1]; i++) if (Number.isFinite(numbers[source[0] + i])) piece[5][i] = numbers[source[0] + i];
  });
}

// ---- Sliders

const nice = x => { const p = 10 ** Math.floor(Math.log10(x)); return [1, 2, 5, 10].find(f => f * p >= x * 0.999) * p; };
const shown = x => Math.abs(x) < 1e-12 ? "0" : String(+x.toPrecision(5));
const unitOf = unit => unit === "1" || unit === "any" ? "" : unit;

// Returns a row with a slider and a field, and a function that sets both.
function row(name, unit, value, [low, high], changed) {
  const range = make("input", { type: "range", min: low, max: high, step: "any", value, "aria-label": name });
  const field = make("input", { type: "number", step: "any", value: shown(value), "aria-label": name + ", number" });
  const show = value => {
    if (value < +range.min) range.min = value;
    if (value > +range.max) range.max = value;
    range.value = value;
    field.value = shown(value);
  };
  range.oninput = () => { field.value = shown(+range.value); changed(+range.value); };
  field.onchange = () => { const x = field.valueAsNumber; if (Number.isFinite(x)) { show(x); changed(x); } else show(+range.value); };
  return { show, node: make("label", { class: "row" }, make("span", { class: "name" }, name, make("small", {}, unitOf(unit) ? " " + unitOf(unit) : "")), range, field) };
}
function panel(title, rows, isOpen) {
  if (!rows.length) return [];
  const node = make("details", { class: "panel" }, make("summary", {}, title), make("div", { class: "rows" }, ...rows.map(({ node }) => node)));
  node.open = isOpen;
  return [node];
}
const around = x => x === 0 ? [-1, 1] : x > 0 ? [x / 5, 3 * x] : [3 * x, x / 5];

// Returns the range of an input that changes accelerations clearly.
function rangeOfInput(sim, k) {
  const old = sim.u[k], without = sim.accelerations(sim.t, sim.q, sim.v).slice();
  sim.u[k] = old + 1;
  const more = sim.accelerations(sim.t, sim.q, sim.v).reduce((most, a, i) => Math.max(most, Math.abs(a - without[i])), 0);
  sim.u[k] = old;
  const most = nice(Math.max(Number.isFinite(30 / more) ? Math.min(1e6, 30 / more) : 1, 2 * Math.abs(old)));
  return [-most, most];
}

// Returns panels with sliders of inputs, initial state and parameters, and a function that shows the start.
function panels(motion, sim, begin, act) {
  const data = motion.simulated, isPhone = matchMedia("(max-width: 40rem)").matches, tidy = list => list.length <= 12;
  const inputs = data.inputs.map(([name, unit], k) => row(name, unit, sim.u[k], rangeOfInput(sim, k), x => act(() => { sim.u[k] = x; })));
  const state = [], turns = new Set(data.charts.flatMap(([kind, i]) => kind === 0 ? [] : [0, 1, 2, 3].map(k => (kind === 2 ? i + 3 : i) + k)));
  const reset = (change, fixed) => act(() => { change(); sim.reset(begin, fixed); [begin.q, begin.v] = [[...sim.q], [...sim.v]]; shows.forEach(show => show()); }, true);
  const shows = [], names = new Set(data.configuration.map(([name]) => name));
  const add = (list, k, name, unit, range) => {
    const one = row((list === "v" && names.has(name) ? "rate of " : "") + name, unit, begin[list][k], range, x => reset(() => { begin[list][k] = x; }, list === "q" ? k : -1));
    shows.push(() => { if (document.activeElement?.closest(".row") !== one.node) one.show(begin[list][k]); });
    state.push(one);
  };
  const length = Math.max(1, nice(motion.size));
  data.configuration.forEach(([name, unit], k) => { if (!turns.has(k)) add("q", k, name, unit, unit === "rad" ? [-Math.PI, Math.PI] : [-length, length]); });
  data.velocities.forEach(([name, unit], k) => add("v", k, name, unit, unit === "rad/s" ? [-10, 10] : [-5 * length, 5 * length]));
  data.stateNames.forEach((name, k) => add("x", k, name, "", around(begin.x[k])));
  const states = new Set(data.states.map(([k]) => k)), parameters = data.parameters.flatMap(([name, unit], k) => states.has(k) ? [] : [row(name, unit, data.parameterValues[k], around(data.parameterValues[k]), x => act(() => { sim.setParameter(k, x); redraw(motion, sim); }))]);
  return {
    show: () => shows.forEach(show => show()),
    nodes: [
      ...panel("Parameters", parameters, tidy(parameters) && !isPhone),
      ...panel("Inputs", inputs, tidy(inputs)),
      ...panel("Initial state", state, tidy(state) && !isPhone),
    ],
  };
}

// ---- Picking

// Returns the distance along a ray at which it enters a form that a matrix places: a sphere, or the box
// around another form. Boxes are widened by a margin, m.
function entry(name, m, [low, high], eye, way, margin) {
  let from = 0, to = Infinity;
  const [start, along] = [[], []];
  for (let k = 0; k < 3; k++) {
    const axis = [m[4 * k], m[4 * k + 1], m[4 * k + 2]], square = axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2;
    if (!(square > 0)) return null;
    along[k] = (axis[0] * way[0] + axis[1] * way[1] + axis[2] * way[2]) / square;
    start[k] = (axis[0] * (eye[0] - m[12]) + axis[1] * (eye[1] - m[13]) + axis[2] * (eye[2] - m[14])) / square;
    const wide = margin / Math.sqrt(square);
    if (Math.abs(along[k]) < 1e-12) { if (start[k] < low[k] - wide || start[k] > high[k] + wide) return null; continue; }
    const [a, b] = [(low[k] - wide - start[k]) / along[k], (high[k] + wide - start[k]) / along[k]];
    from = Math.max(from, Math.min(a, b));
    to = Math.min(to, Math.max(a, b));
  }
  if (!(from <= to)) return null;
  if (name !== "sphere") return from;
  const product = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2], [a, b] = [product(along, along), product(start, along)];
  const root = b * b - a * (product(start, start) - 1);
  return root >= 0 ? (-b - Math.sqrt(root)) / a : null;
}

return { addPlots, sampleOf, redraw, panels, entry };
})();
