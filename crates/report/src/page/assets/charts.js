// Draws the charts of a report anew from their numbers, for what the reader has selected, and shows
// values on hover, touch and arrow keys. Scales and layout are those of page/chart in Rust, which
// draws the charts for readers without scripts.
"use strict";

const WIDTH = 480, LINE = 15, MARGIN = 6, MOST_LANES = 64, MOST_MARKERS = 25;
const COLOURS = 8, WIDEST_NAME = 165, FIELD = 230;

/** An element of a page or, with the prefix `svg:`, of a drawing. */
function make(name, attributes = {}, ...children) {
  const node = name.startsWith("svg:")
    ? document.createElementNS("http://www.w3.org/2000/svg", name.slice(4))
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const pen = document.createElement("canvas").getContext("2d");
pen.font = '11px system-ui, -apple-system, "Segoe UI", Roboto, "Liberation Sans", Arial, sans-serif';

const widthOf = text => pen.measureText(text).width + 2;

/** `text` cut to a width, with an ellipsis. */
function fitted(text, width) {
  if (widthOf(text) <= width) return text;
  let kept = text;
  while (kept && widthOf(kept + "…") > width) kept = kept.slice(0, -1);
  return kept + "…";
}

/** A number with four digits. */
function significant(value) {
  const size = Math.abs(value);
  if (size === 0 || !Number.isFinite(size)) return String(value);
  if (size < 1e-4) return value.toExponential(2);
  if (size >= 1e4) return value.toLocaleString("en", { maximumFractionDigits: 0 });
  return value.toFixed(Math.min(Math.max(3 - Math.floor(Math.log10(size)), 0), 9));
}

/** The short label of a tick. */
function tickLabel(value) {
  const size = Math.abs(value);
  if (size > 0 && size < 1e-4) return value.toExponential(0).replace("e+", "e");
  const [scaled, unit] = size >= 1e9 ? [value / 1e9, "G"] : size >= 1e6 ? [value / 1e6, "M"]
    : size >= 1e4 ? [value / 1e3, "k"] : [value, ""];
  return Number(scaled.toFixed(6)) + unit;
}

/** An axis over a range of values and places; see `Scale` in page/chart/axis.rs. */
class Scale {
  constructor(axis, values, ends, fromZero = false) {
    this.log = axis.log;
    this.ends = ends;
    this.drawn = values.filter(v => Number.isFinite(v) && (!axis.log || v > 0)).sort((a, b) => a - b);
    let low = this.drawn[0] ?? 1, high = this.drawn[this.drawn.length - 1] ?? 10;
    const inset = MARGIN * Math.sign(ends[1] - ends[0]);
    this.places = [fromZero ? ends[0] : ends[0] + inset, ends[1] - inset];
    if (this.log) {
      [low, high] = [low / 1.12, high * 1.12];
      if (high < 2 * low) {
        const middle = Math.sqrt(low * high);
        [low, high] = [middle / Math.SQRT2, middle * Math.SQRT2];
      }
    } else {
      if (fromZero || (low >= 0 && low < 0.5 * high)) low = Math.min(low, 0);
      if (high - low <= 1e-12 * Math.abs(high)) high = high === 0 ? 1 : high + Math.abs(high) / 2;
      const power = 10 ** Math.floor(Math.log10((high - low) / 5));
      this.step = [1, 2, 2.5, 5, 10].map(f => f * power).find(s => s >= (high - low) / 5 * (1 - 1e-9));
      low = Math.floor(low / this.step + 1e-9) * this.step;
      high = Math.ceil(high / this.step - 1e-9) * this.step;
    }
    this.values = [low, high];
  }

  /** The place of a value; null if it is not on the axis. */
  place(value) {
    const [low, high] = this.values, [from, to] = this.places;
    const share = this.log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
    return share >= -0.001 && share <= 1.001 ? from + share * (to - from) : null;
  }

  /** The place of a value, or of the end of the axis that is nearest to it. */
  clamped(value) {
    const [low, high] = this.values;
    return this.place(Math.min(Math.max(value, low), high)) ?? this.places[0];
  }

  /** Values of ticks with labels, and of ticks without. */
  ticks() {
    const [low, high] = this.values;
    if (!this.log) {
      const count = Math.round((high - low) / this.step), first = Math.round(low / this.step);
      return [Array.from({ length: count + 1 }, (_, i) => (first + i) * this.step), []];
    }
    const times = factors => {
      const all = [];
      for (let e = Math.floor(Math.log10(low)); e <= Math.ceil(Math.log10(high)); e++) {
        all.push(...factors.map(f => f * 10 ** e).filter(v => v >= low && v <= high));
      }
      return all;
    };
    const decades = Math.log10(high / low);
    let major = times([1]);
    if (decades > 7) major = major.filter((_, i) => i % Math.ceil(decades / 6) === 0);
    else if (decades < 1) major = times([1, 1.5, 2, 3, 4, 5, 7]);
    else if (decades < 2.4) major = times([1, 2, 5]);
    this.addForClusters(major);
    return [major, times([2, 3, 4, 5, 6, 7, 8, 9])];
  }

  /** Adds a tick for each cluster of values that has none near it, if its label has room. */
  addForClusters(ticks) {
    const room = this.ends[0] < this.ends[1] ? 36 : 16;
    const apart = (a, b) => Math.abs((this.place(a) ?? Infinity) - (this.place(b) ?? Infinity));
    const clusters = [];
    for (const value of this.drawn) {
      const last = clusters[clusters.length - 1];
      if (last && apart(last[last.length - 1], value) <= room) last.push(value);
      else clusters.push([value]);
    }
    for (const cluster of clusters) {
      const low = cluster[0], high = cluster[cluster.length - 1];
      const isNear = t => (t >= low && t <= high) || Math.min(apart(t, low), apart(t, high)) <= room;
      if (ticks.some(isNear)) continue;
      const middle = Math.sqrt(low * high);
      const digit = 10 ** (Math.floor(Math.log10(middle)) - 1);
      const tick = Math.round(middle / digit) * digit;
      if (this.place(tick) !== null && ticks.every(other => apart(other, tick) > room)) ticks.push(tick);
    }
    ticks.sort((a, b) => a - b);
  }
}

/** The corners of the markers around their middle; a circle has none. */
const SHAPES = [
  "", "-3.2,-3.2 3.2,-3.2 3.2,3.2 -3.2,3.2", "0,-4.2 4.2,3.2 -4.2,3.2", "0,-4.7 4.7,0 0,4.7 -4.7,0",
  "0,4.2 4.2,-3.2 -4.2,-3.2",
  "-1.3,-4.5 1.3,-4.5 1.3,-1.3 4.5,-1.3 4.5,1.3 1.3,1.3 1.3,4.5 -1.3,4.5 -1.3,1.3 -4.5,1.3 -4.5,-1.3 -1.3,-1.3",
  "0,-1.8 2.3,-4.1 4.1,-2.3 1.8,0 4.1,2.3 2.3,4.1 0,1.8 -2.3,4.1 -4.1,2.3 -1.8,0 -4.1,-2.3 -2.3,-4.1",
  "4.2,0 -3.2,-4.2 -3.2,4.2", "-2,-4.5 2,-4.5 2,4.5 -2,4.5",
];

const styleClass = style => "s" + style % COLOURS;

/** A drawing under way: what it consists of, and the values that can be read from it. */
class Drawing {
  constructor(id) {
    this.id = id;
    this.nodes = [];
    this.values = [];
  }

  add(name, attributes, text) {
    const node = make("svg:" + name, attributes);
    if (text !== undefined) node.textContent = text;
    this.nodes.push(node);
  }

  text([x, y], kind, text) { this.add("text", { class: kind, x, y }, text); }

  line(kind, [x1, y1], [x2, y2]) { this.add("line", { class: kind, x1, y1, x2, y2 }); }

  /** A value that can be read at a point. */
  value([x, y], text) { this.values.push({ x, y, text }); }

  marker(style, hollow, [x, y]) {
    const kind = `${hollow ? "open" : "mark"} ${styleClass(style)}`;
    const points = SHAPES[style % SHAPES.length];
    if (!points) this.add("circle", { class: kind, cx: x, cy: y, r: 3.6 });
    else this.add("polygon", { class: kind, points, transform: `translate(${x} ${y})` });
  }

  whisker(style, low, high) {
    const along = Math.abs(high[0] - low[0]), down = Math.abs(high[1] - low[1]);
    if (along + down <= 8) return;
    const kind = "whisker " + styleClass(style);
    const [dx, dy] = along > down ? [0, 3] : [3, 0];
    this.line(kind, low, high);
    for (const [x, y] of [low, high]) this.line(kind, [x - dx, y - dy], [x + dx, y + dy]);
  }

  /** Markers with names, in lines; returns their height. */
  legend([left, top], width, names) {
    let [x, y] = [left, top];
    for (const [style, hollow, name] of names) {
      const wide = widthOf(name) + 26;
      if (x > left && x + wide > left + width) [x, y] = [left, y + LINE];
      this.marker(style, hollow, [x + 6, y + 7.5]);
      this.text([x + 15, y + 11.5], "t", name);
      x += wide;
    }
    return names.length ? y + LINE + 4 - top : 0;
  }

  ticks(scale, ends, kind, at) {
    const [major, minor] = scale.ticks();
    const draw = (name, tick) => {
      const place = scale.place(tick);
      if (place !== null) this.line(name, ...ends(place));
      return place;
    };
    for (const tick of minor) draw("minor", tick);
    for (const tick of major) {
      const place = draw("grid", tick);
      if (place !== null) this.text(at(place), kind, tickLabel(tick));
    }
  }

  axisBelow(scale, label, [top, bottom]) {
    this.ticks(scale, x => [[x, top], [x, bottom]], "m", x => [x, bottom + 13]);
    const [from, to] = scale.ends;
    this.line("axis", [from, bottom], [to, bottom]);
    this.text([(from + to) / 2, bottom + 28], "m", label);
  }
}

/** A value with its interval, in words. */
function spoken(name, { value, interval }) {
  const text = `${name}: ${significant(value)}`;
  return interval ? `${text} [${interval.map(significant).join(", ")}]` : text;
}

const limits = ({ value, interval }) => interval ? [interval[0], value, interval[1]] : [value];

/** Draws points on lanes, a band for each model; returns the height. */
function drawDots(drawing, chart, shown) {
  let bands = chart.bands.filter(band => !band.title || shown.model(band.title)).map(band => ({
    title: band.title,
    lanes: band.lanes.filter(lane => !lane.algorithm || shown.algorithm(lane.algorithm)).map(lane => ({
      ...lane, points: lane.points.filter(point => !point.model || shown.model(point.model)),
    })).filter(lane => lane.points.length || lane.absent),
  })).filter(band => band.lanes.length);
  let legend = chart.legend;
  const count = bands.reduce((sum, band) => sum + band.lanes.length, 0);
  if (count > MOST_LANES && bands.length > 1) {
    const names = new Map(bands.flatMap(b => b.lanes).flatMap(l => l.points)
      .map(p => [p.name + p.hollow, [p.style, p.hollow, p.name]]));
    legend = [...legend, ...names.values()];
    bands = [{ title: "", lanes: bands.map(band => ({
      label: band.title, samples: [],
      points: band.lanes.flatMap(lane => lane.points),
      absent: band.lanes.filter(l => l.absent).map(l => `${l.label} ${l.absent}`).join(", "),
    })) }];
  }
  const lanes = bands.flatMap(band => band.lanes);
  if (!lanes.length) return nothing(drawing);
  const left = Math.min(Math.max(...lanes.map(lane => widthOf(lane.label))), WIDEST_NAME) + 12;
  const top = 4 + drawing.legend([4, 2], WIDTH - 8, legend);
  const values = lanes.flatMap(lane => [...lane.points.flatMap(p => limits(p.value)), ...lane.samples]);
  if (chart.reference !== null) values.push(chart.reference);
  const scale = new Scale(chart.axis, values, [left, WIDTH - 14]);
  const height = band => (band.title ? LINE + 2 : 0) + LINE * band.lanes.length + 5;
  const bottom = bands.reduce((sum, band) => sum + height(band), top);
  drawing.axisBelow(scale, chart.axis.label, [top, bottom]);
  const one = chart.reference === null ? null : scale.place(chart.reference);
  if (one !== null) drawing.line("one", [one, top], [one, bottom]);
  let y = top;
  for (const band of bands) {
    if (band.title) {
      drawing.text([4, y + 12], "b", fitted(band.title, WIDTH - 20));
      y += LINE + 2;
    }
    for (const lane of band.lanes) {
      drawLane(drawing, lane, scale, y + LINE / 2, band.title || lane.label);
      y += LINE;
    }
    y += 5;
  }
  return bottom + 34;
}

function drawLane(drawing, lane, scale, y, model) {
  const [left, right] = scale.ends;
  drawing.text([left - 8, y + 3.8], "e", fitted(lane.label, WIDEST_NAME));
  drawing.line("lane", [left, y], [right, y]);
  const dots = lane.samples.map((value, i) => [scale.place(value), y + 9 * ((i * 0.618034) % 1 - 0.5)]);
  if (dots.length) {
    const path = dots.filter(([x]) => x !== null).map(([x, y]) => `M${x.toFixed(1)} ${y.toFixed(1)}h0`);
    drawing.add("path", { class: "sample " + styleClass(lane.points[0].style), d: path.join("") });
    lane.samples.forEach((value, i) => {
      if (dots[i][0] !== null) drawing.value(dots[i], `${model}, ${lane.label}, sample ${i + 1}: ${significant(value)}`);
    });
  }
  let farthest = left;
  for (const point of lane.points) {
    const x = scale.place(point.value.value);
    if (x === null) continue;
    farthest = Math.max(farthest, x);
    const ends = point.value.interval;
    if (ends) drawing.whisker(point.style, ...ends.map(end => [scale.clamped(end), y]));
    drawing.marker(point.style, point.hollow, [x, y]);
    drawing.value([x, y], spoken(`${model}, ${point.name}`, point.value));
  }
  if (lane.absent) {
    const x = farthest + 12 + widthOf(lane.absent) < right ? farthest + 8 : left + 4;
    drawing.text([x, y + 3.8], "f", fitted(lane.absent, right - x));
  }
}

/** Draws bars made of parts; returns the height. */
function drawBars(drawing, chart, shown) {
  const groups = chart.groups.filter(group => shown.model(group.title)).map(group => ({
    title: group.title, bars: group.bars.filter(bar => shown.algorithm(bar.label)),
  })).filter(group => group.bars.length);
  const bars = groups.flatMap(group => group.bars);
  if (!bars.length) return nothing(drawing);
  const sum = bar => bar.parts.reduce((a, b) => a + b, 0);
  const left = Math.min(Math.max(...bars.map(bar => widthOf(bar.label))), WIDEST_NAME) + 12;
  const notes = Math.max(0, ...bars.filter(bar => !bar.failed).map(bar => widthOf(bar.note)));
  const scale = new Scale(chart.axis, bars.map(sum), [left, WIDTH - notes - 12], true);
  const part = (k, x, y, width, height) => drawing.add("rect", {
    class: ["s0", "s4", "s2"][k], x, y, width, height, stroke: "currentColor", "stroke-width": 0.8,
    fill: k === 0 ? "currentColor" : `url(#${drawing.id}-p${k})`,
  });
  let x = 4;
  chart.parts.forEach((name, k) => {
    part(k, x, 5, 12, 9);
    drawing.text([x + 17, 13.5], "t", name);
    x += widthOf(name) + 36;
  });
  const top = 24;
  const bottom = groups.reduce((all, group) => all + LINE + 7 + LINE * group.bars.length, top);
  drawing.axisBelow(scale, chart.axis.label, [top, bottom]);
  let y = top;
  for (const group of groups) {
    drawing.text([4, y + 12], "b", fitted(group.title, WIDTH - 20));
    y += LINE + 2;
    for (const bar of group.bars) {
      drawing.text([left - 8, y + 11.3], "e", fitted(bar.label, WIDEST_NAME));
      let from = left, all = 0;
      bar.parts.forEach((length, k) => {
        all += length;
        const to = scale.clamped(all);
        if (to > from) part(k, from, y + 2.5, to - from, LINE - 5);
        if (!bar.failed) {
          drawing.value([(from + to) / 2, y + LINE / 2],
            `${group.title}, ${bar.label}: ${chart.parts[k]} ${significant(100 * length / sum(bar))} % of ${bar.note}`);
        }
        from = to;
      });
      drawing.text([from + 5, y + 11.3], bar.failed ? "f" : "t", fitted(bar.note, WIDTH - from - 5));
      y += LINE;
    }
    y += 5;
  }
  return bottom + 34;
}

/** Draws lines over two axes; returns the height. */
function drawLines(drawing, chart, shown) {
  const series = chart.series.filter(s => shown.algorithm(s.algorithm)).map(s => ({
    ...s, points: s.points.filter(p => !p.model || shown.model(p.model)),
  })).filter(s => s.points.length);
  if (!series.length) return nothing(drawing);
  const top = 24 + drawing.legend([4, 2], WIDTH - 8, series.map(s => [s.style, s.hollow, s.name]));
  const bottom = top + FIELD;
  const points = series.flatMap(s => s.points);
  const x = new Scale(chart.x, points.map(p => p.x), [52, WIDTH - 14]);
  const ys = points.flatMap(p => limits(p.value));
  const y = new Scale(chart.y, chart.reference === null ? ys : [...ys, chart.reference], [bottom, top]);
  const [from, to] = x.ends;
  drawing.text([4, top - 9], "t", fitted(chart.y.label, WIDTH - 8));
  drawing.ticks(y, place => [[from, place], [to, place]], "e", place => [46, place + 3.8]);
  drawing.line("axis", [from, top], [from, bottom]);
  const one = chart.reference === null ? null : y.place(chart.reference);
  if (one !== null) drawing.line("one", [from, one], [to, one]);
  drawing.axisBelow(x, chart.x.label, [top, bottom]);
  if (chart.front) drawFronts(drawing, points, x, y, top);
  for (const s of series) drawSeries(drawing, chart, s, x, y);
  return bottom + 34;
}

/** Draws the Pareto front of each model: the points that no other one beats on both axes. */
function drawFronts(drawing, points, x, y, top) {
  const models = [...new Set(points.map(p => p.model))], names = [];
  for (const model of models) {
    let least = Infinity;
    const corners = [];
    const own = points.filter(p => p.model === model)
      .sort((a, b) => a.x - b.x || a.value.value - b.value.value);
    for (const { x: at, value: { value } } of own) {
      if (value >= least) continue;
      const place = x.clamped(at);
      corners.push([place, corners.length ? y.clamped(least) : top], [place, y.clamped(value)]);
      least = value;
    }
    if (!corners.length) continue;
    corners.push([x.ends[1], y.clamped(least)]);
    drawing.add("polyline", { class: "front", points: corners.map(at => at.join()).join(" ") });
    if (models.length < 2) continue;
    const name = fitted(model, WIDTH / 3), width = widthOf(name);
    const left = Math.min(corners[0][0] + 4, WIDTH - 14 - width);
    let line = top + 11;
    const meets = other => other.line === line && left < other.to + 4 && left + width + 4 > other.from;
    while (names.some(meets)) line += LINE;
    names.push({ from: left, to: left + width, line });
    drawing.text([left, line], "q", name);
  }
}

function drawSeries(drawing, chart, series, x, y) {
  const kind = styleClass(series.style);
  const places = series.points.map(point => [[x.place(point.x), y.place(point.value.value)], point])
    .filter(([[px, py]]) => px !== null && py !== null);
  if (series.fit) {
    const { exponent, factor, ends } = series.fit;
    drawing.line("fit " + kind, ...ends.map(at => [x.clamped(at), y.clamped(factor * at ** exponent)]));
  }
  if (series.joined && places.length > 1) {
    drawing.add("polyline", { class: "curve " + kind, points: places.map(([at]) => at.join()).join(" ") });
  }
  const every = series.joined ? Math.max(1, Math.ceil(places.length / MOST_MARKERS)) : 1;
  places.forEach(([at, point], i) => {
    const { deviation, value } = point;
    if (deviation && i % every === 0) {
      drawing.whisker(series.style, ...[-deviation, deviation].map(d => [x.clamped(point.x + d), at[1]]));
    }
    if (value.interval) drawing.whisker(series.style, ...value.interval.map(end => [at[0], y.clamped(end)]));
    if (i % every === 0) drawing.marker(series.style, series.hollow, at);
    const name = point.model ? `${point.model}, ${series.name}` : series.name;
    const slope = series.fit ? `; grows with the power ${series.fit.exponent.toFixed(2)}` : "";
    const width = deviation ? `, deviation ${significant(deviation)}` : "";
    drawing.value(at, `${spoken(name, value)} at ${chart.x.label} ${significant(point.x)}${width}${slope}`);
  });
}

function nothing(drawing) {
  drawing.text([WIDTH / 2, 24], "m", "Nothing selected is in this chart.");
  return 40;
}

const DRAW = { dots: drawDots, bars: drawBars, lines: drawLines };

/** A chart of the page, which can be drawn anew and read. */
class LiveChart {
  constructor(figure, chart) {
    this.chart = chart;
    this.svg = figure.querySelector("svg");
    this.id = figure.id;
    this.at = -1;
    // A name instead of a title, which browsers show on hover, over the values.
    const title = this.svg.querySelector("title");
    this.svg.setAttribute("aria-label", `${title.textContent}. Arrow keys read its values.`);
    this.svg.removeAttribute("aria-labelledby");
    this.svg.setAttribute("aria-describedby", `${this.id}-desc`);
    this.svg.setAttribute("role", "application");
    this.svg.setAttribute("aria-roledescription", "chart");
    this.svg.setAttribute("tabindex", "0");
    title.remove();
    this.svg.addEventListener("pointermove", event => this.point(event));
    this.svg.addEventListener("pointerdown", event => this.point(event));
    this.svg.addEventListener("pointerleave", () => this.leave());
    this.svg.addEventListener("blur", () => this.leave());
    this.svg.addEventListener("keydown", event => this.key(event));
  }

  draw(shown) {
    const drawing = new Drawing(this.id);
    const height = DRAW[this.chart.kind](drawing, this.chart, shown);
    for (const node of [...this.svg.children]) {
      if (node.localName !== "desc" && node.localName !== "defs") node.remove();
    }
    this.svg.setAttribute("viewBox", `0 0 ${WIDTH} ${height}`);
    this.ring = make("svg:circle", { class: "ring", r: 7, visibility: "hidden" });
    this.svg.append(...drawing.nodes, this.ring);
    // In reading order: from top to bottom, from left to right.
    this.values = drawing.values.sort((a, b) => Math.round(a.y - b.y) || a.x - b.x);
    this.at = -1;
  }

  /** Shows the value nearest to the pointer, if one is near. */
  point(event) {
    const box = this.svg.getBoundingClientRect(), unit = WIDTH / box.width;
    const x = (event.clientX - box.left) * unit, y = (event.clientY - box.top) * unit;
    let best = -1, least = event.pointerType === "touch" ? 30 : 16;
    this.values.forEach((value, i) => {
      const far = Math.hypot(value.x - x, value.y - y);
      if (far < least) [best, least] = [i, far];
    });
    if (best < 0) this.leave();
    else this.show(best);
  }

  key(event) {
    const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
    const count = this.values.length;
    let next = null;
    if (event.key in steps) next = (this.at + steps[event.key] + count) % count;
    else if (event.key === "Home") next = 0;
    else if (event.key === "End") next = count - 1;
    else if (event.key === "Escape") this.leave();
    if (next === null || !count) return;
    event.preventDefault();
    this.show(this.at < 0 && steps[event.key] === -1 ? count - 1 : next);
    tip.announce(this.values[this.at].text);
  }

  show(i) {
    this.at = i;
    const { x, y, text } = this.values[i];
    this.ring.setAttribute("cx", x);
    this.ring.setAttribute("cy", y);
    this.ring.setAttribute("visibility", "visible");
    tip.show(text, () => {
      const box = this.svg.getBoundingClientRect(), unit = box.width / WIDTH;
      return [box.left + x * unit, box.top + y * unit];
    });
  }

  leave() {
    this.at = -1;
    this.ring.setAttribute("visibility", "hidden");
    tip.hide();
  }
}

/** The value beside the pointer or the marker; one for the whole page. */
const tip = {
  box: make("div", { class: "tip", hidden: "" }),
  voice: make("div", { class: "voice", role: "status" }),

  /** Shows a text beside a place in the window, which is asked for again when the page scrolls. */
  show(text, place) {
    this.box.textContent = text;
    this.box.hidden = false;
    this.place = place;
    this.move();
  },

  move() {
    if (this.box.hidden) return;
    const [x, y] = this.place();
    const { width, height } = this.box.getBoundingClientRect();
    const most = document.documentElement.clientWidth - width - 4;
    this.box.style.left = `${Math.max(4, Math.min(x + 12, most))}px`;
    this.box.style.top = `${y - height - 12 < 0 ? y + 14 : y - height - 12}px`;
  },

  announce(text) { this.voice.textContent = text; },

  hide() { this.box.hidden = true; },
};
