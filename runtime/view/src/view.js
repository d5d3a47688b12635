// Player of motions: each `.linkwork-view` element contains a list of motions as JSON. Vectors are arrays;
// matrices are arrays of 16 numbers in column-major order.
"use strict";
(() => {

// ---- Vectors and matrices

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const times = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = a => Math.hypot(a[0], a[1], a[2]);
const unit = a => { const n = norm(a); return n > 0 ? times(a, 1 / n) : [0, 0, 1]; };
const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

function mul(a, b) {
  const m = new Array(16);
  for (let j = 0; j < 4; j++)
    for (let i = 0; i < 4; i++)
      m[4 * j + i] = a[i] * b[4 * j] + a[4 + i] * b[4 * j + 1] + a[8 + i] * b[4 * j + 2] + a[12 + i] * b[4 * j + 3];
  return m;
}
const columns = (x, y, z, p) => [...x, 0, ...y, 0, ...z, 0, ...p, 1];
const IDENTITY = columns([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, 0]);
const turned = (m, v) => [0, 1, 2].map(i => m[i] * v[0] + m[4 + i] * v[1] + m[8 + i] * v[2]);
const moved = (m, v) => add(turned(m, v), [m[12], m[13], m[14]]);
const scaled = (x, y, z) => columns([x, 0, 0], [0, y, 0], [0, 0, z], [0, 0, 0]);
// Returns two unit vectors normal to a third one.
function normals(z) {
  const x = unit(cross(Math.abs(z[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0], z));
  return [x, cross(z, x)];
}
// Returns the transform to a position, with its third axis along a direction.
function along(place, direction) {
  const z = unit(direction), [x, y] = normals(z);
  return columns(x, y, z, place);
}
const rowsAt = (place, r) => columns([r[0], r[3], r[6]], [r[1], r[4], r[7]], [r[2], r[5], r[8]], place);
// Returns the matrix that transforms normals: the cofactor matrix.
function cofactors(m) {
  const [x, y, z] = [0, 4, 8].map(k => [m[k], m[k + 1], m[k + 2]]);
  return [...cross(y, z), ...cross(z, x), ...cross(x, y)];
}
function fromQuaternion([x, y, z, w], p) {
  const n = 2 / (x * x + y * y + z * z + w * w || 1);
  return columns(
    [1 - n * (y * y + z * z), n * (x * y + w * z), n * (x * z - w * y)],
    [n * (x * y - w * z), 1 - n * (x * x + z * z), n * (y * z + w * x)],
    [n * (x * z + w * y), n * (y * z - w * x), 1 - n * (x * x + y * y)], p);
}

// ---- Data

function bytesOf(text) {
  const raw = atob(text), bytes = new Uint8Array(raw.length);
  for (let k = 0; k < raw.length; k++) bytes[k] = raw.charCodeAt(k);
  return bytes;
}
// Decodes channels: the first value, whether it changes, then the differences.
function reader(bytes, count) {
  let at = 0;
  const integer = () => {
    let n = 0, weight = 1, byte;
    do { byte = bytes[at++]; n += (byte & 127) * weight; weight *= 128; } while (byte & 128);
    return n % 2 ? -(n + 1) / 2 : n / 2;
  };
  return (step, from = 0) => {
    const list = new Float64Array(count);
    let n = integer();
    const changes = integer();
    for (let k = 0; k < count; k++) { if (k && changes) n += integer(); list[k] = from + n * step; }
    return list;
  };
}
function decode(motion) {
  const read = reader(bytesOf(motion.data), motion.count);
  motion.times = read(motion.tick);
  motion.tracks = motion.frames.map(() => [1, 2, 3].map(() => read(motion.quantum)).concat([1, 2, 3, 4].map(() => read(motion.turn))));
  const curve = ([name, low, step]) => ({ name, values: read(1).map(n => n < 0 ? NaN : low + n * step) });
  motion.plots = motion.plots.map(([title, unit, curves]) => ({ title, unit, curves: curves.map(curve) }));
  motion.inputs = motion.inputs.map(([, low, step]) => read(1).map(n => n < 0 ? 0 : low + n * step));
  const vector = (list, k) => list.map(axis => axis[k]);
  motion.arrows = motion.arrows.map(([kind, frame, point, axes]) => ({ kind, frame, point, axes: axes.map(([, low, step]) => read(1).map(n => n < 0 ? 0 : low + n * step)) }));
  for (const kind of ["Force", "Torque"]) {
    const like = motion.arrows.filter(arrow => arrow.kind === kind);
    const longest = like.reduce((most, arrow) => arrow.axes[0].reduce((most, _, k) => Math.max(most, norm(vector(arrow.axes, k))), most), 0);
    for (const arrow of like) arrow.scale = longest > 0 ? 1 / longest : 0;
  }
  motion.largest = Math.max(0, ...motion.inputs.map(list => list.reduce((most, u) => Math.max(most, Math.abs(u)), 0)));
  [motion.size, motion.centre, motion.radius, motion.up, motion.eye, motion.plane, motion.floor] = motion.scene;
  motion.duration = motion.times[motion.count - 1];
  if (motion.live) {
    const open = list => Array.from(list);
    motion.times = open(motion.times);
    motion.tracks = motion.tracks.map(track => track.map(open));
    for (const plot of motion.plots) for (const curve of plot.curves) curve.values = open(curve.values);
    motion.inputs = motion.inputs.map(open);
  }
}
// Appends a sample of a control loop: the time in eight bytes, then placements, plots and inputs in four
// bytes each. Samples older than KEPT seconds are removed, and a loop whose time restarts begins a new
// motion. Returns false if the number of values is that of another mechanism.
const KEPT = 20;
function receive(motion, data) {
  const count = 7 * motion.tracks.length + motion.plots.reduce((sum, plot) => sum + plot.curves.length, motion.inputs.length);
  if (data.byteLength !== 8 + 4 * count) return false;
  append(motion, new DataView(data).getFloat64(0, true), new Float32Array(data, 8));
  return true;
}
// Appends the values of a sample: placements, plots, inputs.
function append(motion, t, numbers) {
  const lists = [...motion.tracks.flat(), ...motion.plots.flatMap(plot => plot.curves.map(curve => curve.values)), ...motion.inputs], { times } = motion;
  lists.push(times);
  if (!motion.heard || t < motion.start + motion.duration) {
    for (const list of lists) list.length = 0;
    [motion.start, motion.largest, motion.heard] = [t, 0, true];
  }
  times.push(t - motion.start);
  numbers.forEach((x, k) => { lists[k].push(x); });
  const last = times.length - 1;
  // Of the two quaternions of a rotation, the one nearer to the previous quaternion is used.
  for (const turn of motion.tracks.map(track => track.slice(3)))
    if (last > 0 && turn.reduce((sum, list) => sum + list[last] * list[last - 1], 0) < 0) for (const list of turn) list[last] = -list[last];
  for (const list of motion.inputs) motion.largest = Math.max(motion.largest, Math.abs(list[last]));
  motion.duration = times[last];
  const old = times.findIndex(x => x >= motion.duration - KEPT);
  if (old > 60) for (const list of lists) list.splice(0, old);
}
// Returns the index of the sample before a time, and the fraction of the interval to the next sample.
function locate(times, t) {
  let low = 0, high = times.length - 1;
  if (t >= times[high]) return [high, 0];
  while (high - low > 1) { const middle = (low + high) >> 1; if (times[middle] <= t) low = middle; else high = middle; }
  const span = times[high] - times[low];
  return [low, span > 0 ? clamp((t - times[low]) / span, 0, 1) : 0];
}
const between = (list, k, part) => part ? list[k] + part * (list[k + 1] - list[k]) : list[k];
function poses(motion, t) {
  const [k, part] = locate(motion.times, t);
  return motion.tracks.map(track => {
    const n = track.map(list => between(list, k, part));
    return fromQuaternion(n.slice(3), n.slice(0, 3));
  });
}

// ---- Forms: corners with normals, three for each triangle

// Fractions of the number of segments of round shapes: shapes that are small on the screen need fewer.
const DETAILS = [0.3, 0.5, 1];
let detail = 1;
const some = (steps, least) => Math.max(least, Math.round(steps * detail));
// Level of detail: up to these radii in pixels, a circle of the coarser level deviates by a third of a pixel.
const level = (name, m, pixels) => {
  if (name === "mesh" || name === "box" || name === "square") return 2;
  const column = k => Math.hypot(m[k], m[k + 1], m[k + 2]), round = Math.max(column(0), column(4));
  const radius = pixels * (name === "sphere" ? Math.max(round, column(8)) : round);
  return radius < 9 ? 0 : radius < 25 ? 1 : 2;
};
function form() {
  const data = [];
  const corner = (p, n) => data.push(...p, ...n);
  const quad = (a, b, c, d) => { for (const [p, n] of [a, b, c, a, c, d]) corner(p, n); };
  return { data, corner, quad };
}
// Revolves a profile of points [radius, height, outward normal, upward normal] about z. Each pair of points
// is a strip.
function revolve(strips, most = 40) {
  const { data, quad } = form(), steps = some(most, 8);
  for (const [a, b] of strips)
    for (let k = 0; k < steps; k++) {
      const [s, t] = [k, k + 1].map(j => j % steps / steps * 2 * Math.PI);
      const point = ([r, z, out, up], angle) => [[r * Math.cos(angle), r * Math.sin(angle), z], [out * Math.cos(angle), out * Math.sin(angle), up]];
      quad(point(a, s), point(a, t), point(b, t), point(b, s));
    }
  return data;
}
const cap = (r, z, up, inner = 0) => up > 0 ? [[r, z, 0, 1], [inner, z, 0, 1]] : [[inner, z, 0, -1], [r, z, 0, -1]];
function arcs(radius, from, to, centre, out = 0, most = 14) {
  const steps = some(most, 4);
  const at = k => { const a = from + (to - from) * k / steps, [c, s] = [Math.cos(a), Math.sin(a)]; return [out + radius * c, centre + radius * s, c, s]; };
  return Array.from({ length: steps }, (_, k) => [at(k), at(k + 1)]);
}
const HALF = Math.PI / 2;
const shapes = {
  sphere: () => revolve(arcs(1, -HALF, HALF, 0, 0, 24)),
  cylinder: () => revolve([cap(1, -0.5, -1), [[1, -0.5, 1, 0], [1, 0.5, 1, 0]], cap(1, 0.5, 1)]),
  pipe: () => revolve([[[1, -0.5, 1, 0], [1, 0.5, 1, 0]]]),
  tube: inner => revolve([cap(1, -0.5, -1, inner), [[1, -0.5, 1, 0], [1, 0.5, 1, 0]], cap(1, 0.5, 1, inner), [[inner, 0.5, -1, 0], [inner, -0.5, -1, 0]]]),
  cone: () => revolve([cap(1, 0, -1), [[1, 0, 0.7, 0.7], [0, 1, 0.7, 0.7]]]),
  torus: tube => revolve(arcs(tube, -Math.PI, Math.PI, 0, 1, 20), 64),
  capsule: half => revolve([...arcs(1, -HALF, 0, -half), [[1, -half, 1, 0], [1, half, 1, 0]], ...arcs(1, 0, HALF, half)]),
  box: () => {
    const { data, quad } = form();
    for (let axis = 0; axis < 3; axis++)
      for (const side of [-1, 1]) {
        const point = (u, v) => { const p = []; p[axis] = side / 2; p[(axis + 1) % 3] = u / 2 * side; p[(axis + 2) % 3] = v / 2; const n = [0, 0, 0]; n[axis] = side; return [p, n]; };
        quad(point(-1, -1), point(1, -1), point(1, 1), point(-1, 1));
      }
    return data;
  },
  square: () => { const { data, quad } = form(), p = (x, y) => [[x, y, 0], [0, 0, 1]]; quad(p(-1, -1), p(1, -1), p(1, 1), p(-1, 1)); return data; },
  // A wire of this radius along a curve, flattened where it will be stretched.
  wire: (curve, radius, steps, flat = 1) => {
    const { data, quad } = form(), round = some(8, 4);
    const ring = k => {
      const at = curve(k / steps), z = unit(sub(curve((k + 0.01) / steps), curve((k - 0.01) / steps))), side = unit(cross(z, [0.1, 0.2, 1])), other = cross(z, side);
      return Array.from({ length: round + 1 }, (_, j) => { const a = j / round * 2 * Math.PI, n = add(times(side, Math.cos(a)), times(other, Math.sin(a))); const d = times(n, radius); return [add(at, [d[0], d[1], d[2] * flat]), n]; });
    };
    let before = ring(0);
    for (let k = 1; k <= steps; k++) {
      const now = ring(k);
      for (let j = 0; j < round; j++) quad(before[j], before[j + 1], now[j + 1], now[j]);
      before = now;
    }
    return data;
  },
};
const TURNS = 12;
const coil = () => shapes.wire(s => {
  const end = Math.min(1, s / 0.1, (1 - s) / 0.1), a = s * TURNS * 2 * Math.PI, r = clamp(end, 0, 1);
  return [r * Math.cos(a), r * Math.sin(a), s];
}, 0.16, 220, 0.07);
const spiral = () => shapes.wire(s => { const a = s * 3.5 * 2 * Math.PI, r = 0.2 + 0.8 * s; return [r * Math.cos(a), r * Math.sin(a), 0]; }, 0.05, 160);
const bow = () => shapes.wire(s => { const a = s * 1.5 * Math.PI; return [Math.cos(a), Math.sin(a), 0]; }, 0.06, some(60, 16));
function meshOf([low, step, places, indices]) {
  const p = new Uint16Array(bytesOf(places).buffer), list = new Uint32Array(bytesOf(indices).buffer);
  const { data, corner } = form();
  const point = k => [0, 1, 2].map(i => low[i] + step[i] * p[3 * k + i]);
  for (let k = 0; k < list.length; k += 3) {
    const [a, b, c] = [0, 1, 2].map(i => point(list[k + i])), n = unit(cross(sub(b, a), sub(c, a)));
    for (const q of [a, b, c]) corner(q, n);
  }
  return data;
}

// Merges equal corners and returns them with the indices of the triangles, so that each corner is transformed
// once.
function shared(data) {
  const known = new Map(), corners = [], order = [];
  for (let k = 0; k < data.length; k += 6) {
    const corner = data.slice(k, k + 6), key = corner.map(x => Math.round(1e5 * x)).join();
    if (!known.has(key)) { known.set(key, known.size); corners.push(...corner); }
    order.push(known.get(key));
  }
  return [corners, order];
}

// ---- Pieces: parts with a form, a colour, and a matrix

const PALETTE = [[0.25, 0.48, 0.79], [0.87, 0.50, 0.24], [0.33, 0.63, 0.45], [0.63, 0.43, 0.74], [0.80, 0.38, 0.43], [0.30, 0.63, 0.70], [0.71, 0.61, 0.28], [0.50, 0.52, 0.62]];
const TONES = { Link: [0.56, 0.6, 0.66], Joint: [0.27, 0.3, 0.35], Surface: [0.36, 0.55, 0.78], Element: [0.2, 0.62, 0.46], Input: [0.89, 0.32, 0.2], Arrow: [0.85, 0.6, 0.1] };

// Parts that are fixed in a frame: [form, arguments, matrix, alpha].
function fixed(kind, n, s) {
  const at = n.slice(0, 3), axis = n.slice(3, 6), round = (name, r, h, ...more) => [[name, more, mul(along(at, axis), scaled(r, r, h)), 1]];
  const boxed = (name, lengths) => [[name, [], mul(rowsAt(at, n.slice(3, 12)), scaled(...lengths)), 1]];
  const see = parts => parts.map(([name, more, m]) => [name, more, m, 0.32]);
  switch (kind) {
    case "Rod": return round("cylinder", Math.max(0.018 * n[6], 0.006 * s), n[6]);
    case "Ring": return round("torus", n[6], n[6], 0.05);
    case "Disk": return round("cylinder", n[6], 0.08 * n[6]);
    case "Cylinder": return round("cylinder", n[6], n[7]);
    case "Tube": return round("tube", n[7], n[8], n[7] > 0 ? Math.min(0.995, n[6] / n[7]) : 0);
    case "Cone": return [["cone", [], mul(along(sub(at, times(axis, n[7] / 4)), axis), scaled(n[6], n[6], n[7])), 1]];
    case "Capsule": return round("capsule", n[6], n[6], n[6] > 0 ? n[7] / 2 / n[6] : 0);
    case "Sphere": return [["sphere", [], mul(columns([1, 0, 0], [0, 1, 0], [0, 0, 1], at), scaled(n[3], n[3], n[3])), 1]];
    case "Bowl": return see([["sphere", [], mul(columns([1, 0, 0], [0, 1, 0], [0, 0, 1], at), scaled(n[3], n[3], n[3])), 1]]);
    case "Cuboid": { const least = 0.02 * Math.max(n[12], n[13], n[14]); return boxed("box", n.slice(12).map(x => Math.max(x, least))); }
    case "Ellipsoid": return boxed("sphere", n.slice(12));
    case "Torus": return n[6] > 0 ? round("torus", n[6], n[6], n[7] / n[6]) : [];
    case "Plane": return see([["square", [], mul(along(at, axis), scaled(2 * s, 2 * s, 1)), 1]]);
    case "Pipe": return see(round("pipe", n[6], 4 * s));
    case "Funnel": return see([["cone", [], mul(along(add(at, times(axis, s)), times(axis, -1)), scaled(s * Math.tan(n[6]), s * Math.tan(n[6]), s)), 1]]);
    case "Point": return [["sphere", [], mul(columns([1, 0, 0], [0, 1, 0], [0, 0, 1], at), scaled(0.028 * s, 0.028 * s, 0.028 * s)), 1]];
    case "Hinge": return round("cylinder", 0.02 * s, 0.085 * s);
    case "Slide": return [["box", [], mul(along(at, axis), scaled(0.045 * s, 0.045 * s, 0.13 * s)), 1]];
    case "Ball": return [["sphere", [], mul(columns([1, 0, 0], [0, 1, 0], [0, 0, 1], at), scaled(0.03 * s, 0.03 * s, 0.03 * s)), 1]];
    case "Spiral": return round("spiral", 0.07 * s, 0.07 * s);
    case "Brake": return round("tube", 0.05 * s, 0.04 * s, 0.7);
    case "Mesh": return boxed("mesh", n.slice(12));
    default: return null;
  }
}
// Parts between two points.
function spanning(kind, a, b, s) {
  const way = sub(b, a), length = norm(way), m = along(a, way), rod = (r, from, to) =>
    ["cylinder", [], mul(mul(m, columns([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, (from + to) / 2])), scaled(r, r, Math.max(to - from, 1e-9)))];
  if (kind === "Bar") return [rod(0.009 * s, 0, length)];
  if (kind === "Coil") return [["coil", [], mul(m, scaled(0.034 * s, 0.034 * s, length))]];
  return [rod(0.026 * s, 0.15 * length, 0.6 * length), rod(0.009 * s, 0, length)];
}
function arrow(kind, at, direction, size, s) {
  const length = 0.55 * s * Math.abs(size), way = times(unit(direction), Math.sign(size));
  if (length < 0.004 * s) return [];
  if (kind === "Torque") {
    const r = 0.1 * s * Math.sqrt(Math.abs(size)), m = along(at, way);
    const tip = mul(m, columns([0, 1, 0], [0, 0, 1], [1, 0, 0], [0, -r, 0]));
    return [["bow", [], mul(m, scaled(r, r, r))], ["cone", [], mul(tip, scaled(0.2 * r, 0.2 * r, 0.4 * r))]];
  }
  const head = Math.min(0.09 * s, 0.6 * length), m = along(at, way), lift = z => columns([1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 0, z]);
  return [
    ["cylinder", [], mul(mul(m, lift((length - head) / 2)), scaled(0.011 * s, 0.011 * s, length - head))],
    ["cone", [], mul(mul(m, lift(length - head)), scaled(0.032 * s, 0.032 * s, head))],
  ];
}

// Returns the function from poses of the frames to the parts of a piece: [form, arguments, matrix, colour,
// alpha].
function builder(motion, piece, colour, key) {
  const [kind, , , a, b, n, more] = piece, s = motion.size;
  const frame = (frames, k) => k < 0 ? IDENTITY : frames[k];
  const parts = fixed(kind, n, s);
  if (parts) {
    const extra = kind === "Mesh" ? [key] : null;
    return frames => parts.map(([name, list, m, alpha]) => [name, extra || list, mul(frame(frames, a), m), colour, alpha]);
  }
  if (["Bar", "Coil", "Damper"].includes(kind))
    return frames => spanning(kind, moved(frame(frames, a), n.slice(0, 3)), moved(frame(frames, b), n.slice(3)), s).map(([name, list, m]) => [name, list, m, colour, 1]);
  if (kind === "Force" || kind === "Torque")
    return (frames, k, part) => {
      const u = motion.inputs[more] && motion.largest > 0 ? between(motion.inputs[more], k, part) / motion.largest : 0;
      return arrow(kind, moved(frame(frames, a), n.slice(0, 3)), turned(frame(frames, b), n.slice(3)), u, s).map(([name, list, m]) => [name, list, m, colour, 1]);
    };
  return () => [];
}
// Returns the function to the parts of an arrow for a vector over time, in the ground's axes.
const pull = (motion, { kind, frame, point, axes, scale }) => (frames, k, part) => {
  const way = times(axes.map(axis => between(axis, k, part)), scale), at = frame < 0 ? point : moved(frames[frame], point);
  return arrow(kind, at, way, norm(way), motion.size).map(([name, list, m]) => [name, list, m, TONES.Arrow, 1]);
};
// Chooses the colours of the pieces by their roles; all pieces of one body have the same colour.
function paint(motion, index) {
  const bodies = [];
  const pieces = motion.pieces.map((piece, k) => {
    const [kind, role, name, frame] = piece;
    let colour = TONES[role];
    if (!colour) {
      const of = role === "Visual" ? frame : name;
      if (!bodies.includes(of)) bodies.push(of);
      colour = PALETTE[bodies.indexOf(of) % PALETTE.length];
    }
    // The floor replaces a horizontal plane of the ground.
    const isFloor = kind === "Plane" && frame < 0 && motion.floor !== null && dot(piece[5].slice(3), motion.up) > 1 - 1e-6;
    motion.level ||= isFloor;
    return isFloor ? () => [] : builder(motion, piece, colour, index + "." + k);
  });
  return pieces.concat(motion.arrows.map(arrow => pull(motion, arrow)));
}

// ---- Drawing by WebGL

const VERTEX = `#version 300 es
in vec3 place; in vec3 normal;
uniform mat4 model, view; uniform mat3 turn;
out vec3 at, n;
void main() { vec4 p = model * vec4(place, 1.0); at = p.xyz; n = turn * normal; gl_Position = view * p; }`;
const FRAGMENT = `#version 300 es
precision highp float;
in vec3 at, n;
uniform vec4 colour; uniform vec3 eye, sun, up; uniform int mode; uniform vec4 grid; uniform vec3 middle, right, front;
out vec4 result;
float lines(vec2 p) { vec2 w = fwidth(p) + 1e-6, d = abs(fract(p - 0.5) - 0.5) / w; return (1.0 - min(min(d.x, d.y), 1.0)) * clamp(0.4 / max(w.x, w.y), 0.0, 1.0); }
void main() {
  if (mode == 1) { result = colour; return; }
  if (mode == 2) {
    vec2 p = vec2(dot(at, right), dot(at, front)) / grid.x;
    float ink = max(0.45 * lines(p), lines(p / 5.0)), far = length(at - middle) / grid.y;
    float fade = 1.0 - smoothstep(0.45, 1.0, far);
    result = vec4(mix(colour.rgb, grid.zzz, ink * grid.w), fade * (0.35 + 0.65 * ink) );
    return;
  }
  vec3 m = normalize(n), look = normalize(eye - at);
  if (dot(m, look) < 0.0) m = -m;
  float sky = 0.5 + 0.5 * dot(m, up), direct = max(dot(m, sun), 0.0);
  float shine = pow(max(dot(m, normalize(sun + look)), 0.0), 40.0);
  result = vec4(colour.rgb * (0.34 + 0.3 * sky + 0.5 * direct) + 0.16 * shine, colour.a);
}`;

function painter(canvas) {
  const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
  if (!gl) return null;
  const compile = (type, text) => {
    const shader = gl.createShader(type);
    gl.shaderSource(shader, text);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw new Error(gl.getShaderInfoLog(shader));
    return shader;
  };
  let program, at, forms;
  const begin = () => {
    program = gl.createProgram();
    gl.attachShader(program, compile(gl.VERTEX_SHADER, VERTEX));
    gl.attachShader(program, compile(gl.FRAGMENT_SHADER, FRAGMENT));
    gl.bindAttribLocation(program, 0, "place");
    gl.bindAttribLocation(program, 1, "normal");
    gl.linkProgram(program);
    at = new Proxy({}, { get: (known, name) => known[name] ??= gl.getUniformLocation(program, name) });
    forms = new Map();
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.SCISSOR_TEST);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
  };
  begin();
  const make = (name, more, source, fine) => {
    const key = name + more.join() + "/" + fine;
    let found = forms.get(key);
    if (!found) {
      detail = DETAILS[fine];
      // Facets of meshes have their own normals, and share no corners.
      const [corners, order] = name === "mesh" ? [meshOf(source(more[0])), null] : shared({ coil, spiral, bow, ...shapes }[name](...more));
      found = { array: gl.createVertexArray(), count: order ? order.length : corners.length / 6, order };
      gl.bindVertexArray(found.array);
      gl.bindBuffer(gl.ARRAY_BUFFER, gl.createBuffer());
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(corners), gl.STATIC_DRAW);
      if (order) {
        gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
        gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, new Uint16Array(order), gl.STATIC_DRAW);
      }
      for (const k of [0, 1]) { gl.enableVertexAttribArray(k); gl.vertexAttribPointer(k, 3, gl.FLOAT, false, 24, 12 * k); }
      forms.set(key, found);
    }
    return found;
  };
  const clear = back => {
    gl.scissor(0, 0, canvas.width, canvas.height);
    gl.clearColor(...back, 1);
    gl.clear(gl.COLOR_BUFFER_BIT);
  };
  return { begin, clear, draw(parts, floor, camera, tones, box, source) {
    gl.viewport(...box);
    gl.scissor(...box);
    gl.clear(gl.DEPTH_BUFFER_BIT);
    gl.useProgram(program);
    gl.uniformMatrix4fv(at.view, false, camera.matrix);
    gl.uniform3fv(at.eye, camera.eye);
    gl.uniform3fv(at.sun, camera.sun);
    gl.uniform3fv(at.up, camera.up);
    const one = (name, more, matrix, colour, alpha) => {
      const found = make(name, more, source, level(name, matrix, camera.pixels * box[3]));
      gl.bindVertexArray(found.array);
      gl.uniformMatrix4fv(at.model, false, matrix);
      gl.uniformMatrix3fv(at.turn, false, cofactors(matrix));
      gl.uniform4f(at.colour, ...colour, alpha);
      if (found.order) gl.drawElements(gl.TRIANGLES, found.count, gl.UNSIGNED_SHORT, 0);
      else gl.drawArrays(gl.TRIANGLES, 0, found.count);
    };
    if (floor) {
      gl.uniform1i(at.mode, 2);
      gl.uniform4f(at.grid, floor.cell, floor.half, tones.grid, 1);
      gl.uniform3fv(at.middle, floor.place);
      gl.uniform3fv(at.right, camera.level[0]);
      gl.uniform3fv(at.front, camera.level[1]);
      gl.enable(gl.BLEND);
      gl.depthMask(false);
      one("square", [], mul(along(floor.place, camera.up), scaled(floor.half, floor.half, 1)), tones.floor, 1);
      gl.depthMask(true);
      gl.disable(gl.BLEND);
      // Shadows: all parts are projected onto the floor along the light; the first part that covers a pixel
      // darkens it.
      gl.uniform1i(at.mode, 1);
      gl.depthMask(false);
      for (const [name, more, matrix, , alpha] of parts) if (alpha === 1) one(name, more, mul(floor.press, matrix), tones.shadow, 1);
      gl.depthMask(true);
    }
    gl.uniform1i(at.mode, 0);
    for (const part of parts) if (part[4] === 1) one(...part);
    gl.enable(gl.BLEND);
    gl.depthMask(false);
    for (const part of parts) if (part[4] < 1) one(...part);
    gl.depthMask(true);
    gl.disable(gl.BLEND);
  } };
}

// ---- The element

const element = (name, attributes = {}, ...children) => {
  const node = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
};
const dark = matchMedia("(prefers-color-scheme: dark)");
const FLOOR_HALF = 3.2;

// Lower and upper corner of the box around a form.
function boxOf(name, more) {
  switch (name) {
    case "sphere": return [[-1, -1, -1], [1, 1, 1]];
    case "box": return [[-0.5, -0.5, -0.5], [0.5, 0.5, 0.5]];
    case "square": return [[-1, -1, 0], [1, 1, 0]];
    case "cone": case "coil": return [[-1, -1, 0], [1, 1, 1]];
    case "torus": return [[-1 - more[0], -1 - more[0], -more[0]], [1 + more[0], 1 + more[0], more[0]]];
    case "capsule": return [[-1, -1, -1 - more[0]], [1, 1, 1 + more[0]]];
    case "spiral": case "bow": return [[-1, -1, -0.1], [1, 1, 0.1]];
    default: return [[-1, -1, -0.5], [1, 1, 0.5]];
  }
}

function start(root) {
  // A document may contain this program several times.
  if (root.dataset.started) return;
  root.dataset.started = "true";
  const motions = JSON.parse(root.querySelector("script").textContent);
  motions.forEach(decode);
  if (!motions.length) return;
  const live = motions.find(motion => motion.live), simulated = live?.simulated;
  if (simulated) linkworkControls.addPlots(live);
  const isFree = simulated?.charts.some(([kind]) => kind === 2);
  if (isFree && !simulated.contacts.length && !live.pieces.some(([kind, , , frame]) => kind === "Plane" && frame < 0)) live.floor = null;
  let duration = Math.max(...motions.map(motion => motion.duration));
  const begin = () => live ? live.times[0] : 0;
  let painted = motions.map(paint);
  const canvas = element("canvas", { tabindex: "0", role: "img", "aria-label": "motion in three dimensions" });
  const stage = element("div", { class: "stage" }, canvas);
  const play = element("button", { class: "play", type: "button" });
  const slider = element("input", { type: "range", min: 0, max: duration, step: "any", value: 0, "aria-label": "time" });
  const clock = element("output");
  // Motions shorter than a second are played in slow motion at first.
  const speeds = [0.001, 0.01, 0.1, 0.25, 0.5, 1, 2, 4, 10], begun = live ? 1 : speeds.findLast(x => x <= 1 && duration >= x) ?? speeds[1];
  const speed = element("select", { "aria-label": "speed" }, ...speeds.map(x => element("option", x === begun ? { value: x, selected: "" } : { value: x }, x + " ×")));
  const toggle = (text, on) => { const b = element("button", { type: "button", "aria-pressed": on }, text); b.on = on; return b; };
  const frames = toggle("Frames", false), follow = toggle("Follow", motions.some(m => m.radius > 2.5 * m.size) || isFree);
  const button = (text, title) => element("button", { type: "button", title }, text);
  const reset = button("Fit", "whole mechanism (0)"), restart = button("Reset", "to the beginning (r)"), one = button("Step", "one hundredth of a second (.)");
  const sides = [["Front", 0, 0, "1"], ["Side", Math.PI / 2, 0, "2"], ["Top", 0, 1.55, "3"]].map(([text, yaw, pitch, key]) => {
    const node = button(text, text.toLowerCase() + " view (" + key + ")"), look = () => { view = fitted({ ...home(), yaw, pitch }); state.dirty = true; };
    node.onclick = look;
    return { node, key, look };
  });
  const group = (...nodes) => element("div", { class: "group" }, ...nodes);
  root.append(stage, element("div", { class: "bar" }, play, ...(simulated ? [one, restart] : []), slider, clock, ...(live && !simulated ? [] : [speed]), group(...sides.map(({ node }) => node), reset), group(frames, follow)));
  const labels = motions.map(motion => {
    const label = element("div", { class: "label" }, element("b", {}, motion.title), element("span"));
    stage.append(label);
    return label;
  });
  let pen = null;
  try { pen = painter(canvas); } catch (error) { console.warn(error); }
  if (!pen) { canvas.remove(); stage.append(element("div", { class: "failure" }, "This browser shows no WebGL 2, which the picture needs; the plots below work without it.")); }

  const state = { now: 0, playing: live || duration > 0 && !matchMedia("(prefers-reduced-motion: reduce)").matches, dirty: true };
  const plane = motions.every(motion => motion.plane);
  const home = () => ({ yaw: plane ? 0.25 : 0.7, pitch: plane ? 0.2 : 0.38, zoom: 1, shift: [0, 0] });
  // A view that is fitted to the mechanism is fitted again when the stage changes.
  const fitted = view => ({ ...view, isFitted: true, fittedTo: "" });
  let view = fitted(home());
  const plots = motions.flatMap((motion, k) => motion.plots.map(plot => ({ ...plot, motion, title: (motions.length > 1 && motion.title ? motion.title + ": " : "") + plot.title })));
  const figures = plots.map(plot => figure(plot, () => [begin(), duration > begin() ? duration : begin() + 1], t => { seek(t); }));
  if (figures.length) root.append(element("div", { class: "plots" }, ...figures.map(f => f.node)));

  function setPlaying(on) { state.playing = on && (live || duration > 0); if (state.playing && (live || state.now >= duration)) state.now = live ? duration : 0; play.textContent = state.playing ? "Pause" : "Play"; state.dirty = true; }
  function seek(t) { if (live) setPlaying(false); state.now = clamp(t, begin(), duration); state.dirty = true; }
  const press = button => { button.on = !button.on; button.setAttribute("aria-pressed", button.on); state.dirty = true; };
  play.onclick = () => setPlaying(!state.playing);
  slider.oninput = () => { setPlaying(false); seek(+slider.value); };
  frames.onclick = () => press(frames);
  follow.onclick = () => press(follow);
  reset.onclick = () => { view = fitted(home()); state.dirty = true; };
  setPlaying(state.playing);

  root.addEventListener("keydown", e => {
    if (e.target === speed || e.ctrlKey || e.metaKey || e.altKey || e.target.matches("input[type=number], summary")) return;
    const onSlider = e.target.type === "range", onButton = e.target.tagName === "BUTTON", step = Math.max(duration / 200, 1e-3), turn = (x, y) => { view.yaw += x; view.pitch = clamp(view.pitch + y, -1.55, 1.55); };
    const actions = {
      " ": () => { if (onButton) return true; setPlaying(!state.playing); },
      ArrowLeft: () => { if (onSlider) return true; e.shiftKey ? turn(-0.1, 0) : seek(state.now - step); },
      ArrowRight: () => { if (onSlider) return true; e.shiftKey ? turn(0.1, 0) : seek(state.now + step); },
      ArrowUp: () => { if (onSlider || !e.shiftKey) return true; turn(0, 0.1); },
      ArrowDown: () => { if (onSlider || !e.shiftKey) return true; turn(0, -0.1); },
      Home: () => seek(0), End: () => seek(duration),
      "+": () => zoom(1.15), "=": () => zoom(1.15), "-": () => zoom(1 / 1.15),
      f: () => press(frames), c: () => press(follow), 0: () => { view = fitted(home()); },
      r: () => { if (!simulated) return true; restart.onclick(); }, ".": () => { if (!simulated) return true; one.onclick(); },
      ...Object.fromEntries(sides.map(({ key, look }) => [key, look])),
    };
    const act = actions[e.key];
    if (act && act() !== true) { e.preventDefault(); state.dirty = true; }
  });

  const zoom = factor => { view.zoom = clamp(view.zoom * factor, 0.05, 50); view.isFitted = false; };
  // One finger or the left button rotates; two fingers move and zoom; the right button moves.
  const touches = new Map();
  canvas.addEventListener("pointerdown", e => {
    if (!touches.size && e.button === 0 && !e.shiftKey && simulation) { canvas.setPointerCapture(e.pointerId); if (simulation.grab(e)) return; }
    simulation?.release();
    canvas.setPointerCapture(e.pointerId); touches.set(e.pointerId, [e.clientX, e.clientY, e.button === 2 || e.shiftKey]);
  });
  canvas.addEventListener("pointermove", e => {
    const before = touches.get(e.pointerId);
    if (!before) { simulation?.drag(e); return; }
    const dx = e.clientX - before[0], dy = e.clientY - before[1], height = canvas.clientHeight || 1;
    view.isFitted = false;
    const others = [...touches].filter(([id]) => id !== e.pointerId).map(([, p]) => p);
    if (others.length) {
      const apart = p => Math.hypot(p[0] - others[0][0], p[1] - others[0][1]) || 1;
      view.zoom *= apart([e.clientX, e.clientY]) / apart(before);
      view.shift = [view.shift[0] + dx / 2 / height / view.zoom, view.shift[1] + dy / 2 / height / view.zoom];
    } else if (before[2]) view.shift = [view.shift[0] + dx / height / view.zoom, view.shift[1] + dy / height / view.zoom];
    else { view.yaw -= dx * 0.008; view.pitch = clamp(view.pitch + dy * 0.008, -1.55, 1.55); }
    view.zoom = clamp(view.zoom, 0.05, 50);
    touches.set(e.pointerId, [e.clientX, e.clientY, before[2]]);
    state.dirty = true;
  });
  for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, e => { touches.delete(e.pointerId); simulation?.release(e); });
  canvas.addEventListener("contextmenu", e => e.preventDefault());
  canvas.addEventListener("wheel", e => { e.preventDefault(); zoom(Math.exp(-0.0015 * e.deltaY)); state.dirty = true; }, { passive: false });
  canvas.addEventListener("webglcontextlost", e => e.preventDefault());
  canvas.addEventListener("webglcontextrestored", () => { pen.begin(); state.dirty = true; });
  dark.addEventListener("change", () => { state.dirty = true; });
  new ResizeObserver(() => { state.dirty = true; }).observe(root);
  let visible = true;
  new IntersectionObserver(seen => { visible = seen[seen.length - 1].isIntersecting; state.dirty = true; }).observe(root);

  // Arranges the views in cells that are as square as the stage allows.
  function cells(w, h) {
    const n = motions.length, shape = c => Math.min(w / c, h / Math.ceil(n / c));
    const c = Array.from({ length: n }, (_, k) => k + 1).reduce((best, c) => shape(c) > shape(best) ? c : best, 1), r = Math.ceil(n / c);
    return motions.map((_, k) => [k % c * w / c, Math.floor(k / c) * h / r, w / c, h / r]);
  }

  function cameraOf(motion, target, w, h) {
    const up = motion.up, front = motion.eye, right = cross(up, front);
    const side = add(times(front, Math.cos(view.yaw)), times(right, Math.sin(view.yaw)));
    const back = add(times(side, Math.cos(view.pitch)), times(up, Math.sin(view.pitch)));
    const x = unit(cross(up, side)), y = cross(back, x);
    const radius = follow.on ? 0.75 * motion.size : motion.radius, angle = 0.32, fit = Math.min(1, w / h);
    const away = 1.12 * radius / Math.sin(angle) / fit / view.zoom;
    const extent = 2 * away * Math.tan(angle) * view.zoom;
    const middle = add(target, add(times(x, -view.shift[0] * extent), times(y, view.shift[1] * extent)));
    const eye = add(middle, times(back, away)), near = Math.max(away - 4 * (motion.radius + motion.size), away / 500), far = away + 8 * (motion.radius + motion.size);
    const look = [x[0], y[0], back[0], 0, x[1], y[1], back[1], 0, x[2], y[2], back[2], 0, -dot(x, eye), -dot(y, eye), -dot(back, eye), 1];
    const f = 1 / Math.tan(angle);
    const lens = [f * h / w, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, 2 * far * near / (near - far), 0];
    const sun = unit(add(add(times(up, 1), times(front, 0.45)), times(right, 0.5)));
    // Fraction of the height that one metre at the centre occupies.
    const pixels = 1 / (2 * away * Math.tan(angle));
    return { matrix: mul(lens, look), eye, up, sun, level: [right, front], pixels, axes: [x, y, back], tangent: Math.tan(angle), aspect: w / h };
  }

  const targetOf = (motion, poses) => follow.on && poses.length ? times(poses.reduce((sum, m) => add(sum, [m[12], m[13], m[14]]), [0, 0, 0]), 1 / poses.length) : motion.centre;
  const partsAt = (index, t) => {
    const motion = motions[index], [k, part] = locate(motion.times, t), now = poses(motion, t);
    return { now, parts: painted[index].map(make => make(now, k, part)) };
  };
  // Chooses centre, zoom and shift so that the mechanism fills the stage: throughout its motion, or as it is now if
  // the view follows it or it is simulated. Motions next to each other share a view, which is centred.
  function fit(boxes) {
    if (!follow.on) motions.forEach(centre);
    for (let round = 0; round < 4; round++) {
      let [reach, shift] = [0, [0, 0]];
      motions.forEach((motion, index) => {
        const [, , w, h] = boxes[index], [low, high] = [[Infinity, Infinity], [-Infinity, -Infinity]];
        const note = ({ matrix }, p) => {
          const deep = matrix[3] * p[0] + matrix[7] * p[1] + matrix[11] * p[2] + matrix[15];
          if (deep > 0) for (const i of [0, 1]) { const x = (matrix[i] * p[0] + matrix[4 + i] * p[1] + matrix[8 + i] * p[2] + matrix[12 + i]) / deep; low[i] = Math.min(low[i], x); high[i] = Math.max(high[i], x); }
        };
        if (motion.extent && !follow.on) { const camera = cameraOf(motion, motion.centre, w, h); for (const p of cornersOf(motion.extent)) note(camera, p); }
        for (const t of instants(motion)) {
          const { now, parts } = partsAt(index, t), camera = cameraOf(motion, targetOf(motion, now), w, h);
          for (const p of corners(parts.flat())) note(camera, p);
        }
        if (!(low[0] <= high[0])) return;
        const middle = motions.length > 1 ? [0, 0] : [0, 1].map(i => (low[i] + high[i]) / 2);
        // The title takes a strip at the top.
        const room = [0.9, motions.length > 1 || motion.title ? 0.8 : 0.86];
        for (const i of [0, 1]) reach = Math.max(reach, Math.max(high[i] - middle[i], middle[i] - low[i]) / room[i]);
        shift = [-middle[0] * w / h / 2 / view.zoom, middle[1] / 2 / view.zoom];
      });
      if (!(reach > 0)) return;
      view.shift = [view.shift[0] + shift[0], view.shift[1] + shift[1]];
      view.zoom = clamp(view.zoom / reach, 0.05, 50);
    }
  }
  // Returns the instants whose pictures the view contains.
  const instants = motion => follow.on || motion.live ? [Math.min(state.now, motion.duration)] : Array.from({ length: 25 }, (_, k) => motion.duration * k / 24);
  // Puts the centre of rotations of the view in the middle of the motion.
  function centre(motion, index) {
    const [low, high] = motion.extent ? motion.extent.map(p => [...p]) : [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    for (const t of instants(motion)) for (const p of corners(partsAt(index, t).parts.flat())) p.forEach((x, k) => { low[k] = Math.min(low[k], x); high[k] = Math.max(high[k], x); });
    if (low[0] <= high[0]) motion.centre = times(add(low, high), 0.5);
  }
  const cornersOf = ([a, b]) => Array.from({ length: 8 }, (_, k) => [k & 1 ? a[0] : b[0], k & 2 ? a[1] : b[1], k & 4 ? a[2] : b[2]]);
  // Returns points whose hull contains the opaque parts.
  const corners = parts => parts.filter(part => part[4] === 1).flatMap(([name, more, m]) => outlineOf(name, boxAround(name, more)).map(p => moved(m, p)));
  // Returns points whose hull contains a form or nearly does: of round forms on circles, else the corners.
  function outlineOf(name, [low, high]) {
    if (name === "mesh" || name === "box" || name === "square") return cornersOf([low, high]);
    const rings = name === "sphere" ? [[-1, 0], [-0.7, 0.72], [0, 1.05], [0.7, 0.72], [1, 0]] : [[low[2], high[0]], [high[2], name === "cone" ? 0 : high[0]]];
    return rings.flatMap(([z, r]) => Array.from({ length: r ? 8 : 1 }, (_, k) => [r * Math.cos(k * HALF / 2), r * Math.sin(k * HALF / 2), z]));
  }
  function boxAround(name, more) {
    if (name !== "mesh") return boxOf(name, more);
    const [low, step] = mesh(more[0]);
    return [low, low.map((x, k) => x + 65535 * step[k])];
  }

  function triads(motion, poses) {
    const s = 0.11 * motion.size, tints = [[0.86, 0.2, 0.2], [0.2, 0.65, 0.25], [0.2, 0.4, 0.9]];
    return poses.flatMap(pose => [0, 1, 2].flatMap(k => {
      const d = [0, 0, 0];
      d[k] = 1;
      return [["cylinder", [], mul(along(moved(pose, times(d, s / 2)), turned(pose, d)), scaled(0.05 * s, 0.05 * s, s)), tints[k], 1]];
    }));
  }

  function trails(motion, t) {
    return motion.trails.flatMap(([frame, point, seconds]) => {
      const from = Math.max(0, t - seconds), steps = Math.min(160, Math.max(2, Math.ceil((t - from) * 60)));
      if (t <= from) return [];
      const places = Array.from({ length: steps + 1 }, (_, k) => {
        const [at, part] = locate(motion.times, from + (t - from) * k / steps), n = motion.tracks[frame].map(list => between(list, at, part));
        return moved(fromQuaternion(n.slice(3), n.slice(0, 3)), point);
      });
      const r = 0.006 * motion.size;
      return places.slice(1).flatMap((b, k) => {
        const a = places[k], way = sub(b, a), length = norm(way);
        return length > 0 ? [["pipe", [], mul(along(times(add(a, b), 0.5), way), scaled(r, r, 1.05 * length)), [0.93, 0.55, 0.12], 1]] : [];
      });
    });
  }

  // Extends the scene to new samples of a control loop: the view is enlarged, and a floor that is not
  // declared is lowered.
  function widen(motion, parts) {
    const extent = motion.extent ??= [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
    let grows = false;
    for (const p of corners(parts)) {
      motion.radius = Math.max(motion.radius, norm(sub(p, motion.centre)));
      if (motion.floor !== null && !motion.level) motion.floor = Math.min(motion.floor, dot(p, motion.up));
      for (const k of [0, 1, 2]) {
        if (p[k] < extent[0][k]) { extent[0][k] = p[k] - 0.03 * motion.size; grows = true; }
        if (p[k] > extent[1][k]) { extent[1][k] = p[k] + 0.03 * motion.size; grows = true; }
      }
    }
    if (grows && !follow.on) view.fittedTo = "";
  }

  const mesh = key => { const [m, k] = key.split(".").map(Number); return motions[m].pieces[k][6]; };

  function draw() {
    const w = stage.clientWidth, h = stage.clientHeight, ratio = Math.min(devicePixelRatio || 1, 2);
    const night = dark.matches;
    const tones = night
      ? { back: [0.102, 0.125, 0.157], floor: [0.13, 0.155, 0.19], shadow: [0.07, 0.085, 0.105], grid: 0.36 }
      : { back: [0.933, 0.945, 0.961], floor: [0.9, 0.915, 0.935], shadow: [0.77, 0.79, 0.82], grid: 0.68 };
    if (pen && w && h) {
      const size = [Math.round(w * ratio), Math.round(h * ratio)];
      if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    }
    const boxes = cells(w, h);
      const shape = [w, h, follow.on].join();
    if (view.isFitted && view.fittedTo !== shape && w && h) { view.fittedTo = shape; fit(boxes); }
    if (pen && w && h) pen.clear(tones.back);
    motions.forEach((motion, index) => {
      const [x, y, cw, ch] = boxes[index], t = Math.min(state.now, motion.duration);
      const { now, parts: own } = partsAt(index, t), parts = own.flat();
      Object.assign(labels[index].style, { left: x + "px", top: y + "px", maxWidth: cw + "px" });
      const caption = motion.captions.filter(c => c[0] <= t + 1e-9).pop();
      labels[index].lastChild.textContent = caption ? caption[1] : "";
      if (!pen || !w || !h) return;
      if (motion.live) widen(motion, parts.filter(([, , , , alpha]) => alpha === 1));
      if (frames.on) parts.push(...triads(motion, now));
      parts.push(...trails(motion, t));
      if (simulation) parts.push(...simulation.spring(motion));
      const target = targetOf(motion, now), camera = cameraOf(motion, target, cw, ch);
      let floor = null;
      if (motion.floor !== null) {
        const half = FLOOR_HALF * Math.max(follow.on ? motion.size : motion.radius, 1e-9), lower = p => add(p, times(motion.up, motion.floor - dot(p, motion.up)));
        const cell = 10 ** Math.round(Math.log10(motion.size / 4)), up = motion.up, sun = camera.sun, lean = 1 / dot(sun, up);
        // p − (up·p − height) sun / (sun·up), slightly above the floor.
        const height = motion.floor + 0.001 * motion.size;
        const column = e => sub(e, times(sun, dot(e, up) * lean));
        const press = columns(column([1, 0, 0]), column([0, 1, 0]), column([0, 0, 1]), times(sun, height * lean));
        floor = { place: lower(target), half, cell, press };
      }
      const flip = [Math.round(x * ratio), Math.round((h - y - ch) * ratio), Math.round(cw * ratio), Math.round(ch * ratio)];
      pen.draw(parts, floor, camera, tones, flip, mesh);
    });
    slider.value = state.now;
    clock.textContent = (motions[0].start + state.now).toFixed(duration < 1 ? 3 : 2) + " s";
    figures.forEach(f => f.draw(state.now));
  }

  // Control loop: the page shows the newest sample while it plays, otherwise an earlier one.
  function listen() {
    const socket = new WebSocket(`ws://${location.host}/socket`);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => { live.captions = []; state.dirty = true; };
    socket.onmessage = ({ data }) => {
      if (!receive(live, data)) return location.reload();
      duration = live.duration;
      [slider.min, slider.max] = [begin(), duration];
      state.now = state.playing ? duration : clamp(state.now, begin(), duration);
      state.dirty = true;
    };
    socket.onclose = () => { live.captions = [[-1e9, "the program has ended, or cannot be reached"]]; state.dirty = true; setTimeout(listen, 1000); };
  }
  let simulation = null;
  if (simulated) simulate();
  else if (live) listen();

  // Simulates the mechanism: a sample is recorded whenever the page is drawn.
  function simulate() {
    let hasFailed = false;
    const begin = { q: [...simulated.q], v: [...simulated.v], x: [...simulated.x] };
    const say = words => { live.captions = words ? [[-1e9, words]] : []; state.dirty = true; };
    const record = sim => {
      append(live, sim.t, linkworkControls.sampleOf(live, sim));
      duration = live.duration;
      [slider.min, slider.max] = [live.times[0], duration];
      state.now = duration;
      state.dirty = true;
    };
    // Carries out a change. A mechanism that cannot be assembled or continued stops, with a message.
    const attempt = change => {
      try { change(); if (hasFailed) say(""); hasFailed = false; }
      catch (error) {
        if (!(error instanceof RangeError)) throw error;
        hasFailed = true;
        setPlaying(false);
        say(error.message);
      }
    };
    linkwork.Simulation.open({ ...simulated, module: live.module }).then(sim => {
      const restartNow = () => { live.heard = false; sim.reset(begin); record(sim); };
      const act = (change, restarts) => attempt(() => {
        change();
        painted = motions.map(paint);
        if (!sim.isFinite() || sim.violation() > 1e-6) throw new RangeError("The mechanism cannot be assembled with these values.");
        if (restarts) live.heard = false;
        if (restarts || !state.playing) record(sim);
      });
      const controls = linkworkControls.panels(live, sim, begin, act);
      root.insertBefore(element("div", { class: "panels" }, ...controls.nodes), root.querySelector(".plots"));
      restart.onclick = () => attempt(restartNow);
      one.onclick = () => { setPlaying(false); attempt(() => { sim.advance(0.01); record(sim); }); };
      restartNow();
      setPlaying(!matchMedia("(prefers-reduced-motion: reduce)").matches);
      simulation = player(sim, attempt, record, say);
      root.dataset.ready = "true";
    }).catch(error => { say("The simulation could not be started: " + error.message); });
  }
  // Returns the functions that advance the simulation and pull a point of it.
  function player(sim, attempt, record, say) {
    let late = 0, told = "", plane = null;
    const ray = e => {
      const box = canvas.getBoundingClientRect(), { now } = partsAt(motions.indexOf(live), state.now), camera = cameraOf(live, targetOf(live, now), box.width, box.height);
      const [x, y, back] = camera.axes, [a, b] = [2 * (e.clientX - box.left) / box.width - 1, 1 - 2 * (e.clientY - box.top) / box.height];
      return { camera, way: unit(add(add(times(x, a * camera.tangent * camera.aspect), times(y, b * camera.tangent)), times(back, -1))), height: box.height };
    };
    // Returns the frame and the position of the nearest part of a body under the pointer.
    const pick = e => {
      const { camera, way, height } = ray(e), { parts } = partsAt(motions.indexOf(live), state.now), margin = (e.pointerType === "touch" ? 14 : 5) / (camera.pixels * height);
      let best = null;
      parts.forEach((list, k) => {
        const piece = live.pieces[k];
        if (!piece || piece[3] < 0 || piece[1] === "Input" || piece[1] === "Surface") return;
        for (const [name, more, m, , alpha] of list) {
          const away = alpha < 1 ? null : linkworkControls.entry(name, m, boxAround(name, more), camera.eye, way, margin);
          if (away !== null && (!best || away < best.away)) best = { away, frame: piece[3], place: add(camera.eye, times(way, away)), back: camera.axes[2] };
        }
      });
      return best;
    };
    const onPlane = e => {
      const { camera, way } = ray(e);
      return add(camera.eye, times(way, dot(sub(plane.place, camera.eye), plane.back) / (dot(way, plane.back) || -1e-9)));
    };
    return {
      advance(passed) {
        const start = performance.now(), time = passed * +speed.value;
        attempt(() => {
          const left = sim.advance(time, () => performance.now() - start > 14);
          record(sim);
          late = 0.95 * late + 0.05 * left / Math.max(time, 1e-9);
          // A motion that is too fast for this machine is slowed down to a speed that it can follow.
          const slower = speeds.findLast(x => x <= +speed.value * (1 - late));
          if (late > 0.5 && slower) [speed.value, late] = [slower, 0];
          const words = late > 0.1 ? `slower than real time: ${(+speed.value * (1 - late)).toPrecision(2)} ×` : "";
          if (words !== told) say(told = words);
        });
      },
      grab(e) {
        const found = pick(e);
        if (!found) return false;
        const pose = poses(live, state.now)[found.frame], way = sub(found.place, [pose[12], pose[13], pose[14]]);
        const local = [0, 1, 2].map(k => dot(way, [pose[4 * k], pose[4 * k + 1], pose[4 * k + 2]]));
        plane = found;
        attempt(() => sim.hold(live.used[found.frame], local, found.place));
        setPlaying(true);
        canvas.classList.add("pulls");
        return true;
      },
      drag(e) {
        if (sim.pull && e.buttons) sim.pull.target = onPlane(e);
        else if (e.pointerType === "mouse" && !e.buttons) canvas.classList.toggle("grabs", !!pick(e));
      },
      release() { if (sim.pull) sim.hold(null); canvas.classList.remove("pulls"); },
      spring(motion) {
        if (!sim.pull || motion !== live) return [];
        const from = sim.point(sim.t, sim.q), to = sim.pull.target, way = sub(to, from), length = norm(way), r = 0.012 * motion.size;
        const ball = place => ["sphere", [], mul(columns([1, 0, 0], [0, 1, 0], [0, 0, 1], place), scaled(1.6 * r, 1.6 * r, 1.6 * r)), TONES.Input, 1];
        return [ball(from), ball(to), ...(length > 1e-9 ? [["coil", [], mul(along(from, way), scaled(2 * r, 2 * r, length)), TONES.Input, 1]] : [])];
      },
    };
  }

  let before = null;
  function step(time) {
    const passed = Math.min(0.1, (time - (before ?? time)) / 1000);
    before = time;
    if (simulation && state.playing && visible) simulation.advance(passed);
    if (state.playing && visible && !live) {
      state.now += passed * +speed.value;
      if (state.now > duration) state.now = 0;
      state.dirty = true;
    }
    if (state.dirty && visible) { state.dirty = false; draw(); }
    requestAnimationFrame(step);
  }
  requestAnimationFrame(step);
}

// ---- Plots

const digits = x => x === 0 ? "0" : Math.abs(x) >= 1e5 || Math.abs(x) < 1e-3 ? x.toExponential(2).replace(/\.?0+e/, "e") : String(+x.toPrecision(4));
function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw)), step = power * [1, 2, 5, 10].find(f => f * power >= raw);
  const list = [];
  for (let x = Math.ceil(low / step - 1e-9) * step; x <= high + 1e-9 * step && list.length < 50; x += step) list.push(Math.abs(x) < step * 1e-9 ? 0 : x);
  return list;
}
function figure(plot, span, seek) {
  const { motion, curves } = plot, canvas = element("canvas", { role: "img", "aria-label": plot.title }), pen = canvas.getContext("2d");
  const legend = element("div", { class: "legend" });
  const values = curves.map((curve, k) => {
    const c = PALETTE[k % PALETTE.length].map(x => Math.round(255 * x)), value = element("span");
    legend.append(element("span", {}, element("i", { style: `background:rgb(${c})` }), curve.name + " ", value));
    return value;
  });
  const node = element("figure", {}, element("figcaption", {}, plot.title + (plot.unit ? ", " + plot.unit : "")), canvas, legend);
  let low, high, from, to;
  const measure = () => {
    [low, high, [from, to]] = [Infinity, -Infinity, span()];
    for (const { values } of curves) for (const x of values) if (!Number.isNaN(x)) { low = Math.min(low, x); high = Math.max(high, x); }
    if (!(low <= high)) [low, high] = [-1, 1];
    const size = Math.max(Math.abs(low), Math.abs(high)), slack = high - low > 1e-12 * size ? 0.06 * (high - low) : Math.max(1e-9, size) * 0.5;
    [low, high] = [low - slack, high + slack];
  };
  measure();
  const left = 52, bottom = 20, top = 6;
  const across = (t, w) => left + (t - from) / (to - from) * (w - left - 8), rise = (x, h) => top + (high - x) / (high - low) * (h - top - bottom);
  let held = false;
  const point = e => { const box = canvas.getBoundingClientRect(); seek(from + (e.clientX - box.left - left) / (box.width - left - 8) * (to - from)); };
  canvas.addEventListener("pointerdown", e => { held = true; canvas.setPointerCapture(e.pointerId); point(e); });
  canvas.addEventListener("pointermove", e => { if (held) point(e); });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = false; });
  return { node, draw(now) {
    const w = canvas.clientWidth, h = canvas.clientHeight, ratio = devicePixelRatio || 1;
    if (!w || !h) return;
    if (motion.live) measure();
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
    const style = getComputedStyle(node), soft = style.getPropertyValue("--lw-soft"), line = style.getPropertyValue("--lw-line"), ink = style.getPropertyValue("--lw-ink");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    pen.font = "11px system-ui, sans-serif";
    pen.fillStyle = soft; pen.strokeStyle = line; pen.lineWidth = 1;
    pen.textAlign = "right"; pen.textBaseline = "middle";
    // Labels of values that differ little are relative to the lowest mark, which is printed in the plot.
    const marks = ticks(low, high, 4), close = high - low < 1e-3 * Math.max(Math.abs(low), Math.abs(high)), base = close ? marks[0] : 0;
    for (const x of marks) {
      const y = rise(x, h);
      pen.beginPath(); pen.moveTo(left, y); pen.lineTo(w - 8, y); pen.stroke();
      if (!close) pen.fillText(digits(x), left - 6, y);
      else if (x > base) pen.fillText("+" + digits(+(x - base).toPrecision(3)), left - 6, y);
    }
    if (close) { pen.textAlign = "left"; pen.textBaseline = "bottom"; pen.fillText(String(+base.toPrecision(12)), left + 4, rise(base, h) - 2); }
    pen.textAlign = "center"; pen.textBaseline = "top";
    for (const t of ticks(from, to, w / 80)) pen.fillText(digits(motion.start + t), across(t, w), h - bottom + 5);
    curves.forEach(({ values }, k) => {
      pen.strokeStyle = `rgb(${PALETTE[k % PALETTE.length].map(x => Math.round(255 * x))})`;
      pen.lineWidth = 1.6;
      pen.beginPath();
      let open = false;
      for (let j = 0; j < values.length; j++) {
        if (Number.isNaN(values[j])) { open = false; continue; }
        const x = across(motion.times[j], w), y = rise(values[j], h);
        if (open) pen.lineTo(x, y); else pen.moveTo(x, y);
        open = true;
      }
      pen.stroke();
    });
    const x = across(now, w), [k, part] = locate(motion.times, Math.min(now, motion.duration));
    pen.strokeStyle = ink; pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(x, top); pen.lineTo(x, h - bottom); pen.stroke();
    curves.forEach(({ values: list }, j) => { const v = between(list, k, part); values[j].textContent = Number.isNaN(v) ? "–" : digits(v); });
  } };
}

document.querySelectorAll(".linkwork-view").forEach(start);
})();
