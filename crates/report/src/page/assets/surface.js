// The model of a report in 3D: coloured by distance, with isolines and shortest paths, turned by
// hand. Drawn by a depth buffer on a canvas, which needs no graphics hardware; the picture that is
// in the page without scripts is drawn the same way, by `picture` of the crate geobench-export.

/** The numbers of a surface; `encode` in page/picture/surface.rs says how they are packed. */
async function unpack(surface) {
  const packed = Uint8Array.from(atob(surface.data), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let start = 0;
  const plane = (count, width) => {
    const numbers = width === 2 ? new Uint16Array(count) : new Uint32Array(count);
    let last = 0;
    for (let i = 0; i < count; i++) {
      for (let b = 0; b < width; b++) last += bytes[start + b * count + i] * 2 ** (8 * b);
      last = width === 2 ? last & 0xffff : last >>> 0;
      numbers[i] = last;
    }
    start += width * count;
    return numbers;
  };
  const { vertices, faces, extent, farthest, low } = surface;
  const positions = new Float32Array(3 * vertices);
  for (let k = 0; k < 3; k++) {
    plane(vertices, 2).forEach((steps, v) => { positions[3 * v + k] = low[k] + steps / 65534 * extent; });
  }
  const distances = new Float32Array(vertices);
  plane(vertices, 2).forEach((steps, v) => {
    distances[v] = steps === 65535 ? Infinity : steps / 65534 * farthest;
  });
  const corners = plane(3 * faces, 4), count = surface.isolines.reduce((a, b) => a + b, 0);
  const places = [0, 1, 2].map(k => plane(count, 2).reduce((all, steps, i) => {
    all[i] = low[k] + steps / 65534 * extent;
    return all;
  }, new Float32Array(count)));
  const isolines = [];
  let from = 0;
  for (const length of surface.isolines) {
    isolines.push(Array.from({ length }, (_, i) => places.map(axis => axis[from + i])));
    from += length;
  }
  return { positions, distances, corners, isolines };
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** The normals of faces and, weighted by area, of vertices; three numbers each, of length 1. */
function normals({ positions, corners }) {
  const flat = new Float32Array(corners.length), smooth = new Float32Array(positions.length);
  for (let f = 0; f < corners.length; f += 3) {
    const [a, b, c] = [3 * corners[f], 3 * corners[f + 1], 3 * corners[f + 2]];
    const edge = (to, k) => positions[to + k] - positions[a + k];
    for (let k = 0; k < 3; k++) {
      const [i, j] = [(k + 1) % 3, (k + 2) % 3];
      flat[f + k] = edge(b, i) * edge(c, j) - edge(b, j) * edge(c, i);
      for (const v of [a, b, c]) smooth[v + k] += flat[f + k];
    }
  }
  for (const all of [flat, smooth]) {
    for (let i = 0; i < all.length; i += 3) {
      const length = Math.hypot(all[i], all[i + 1], all[i + 2]) || 1;
      for (let k = 0; k < 3; k++) all[i + k] /= length;
    }
  }
  return { flat, smooth };
}

const LIGHT = [-0.35, 0.55, 0.76].map(x => x / Math.hypot(0.35, 0.55, 0.76));

/** Faces that meet at more than 40 degrees are not shaded smoothly. */
const SHARP = 0.766;

/** A view of a surface on a canvas. */
class View {
  constructor(surface, mesh, canvas) {
    Object.assign(this, { surface, mesh, canvas });
    this.normals = normals(mesh);
    const { low, extent } = surface;
    const { positions } = mesh;
    const high = [...low];
    for (let i = 0; i < positions.length; i++) high[i % 3] = Math.max(high[i % 3], positions[i]);
    this.middle = low.map((x, k) => (x + high[k]) / 2);
    this.radius = Math.hypot(...low.map((x, k) => high[k] - x)) / 2 || extent;
    this.places = new Float32Array(positions.length);
    this.lights = new Float32Array(positions.length / 3);
    this.show = { isolines: true, paths: true };
    this.picked = -1;
    this.reset();
  }

  reset() {
    this.axes = this.surface.axes.map(axis => [...axis]);
    this.zoom = 1.25;
  }

  /** Turns the model about the axis upwards on the screen and the one to the right, in radians. */
  turn(right, up) {
    const [x, y, z] = this.axes;
    const mix = (a, b, angle) => a.map((_, k) => a[k] * Math.cos(angle) + b[k] * Math.sin(angle));
    const away = mix(z, x, -right), side = mix(x, z, right);
    this.axes = [side, mix(y, away, -up), mix(away, y, up)];
  }

  scale() { return Math.min(this.canvas.width, this.canvas.height) / 2 / this.radius * this.zoom * 0.96; }

  /** The place of a point on the canvas, and its depth. */
  project(point) {
    const from = point.map((x, k) => x - this.middle[k]), scale = this.scale();
    return [this.canvas.width / 2 + dot(from, this.axes[0]) * scale,
      this.canvas.height / 2 - dot(from, this.axes[1]) * scale, dot(from, this.axes[2]) * scale];
  }

  /** Draws everything with some pixels for each unit of the canvas's natural size. */
  draw(density) {
    const { canvas } = this;
    [canvas.width, canvas.height] = [480, 400].map(x => Math.round(x * density));
    const pixels = canvas.width * canvas.height;
    if (this.depth?.length !== pixels) {
      this.depth = new Float32Array(pixels);
      this.distance = new Float32Array(pixels);
      this.light = new Float32Array(pixels);
      this.face = new Int32Array(pixels);
    }
    this.depth.fill(-Infinity);
    this.face.fill(-1);
    this.fill();
    const context = canvas.getContext("2d", { willReadFrequently: true });
    const image = context.createImageData(canvas.width, canvas.height);
    this.colour(image.data);
    const line = (points, width, colour) => this.line(image.data, points, width * density, colour);
    if (this.show.isolines) for (const points of this.mesh.isolines) line(points, 0.6, [24, 24, 30]);
    if (this.show.paths) {
      const { paths } = this.surface;
      for (const { points } of paths) line(points, 3.4, [255, 255, 255]);
      for (const { points } of paths) line(points, 1.8, [214, 40, 57]);
      if (paths[this.picked]) {
        line(paths[this.picked].points, 5, [0, 0, 0]);
        line(paths[this.picked].points, 3, [255, 190, 0]);
      }
    }
    context.putImageData(image, 0, 0);
    const [x, y, z] = this.project(this.surface.source);
    const at = Math.round(x - 0.5) + canvas.width * Math.round(y - 0.5);
    if (z > (this.depth[at] ?? -Infinity) - this.slack()) {
      for (const [radius, colour] of [[5, "#000"], [3.6, "#fff"]]) {
        context.beginPath();
        context.arc(x, y, radius * density, 0, 2 * Math.PI);
        context.fillStyle = colour;
        context.fill();
      }
    }
  }

  slack() { return Math.max(this.canvas.width, this.canvas.height) * 0.01; }

  brightness(normals, at) {
    const [x, y, z] = this.axes;
    const a = normals[at], b = normals[at + 1], c = normals[at + 2];
    const right = a * x[0] + b * x[1] + c * x[2], up = a * y[0] + b * y[1] + c * y[2];
    const seen = a * z[0] + b * z[1] + c * z[2], sign = seen < 0 ? -1 : 1;
    return 0.55 + 0.45 * Math.max(0, sign * (right * LIGHT[0] + up * LIGHT[1] + seen * LIGHT[2]));
  }

  /** Fills depth, distance, light and face of every pixel. */
  fill() {
    const { places, lights, depth, distance, light, face } = this;
    const { positions, distances, corners } = this.mesh, { flat, smooth } = this.normals;
    const { width, height } = this.canvas;
    // As in `project`, without an array for each vertex.
    const scale = this.scale(), [mx, my, mz] = this.middle;
    const [r0, r1, r2, u0, u1, u2, t0, t1, t2] = this.axes.flat().map(part => part * scale);
    for (let v = 0, at = 0; v < lights.length; v++, at += 3) {
      const x = positions[at] - mx, y = positions[at + 1] - my, z = positions[at + 2] - mz;
      places[at] = width / 2 + r0 * x + r1 * y + r2 * z;
      places[at + 1] = height / 2 - u0 * x - u1 * y - u2 * z;
      places[at + 2] = t0 * x + t1 * y + t2 * z;
      lights[v] = this.brightness(smooth, at);
    }
    for (let f = 0; f < corners.length; f += 3) {
      const a = corners[f], b = corners[f + 1], c = corners[f + 2];
      const ax = places[3 * a], ay = places[3 * a + 1], bx = places[3 * b], by = places[3 * b + 1];
      const cx = places[3 * c], cy = places[3 * c + 1];
      const area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax);
      if (!area) continue;
      const left = Math.max(0, Math.floor(Math.min(ax, bx, cx)));
      const right = Math.min(width - 1, Math.ceil(Math.max(ax, bx, cx)));
      const top = Math.max(0, Math.floor(Math.min(ay, by, cy)));
      const bottom = Math.min(height - 1, Math.ceil(Math.max(ay, by, cy)));
      if (left > right || top > bottom) continue;
      let own = -1;
      const lit = v => {
        const at = 3 * v;
        if (smooth[at] * flat[f] + smooth[at + 1] * flat[f + 1] + smooth[at + 2] * flat[f + 2] > SHARP) {
          return lights[v];
        }
        return own < 0 ? own = this.brightness(flat, f) : own;
      };
      const [la, lb, lc] = [lit(a), lit(b), lit(c)];
      const az = places[3 * a + 2], bz = places[3 * b + 2], cz = places[3 * c + 2];
      for (let y = top; y <= bottom; y++) {
        for (let x = left; x <= right; x++) {
          const px = x + 0.5, py = y + 0.5;
          const u = ((cx - bx) * (py - by) - (cy - by) * (px - bx)) / area;
          const v = ((ax - cx) * (py - cy) - (ay - cy) * (px - cx)) / area;
          const w = 1 - u - v;
          if (u < -1e-6 || v < -1e-6 || w < -1e-6) continue;
          const at = x + width * y, z = u * az + v * bz + w * cz;
          if (z <= depth[at]) continue;
          depth[at] = z;
          distance[at] = u * distances[a] + v * distances[b] + w * distances[c];
          light[at] = u * la + v * lb + w * lc;
          face[at] = f / 3;
        }
      }
    }
  }

  /** The colour of every pixel: the ramp, dark where an isoline passes. */
  colour(data) {
    const { depth, distance, light, face } = this;
    const { farthest, step, ramp, unreached } = this.surface;
    const { width } = this.canvas, near = this.slack();
    // The exact ones are lines of their own.
    const interpolates = this.show.isolines && !this.mesh.isolines.length;
    const differs = (other, at, band) => face[other] >= 0 && Math.abs(depth[other] - depth[at]) < near
      && Number.isFinite(distance[other]) && Math.floor(distance[other] / step) !== band;
    for (let at = 0; at < face.length; at++) {
      if (face[at] < 0) continue;
      const d = distance[at];
      let ink = light[at], from = unreached, to = unreached, part = 0;
      if (Number.isFinite(d)) {
        const place = Math.min(Math.max(farthest > 0 ? d / farthest : 0, 0), 1) * (ramp.length - 1);
        const low = Math.floor(place), band = Math.floor(d / step);
        part = place - low;
        from = ramp[low];
        to = ramp[Math.min(low + 1, ramp.length - 1)];
        if (interpolates && (differs(at + 1, at, band) || differs(at + width, at, band))) ink *= 0.45;
      }
      for (let k = 0; k < 3; k++) data[4 * at + k] = (from[k] + part * (to[k] - from[k])) * ink;
      data[4 * at + 3] = 255;
    }
  }

  /** Draws the parts of a line on the surface that are in front. */
  line(data, points, size, colour) {
    const { width, height } = this.canvas, slack = this.slack();
    const places = points.map(point => this.project(point));
    for (let i = 0; i + 1 < places.length; i++) {
      const [from, to] = [places[i], places[i + 1]];
      const steps = Math.ceil(Math.max(Math.abs(to[0] - from[0]), Math.abs(to[1] - from[1]), 1));
      for (let s = 0; s <= steps; s++) {
        const [x, y, z] = from.map((value, k) => value + (to[k] - value) * s / steps);
        for (let py = Math.floor(y - size / 2 + 0.5); py <= y + size / 2; py++) {
          for (let px = Math.floor(x - size / 2 + 0.5); px <= x + size / 2; px++) {
            if (px < 0 || py < 0 || px >= width || py >= height) continue;
            const at = px + width * py;
            if (z < this.depth[at] - slack) continue;
            data[4 * at] = colour[0];
            data[4 * at + 1] = colour[1];
            data[4 * at + 2] = colour[2];
            data[4 * at + 3] = 255;
          }
        }
      }
    }
  }

  /** The distance at a place of the canvas, from 0 to 1 each way; undefined beside the model. */
  at(x, y) {
    const column = Math.floor(x * this.canvas.width), row = Math.floor(y * this.canvas.height);
    const at = column + this.canvas.width * row;
    return this.face[at] >= 0 ? this.distance[at] : undefined;
  }
}

/** Puts the view in place of the picture of a figure. */
async function showSurface(figure, surface) {
  if (typeof DecompressionStream === "undefined") return;
  const mesh = await unpack(surface);
  const svg = figure.querySelector("svg");
  const name = svg.querySelector("title").textContent;
  const canvas = make("canvas", {
    tabindex: "0", role: "application", "aria-roledescription": "model in 3D",
    "aria-label": `${name}. Arrow keys turn it, plus and minus zoom.`,
  });
  const stage = make("div", { class: "stage" });
  svg.replaceWith(stage);
  stage.append(svg, canvas);
  // The colour scale stays.
  for (const node of svg.querySelectorAll("image, circle, polyline")) node.remove();
  svg.querySelector("title").remove();
  svg.setAttribute("aria-label", "Colour scale of distances");
  svg.removeAttribute("aria-labelledby");

  const view = new View(surface, mesh, canvas);
  let waiting = 0, settled = 0;
  const draw = () => {
    if (waiting) return;
    waiting = requestAnimationFrame(() => {
      waiting = 0;
      view.draw(1);
      clearTimeout(settled);
      settled = setTimeout(() => view.draw(2.4), 180);
    });
  };

  const toggle = (label, key) => {
    const button = make("button", { type: "button", "aria-pressed": "true" }, label);
    button.addEventListener("click", () => {
      view.show[key] = !view.show[key];
      button.setAttribute("aria-pressed", view.show[key]);
      draw();
    });
    return button;
  };
  const act = (label, text, action) => {
    const button = make("button", { type: "button", "aria-label": label }, text);
    button.addEventListener("click", () => { action(); draw(); });
    return button;
  };
  const tools = make("div", { class: "tools", role: "group", "aria-label": "View" },
    toggle("Isolines", "isolines"), ...(surface.paths.length ? [toggle("Paths", "paths")] : []),
    act("Nearer", "+", () => { view.zoom *= 1.25; }), act("Farther", "−", () => { view.zoom /= 1.25; }),
    act("As at first", "Reset", () => view.reset()));
  if (surface.paths.length) {
    const choice = make("select", { "aria-label": "Path" }, make("option", { value: "-1" }, "Mark a path"),
      ...surface.paths.map((path, i) =>
        make("option", { value: i }, `to vertex ${path.target}, ${significant(path.length)}`)));
    choice.addEventListener("change", () => { view.picked = Number(choice.value); draw(); });
    tools.append(choice);
  }
  stage.after(tools, make("p", { class: "hint" }, surface.faces < surface.of
    ? `Drag to turn; the surface is decimated to ${surface.faces.toLocaleString("en")} of ${surface.of.toLocaleString("en")} faces.`
    : "Drag to turn."));

  let held = null;
  canvas.addEventListener("pointerdown", event => {
    held = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
    tip.hide();
  });
  canvas.addEventListener("pointermove", event => {
    const box = canvas.getBoundingClientRect();
    if (!held) {
      const distance = view.at((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
      if (distance === undefined) return tip.hide();
      const text = Number.isFinite(distance) ? `distance ${significant(distance)}` : "not reached";
      return tip.show(text, () => [event.clientX, event.clientY]);
    }
    view.turn((event.clientX - held[0]) / 120, (event.clientY - held[1]) / 120);
    held = [event.clientX, event.clientY];
    draw();
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { held = null; });
  canvas.addEventListener("pointerleave", () => tip.hide());
  canvas.addEventListener("keydown", event => {
    const turns = { ArrowLeft: [-0.15, 0], ArrowRight: [0.15, 0], ArrowUp: [0, -0.15], ArrowDown: [0, 0.15] };
    const zooms = { "+": 1.25, "=": 1.25, "-": 0.8 };
    if (event.key in turns) view.turn(...turns[event.key]);
    else if (event.key in zooms) view.zoom *= zooms[event.key];
    else return;
    event.preventDefault();
    draw();
  });
  view.draw(2.4);
}
