// Charts: values on hover, touch and arrow keys, and parts that can be hidden. All drawing is done in
// Rust (page/chart); the values are the titles of its markers.
"use strict";

/** An element of a page or, with the prefix `svg:`, of a drawing. */
function make(name, attributes = {}, ...children) {
  const node = name.startsWith("svg:")
    ? document.createElementNS("http://www.w3.org/2000/svg", name.slice(4))
    : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
}

const isShown = node => !node.closest("[hidden]");

/** A chart of the page. */
class LiveChart {
  constructor(svg) {
    this.svg = svg;
    this.figure = svg.closest("figure");
    this.at = -1;
    // A name instead of a title, which browsers show on hover, over the values.
    const title = svg.querySelector("title");
    const values = svg.querySelectorAll("g > title");
    this.values = [...values].map(title => ({ node: title.parentElement, text: title.textContent }));
    values.forEach(title => title.remove());
    if (!this.values.length) return;
    svg.setAttribute("aria-label", `${title.textContent}. Arrow keys read its values.`);
    svg.removeAttribute("aria-labelledby");
    svg.setAttribute("aria-describedby", svg.querySelector("desc").id);
    svg.setAttribute("role", "application");
    svg.setAttribute("aria-roledescription", "chart");
    svg.setAttribute("tabindex", "0");
    title.remove();
    this.ring = make("svg:circle", { class: "ring", r: 7, visibility: "hidden" });
    svg.append(this.ring);
    svg.addEventListener("pointermove", event => this.point(event));
    svg.addEventListener("pointerdown", event => this.point(event));
    svg.addEventListener("pointerleave", () => this.leave());
    svg.addEventListener("blur", () => this.leave());
    svg.addEventListener("keydown", event => this.key(event));
  }

  /** Hides what belongs to hidden models and algorithms; the whole chart if nothing is left. */
  filter(shown, all) {
    this.figure.hidden = false;
    for (const node of this.svg.querySelectorAll("[data-algorithm], [data-model]")) {
      const { algorithm, model } = node.dataset;
      node.toggleAttribute("hidden",
        Boolean(algorithm && !shown.algorithm(algorithm) || model && !shown.model(model)));
    }
    // Pareto fronts are those of all algorithms.
    for (const front of this.svg.querySelectorAll(".fronts")) {
      if (!all) front.setAttribute("hidden", "");
      else if (!front.dataset.model) front.removeAttribute("hidden");
    }
    this.figure.hidden = this.values.length > 0 && !this.values.some(({ node }) => isShown(node));
    if (this.ring) this.leave();
  }

  /** The middle of a value in the window. */
  place({ node }) {
    const mark = node.querySelector(".mark, .open, rect") ?? node;
    const { left, top, width, height } = mark.getBoundingClientRect();
    return [left + width / 2, top + height / 2];
  }

  /** The values that are shown, from top to bottom, from left to right. */
  readable() {
    const placed = this.values.filter(({ node }) => isShown(node))
      .map(value => ({ ...value, at: this.place(value) }));
    return placed.sort((a, b) => Math.round(a.at[1] - b.at[1]) || a.at[0] - b.at[0]);
  }

  /** Shows the value nearest to the pointer, if one is near. */
  point(event) {
    let best = null, least = event.pointerType === "touch" ? 30 : 16;
    for (const value of this.readable()) {
      const far = Math.hypot(value.at[0] - event.clientX, value.at[1] - event.clientY);
      if (far < least) [best, least] = [value, far];
    }
    if (best) this.show(best);
    else this.leave();
  }

  key(event) {
    const steps = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };
    const values = this.readable(), count = values.length;
    let next = null;
    if (event.key in steps) next = this.at < 0 && steps[event.key] < 0 ? count - 1 : (this.at + steps[event.key] + count) % count;
    else if (event.key === "Home") next = 0;
    else if (event.key === "End") next = count - 1;
    else if (event.key === "Escape") this.leave();
    if (next === null || !count) return;
    event.preventDefault();
    this.show(values[next]);
    this.at = next;
    tip.announce(values[next].text);
  }

  show(value) {
    const box = this.svg.getBoundingClientRect(), unit = this.svg.viewBox.baseVal.width / box.width;
    this.ring.setAttribute("cx", (value.at[0] - box.left) * unit);
    this.ring.setAttribute("cy", (value.at[1] - box.top) * unit);
    this.ring.setAttribute("visibility", "visible");
    tip.show(value.text, () => this.place(value));
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
