// Brings a report to life: filters by model and algorithm, which tables and charts follow.

/** The sentences about the fastest algorithms, which follow the selection of algorithms. */
class LiveHeadline {
  constructor(box) {
    this.ranking = JSON.parse(box.dataset.ranking);
    this.base = box.dataset.base;
    this.sentences = [...box.querySelectorAll(".headline")];
    this.initial = this.sentences.filter(sentence => !sentence.hidden);
    this.remark = make("p", { class: "hint", hidden: "" });
    box.append(this.remark);
  }

  /** Compares the fastest one that is shown with the next, and with an outside program or the base. */
  draw(shown, allModels) {
    const ranking = this.ranking.filter(shown.algorithm), [best, next] = ranking;
    const outside = name => name.startsWith("ext:");
    const rival = ranking.find(name => best && outside(name) !== outside(best))
      ?? ranking.find(name => name === this.base);
    const whole = ranking.length === this.ranking.length;
    for (const sentence of this.sentences) {
      const { faster, slower, next: ofNext } = sentence.dataset;
      const is = ofNext === "true" ? slower === next : slower === rival && rival !== next;
      sentence.hidden = !(whole ? this.initial.includes(sentence) : faster === best && is);
    }
    // A page of many algorithms does not have the sentences of all pairs.
    const isSilent = this.sentences.every(sentence => sentence.hidden);
    this.remark.textContent = isSilent ? "No sentence compares these algorithms." : "The sentence is about all models.";
    this.remark.hidden = allModels && !isSilent;
  }
}

/** The names that the address hides, such as `#hidden-model=spot&hidden-algorithm=mmp`. */
function hiddenByAddress() {
  const words = new URLSearchParams(window.location.hash.slice(1));
  const of = kind => new Set(words.getAll(`hidden-${kind}`));
  return { model: of("model"), algorithm: of("algorithm") };
}

/** Changes the address, so that a bookmark or a link shows the same selection. */
function keepInAddress(hidden) {
  const words = new URLSearchParams();
  for (const [kind, names] of Object.entries(hidden)) {
    for (const name of names) words.append(`hidden-${kind}`, name);
  }
  window.history.replaceState(null, "", `#${words}`);
}

function explore() {
  document.body.append(tip.box, tip.voice);
  const tables = [...document.querySelectorAll("main table")].map(table => new LiveTable(table));
  const charts = [...document.querySelectorAll("figure svg.chart")].map(svg => new LiveChart(svg));
  const names = kind => [...new Set(tables.filter(table => table.rowsAre === kind)
    .flatMap(table => table.bodies).flatMap(({ rows }) => rows).map(nameOf))];
  const models = names("model"), algorithms = names("algorithm").filter(name => name !== "All");
  const hidden = hiddenByAddress();
  const shown = {
    model: name => !hidden.model.has(name),
    algorithm: name => !hidden.algorithm.has(name),
  };
  const headlines = [...document.querySelectorAll(".headlines")].map(box => new LiveHeadline(box));
  const draw = () => {
    for (const headline of headlines) headline.draw(shown, models.every(shown.model));
    for (const table of tables) table.filter(shown, models);
    for (const chart of charts) chart.filter(shown, algorithms.every(shown.algorithm));
  };
  const menu = (label, kind, all) => new Menu(label, all, names => {
    hidden[kind] = names;
    keepInAddress(hidden);
    draw();
    tip.announce(`${all.length - names.size} of ${all.length} ${label.toLowerCase()} shown`);
  }, hidden[kind]).node;
  const filters = [];
  if (models.length > 1) filters.push(menu("Models", "model", models));
  if (algorithms.length > 1) filters.push(menu("Algorithms", "algorithm", algorithms));
  if (filters.length) {
    document.querySelector("main").before(
      make("div", { class: "filters", role: "group", "aria-label": "Show" }, ...filters));
  }
  // A menu closes when something outside the menu is used.
  const close = event => {
    for (const menu of document.querySelectorAll("details.menu[open]")) {
      if (!menu.contains(event.target)) menu.open = false;
    }
  };
  document.addEventListener("pointerdown", close);
  document.addEventListener("focusin", close);
  document.addEventListener("scroll", () => tip.move(), { passive: true });
  draw();
  document.documentElement.classList.add("live");
}

explore();
