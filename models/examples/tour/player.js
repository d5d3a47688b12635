// Plays the scenes of the page: moving points (x right, y away, z up), with parts drawn between them from back to front.
"use strict";
// If the address ends with `#picture`, the page is a picture of the scenes, each at one instant.
const still = location.hash === "#picture";
document.documentElement.classList.toggle("picture", still);
for (const figure of document.querySelectorAll(".scene")) play(figure);

function play(figure) {
  const scene = JSON.parse(figure.querySelector("script").textContent);
  const canvas = figure.querySelector("canvas"), pen = canvas.getContext("2d");
  const [button, slider, clock] = ["button", "input", "output"].map(tag => figure.querySelector(tag));
  const unpack = list => Array.from({ length: list.length / 3 }, (_, k) => [0, 1, 2].map(i => list[3 * k + i] / 1e5));
  const frames = scene.frames.map(unpack), guides = scene.guides.map(unpack);
  const last = frames.length - 1, pause = 1.2 * scene.rate * scene.speed;
  let now = still ? scene.still * scene.rate : 0, yaw = scene.yaw;
  let playing = !still && !matchMedia("(prefers-reduced-motion: reduce)").matches;
  let before = null, visible = true;
  button.textContent = playing ? "Pause" : "Play";

  button.onclick = () => { playing = !playing; button.textContent = playing ? "Pause" : "Play"; };
  slider.oninput = () => { now = +slider.value; if (playing) button.click(); draw(); };
  let grip = null;
  canvas.onpointerdown = e => { grip = [e.clientX, yaw]; canvas.setPointerCapture(e.pointerId); };
  canvas.onpointermove = e => { if (grip) { yaw = grip[1] - (e.clientX - grip[0]) * 0.4; draw(); } };
  canvas.onpointerup = canvas.onpointercancel = () => { grip = null; };
  new IntersectionObserver(seen => { visible = seen[0].isIntersecting; }).observe(canvas);
  new ResizeObserver(draw).observe(canvas);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  requestAnimationFrame(step);

  function step(time) {
    const passed = Math.min(0.1, (time - (before ?? time)) / 1000);
    before = time;
    if (playing && visible) {
      now += passed * scene.rate * scene.speed;
      if (now > last + pause) now = 0;
      if (!grip) yaw += scene.turning * passed;
      draw();
    }
    requestAnimationFrame(step);
  }

  function draw() {
    const at = Math.min(last, Math.floor(now)), points = frames[at];
    slider.value = at;
    clock.textContent = (at / scene.rate).toFixed(2) + " s";
    const ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, w, h);
    pen.lineCap = pen.lineJoin = "round";
    const style = getComputedStyle(document.documentElement), colour = name => style.getPropertyValue("--" + name).trim();
    const tones = ["body", "dark", "accent", "second"].map(colour);

    // Perspective from a distance of three times the size of the scene.
    const [cy, sy] = [Math.cos(yaw * Math.PI / 180), Math.sin(yaw * Math.PI / 180)];
    const [cp, sp] = [Math.cos(scene.pitch * Math.PI / 180), Math.sin(scene.pitch * Math.PI / 180)];
    const scale = Math.min(w / scene.size[0], h / scene.size[1]), away = 3 * Math.max(...scene.size);
    const see = p => {
      const [x, y, z] = [0, 1, 2].map(i => p[i] - scene.target[i]);
      const right = cy * x + sy * y, forth = cy * y - sy * x, depth = forth * cp - z * sp;
      const near = away / (away + depth);
      return [w / 2 + right * scale * near, h / 2 - (forth * sp + z * cp) * scale * near, depth, scale * near];
    };
    const line = (list, close) => {
      pen.beginPath();
      list.forEach((p, k) => k ? pen.lineTo(p[0], p[1]) : pen.moveTo(p[0], p[1]));
      if (close) pen.closePath();
    };

    if (scene.floor) {
      const [z, half] = scene.floor, cell = half / 6, flat = p => see([p[0], p[1], z]);
      const [ox, oy] = scene.target;
      pen.strokeStyle = colour("grid"); pen.lineWidth = 1;
      for (let k = -6; k <= 6; k++) {
        line([flat([ox + k * cell, oy - half]), flat([ox + k * cell, oy + half])]); pen.stroke();
        line([flat([ox - half, oy + k * cell]), flat([ox + half, oy + k * cell])]); pen.stroke();
      }
      pen.fillStyle = pen.strokeStyle = colour("shadow");
      for (const part of scene.parts) shade(part, flat);
    }
    pen.strokeStyle = colour("soft"); pen.lineWidth = 1.2; pen.setLineDash([4, 5]);
    for (const guide of guides) { line(guide.map(see)); pen.stroke(); }
    pen.setLineDash([]);
    if (scene.trail) {
      const [point, length] = scene.trail, first = Math.max(0, at - length);
      pen.strokeStyle = colour("second"); pen.lineWidth = 2; pen.lineCap = "butt";
      for (let k = first + 1; k <= at; k++) {
        pen.globalAlpha = 0.15 + 0.75 * (k - first) / (at - first);
        line([see(frames[k - 1][point]), see(frames[k][point])]); pen.stroke();
      }
      pen.globalAlpha = 1; pen.lineCap = "round";
    }
    const parts = scene.parts.map(part => {
      const ends = part[0] === "face" ? part[1] : part[0] === "ball" ? [part[1]] : [part[1], part[2]];
      const seen = ends.map(k => see(points[k]));
      // Balls are drawn over the rods that end in them.
      const bias = part[0] === "ball" ? 3 * part[2] : 0;
      return { part, seen, ends, depth: seen.reduce((sum, p) => sum + p[2], 0) / seen.length - bias };
    });
    parts.sort((a, b) => b.depth - a.depth);
    for (const { part, seen, ends } of parts) paint(part, seen, ends);

    const caption = scene.captions.filter(c => c[0] <= at).pop();
    if (caption && !still) { pen.fillStyle = colour("soft"); pen.font = "13px system-ui, sans-serif"; pen.fillText(caption[1], 0, 16); }

    function paint([kind, ...rest], seen, ends) {
      const tone = tones[rest[rest.length - 1]];
      if (kind === "rod") {
        // A dark edge, the colour, and a highlight along the middle.
        const width = rest[2] * (seen[0][3] + seen[1][3]);
        line(seen);
        for (const [part, mix] of [[1, -0.35], [0.82, 0], [0.3, 0.25]]) { pen.lineWidth = Math.max(1, width * part); pen.strokeStyle = mixed(tone, mix); pen.stroke(); }
      } else if (kind === "ball") {
        const [x, y, , s] = seen[0], radius = Math.max(1.5, rest[1] * s);
        const light = pen.createRadialGradient(x - radius * 0.35, y - radius * 0.4, radius * 0.1, x, y, radius);
        light.addColorStop(0, mixed(tone, 0.4)); light.addColorStop(0.7, tone); light.addColorStop(1, mixed(tone, -0.35));
        pen.fillStyle = light;
        pen.beginPath(); pen.arc(x, y, radius, 0, 2 * Math.PI); pen.fill();
      } else if (kind === "face") {
        const [a, b, c] = ends.map(k => points[k]);
        const [u, v] = [b, c].map(p => p.map((x, i) => x - a[i]));
        const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        const light = Math.abs(0.3 * n[0] - 0.45 * n[1] + 0.84 * n[2]) / (Math.hypot(...n) || 1);
        line(seen, true);
        pen.fillStyle = mixed(tone, 0.45 * light - 0.3); pen.fill();
        pen.strokeStyle = pen.fillStyle; pen.lineWidth = 0.7; pen.stroke();
      } else {
        const [[x0, y0], [x1, y1]] = seen, length = Math.hypot(x1 - x0, y1 - y0);
        if (length < 3) return;
        const [ux, uy] = [(x1 - x0) / length, (y1 - y0) / length], head = Math.min(10, length);
        pen.strokeStyle = pen.fillStyle = tone; pen.lineWidth = 3;
        line([[x0, y0], [x1 - ux * head, y1 - uy * head]]); pen.stroke();
        line([[x1, y1], [x1 - ux * head - uy * 5, y1 - uy * head + ux * 5], [x1 - ux * head + uy * 5, y1 - uy * head - ux * 5]], true); pen.fill();
      }
    }

    function shade([kind, ...rest], flat) {
      if (kind === "rod") { const seen = [flat(points[rest[0]]), flat(points[rest[1]])]; pen.lineWidth = Math.max(1, rest[2] * (seen[0][3] + seen[1][3])); line(seen); pen.stroke(); }
      if (kind === "ball") { const p = flat(points[rest[0]]); pen.beginPath(); pen.ellipse(p[0], p[1], rest[1] * p[3], rest[1] * p[3] * (0.2 + sp), 0, 0, 7); pen.fill(); }
      if (kind === "face") { line(rest[0].map(k => flat(points[k])), true); pen.fill(); }
    }
  }
}

// Returns a colour #rrggbb made lighter (positive amount) or darker (negative).
function mixed(hex, amount) {
  const to = amount > 0 ? 255 : 0, part = Math.abs(amount);
  return "rgb(" + [1, 3, 5].map(k => Math.round(parseInt(hex.slice(k, k + 2), 16) * (1 - part) + to * part)).join(",") + ")";
}
