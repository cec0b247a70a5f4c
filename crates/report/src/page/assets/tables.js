// Tables: rows sorted by a click on the head of a column, columns and rows that can be hidden.

const UNITS = { ms: 1e-3, "\u00b5s": 1e-6, ns: 1e-9 };

/**
 * The text of a cell as a number, in seconds if it has a unit of time; NaN if it does not start with
 * a number. `~` marks a wide interval.
 */
function numberOf(text) {
  if (/^\d{4}-\d\d-\d\d$/.test(text.trim())) return Date.parse(text.trim());
  const plain = text.trim().replace(/^~/, "").replace(/(\d),(?=\d{3})/g, "$1");
  return parseFloat(plain) * (UNITS[plain.match(/^[\d.]+\s(\S+)/)?.[1]] ?? 1);
}

/** The name in a head of a row or column, without its marks. */
const nameIn = head => head.textContent.replace(/([ \u00a0]\((approx\.|claimed)\))+$/, "");
const nameOf = row => nameIn(row.cells[0]);

/** A table of the page. */
class LiveTable {
  constructor(table) {
    this.table = table;
    this.rowsAre = table.dataset.rows;
    this.columnsAreAlgorithms = table.dataset.columns === "algorithm";
    this.hidden = new Set();
    this.sorted = null;
    this.bodies = [...table.tBodies].map(body => ({
      body, title: body.querySelector(".part .of")?.textContent,
      rows: [...body.rows].filter(row => !row.classList.contains("part")),
    }));
    this.heads = [...table.tHead.rows[table.tHead.rows.length - 1].cells];
    if (this.bodies.some(({ rows }) => rows.length > 1)) this.heads.forEach((head, i) => this.addSort(head, i));
    // Hiding one of several columns under a common head would make that too wide.
    if (table.tHead.rows.length === 1 && this.heads.length > 3 && !this.columnsAreAlgorithms) this.addMenu();
  }

  addSort(head, i) {
    const button = make("button", { type: "button", class: "sort" }, ...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => this.sort(i));
  }

  /** Sorts by a column: upwards, then downwards, then as it was. */
  sort(i) {
    const head = this.heads[i], was = head.getAttribute("aria-sort");
    for (const other of this.heads) other.removeAttribute("aria-sort");
    const way = was === "ascending" ? "descending" : was === "descending" ? null : "ascending";
    if (way) head.setAttribute("aria-sort", way);
    const sign = way === "descending" ? -1 : 1;
    const text = row => row.cells[i]?.textContent ?? "";
    const compare = (a, b) => {
      const [x, y] = [text(a), text(b)], [m, n] = [numberOf(x), numberOf(y)];
      // Failures and missing values come last, whatever the way.
      if (Number.isNaN(m) !== Number.isNaN(n)) return Number.isNaN(m) ? 1 : -1;
      return sign * (Number.isNaN(m) || i === 0 ? x.localeCompare(y, "en", { numeric: true }) : m - n);
    };
    for (const { body, rows } of this.bodies) body.append(...(way ? [...rows].sort(compare) : rows));
    const name = head.textContent.trim();
    tip.announce(way ? `Sorted by ${name}, ${way}` : "In the order of the run");
  }

  addMenu() {
    const heads = this.heads.slice(1);
    const menu = new Menu("Columns", heads.map(head => head.textContent), hidden => {
      this.hidden = new Set(heads.map((head, i) => hidden.has(head.textContent) ? i + 1 : 0));
      this.hidden.delete(0);
      this.showColumns();
    });
    const caption = document.getElementById(`${this.table.id}-caption`);
    caption.after(menu.node);
  }

  showColumns() {
    for (const row of this.table.rows) {
      if (row.classList.contains("part")) {
        row.cells[0].colSpan = this.heads.length - this.hidden.size;
        continue;
      }
      [...row.cells].forEach((cell, i) => { cell.hidden = this.hidden.has(i); });
    }
  }

  /** Shows the rows of the selected models and algorithms. */
  filter(shown, models) {
    if (this.columnsAreAlgorithms) {
      const names = this.heads.map(head => nameIn(head));
      this.hidden = new Set(names.flatMap((name, i) => i && !shown.algorithm(name) ? [i] : []));
      this.showColumns();
    }
    for (const { body, title, rows } of this.bodies) {
      for (const row of rows) {
        const name = nameOf(row);
        row.hidden = this.rowsAre === "algorithm" ? !shown.algorithm(name)
          : this.rowsAre === "model" ? !shown.model(name) : false;
      }
      body.hidden = models.includes(title) && !shown.model(title) || rows.every(row => row.hidden);
    }
  }
}

/** A button that opens a list of names with check boxes. */
class Menu {
  constructor(label, names, changed, hidden = new Set()) {
    this.label = label;
    this.names = names;
    this.hidden = hidden;
    this.changed = changed;
    this.summary = make("summary");
    this.boxes = names.map(name => {
      const box = make("input", { type: "checkbox", value: name });
      box.checked = !hidden.has(name);
      return box;
    });
    const all = this.button("All", () => true), none = this.button("None", () => false);
    const list = make("fieldset", {}, make("legend", { class: "voice" }, label),
      make("p", {}, all, none),
      ...names.map((name, i) => make("label", {}, this.boxes[i], make("span", {}, name))));
    list.addEventListener("change", () => this.update());
    this.node = make("details", { class: "menu" }, this.summary, list);
    this.node.addEventListener("keydown", event => {
      if (event.key !== "Escape" || !this.node.open) return;
      this.node.open = false;
      this.summary.focus();
    });
    // The list of a menu at the right end of the page moves into the page.
    this.node.addEventListener("toggle", () => {
      list.style.left = "";
      const beyond = list.getBoundingClientRect().right + 8 - document.documentElement.clientWidth;
      if (beyond > 0) list.style.left = `${parseFloat(getComputedStyle(list).left) - beyond}px`;
    });
    this.write();
  }

  button(text, checked) {
    const button = make("button", { type: "button" }, text);
    button.setAttribute("aria-label", `${this.label}: ${text.toLowerCase()}`);
    button.addEventListener("click", () => {
      for (const box of this.boxes) box.checked = checked();
      this.update();
    });
    return button;
  }

  update() {
    this.hidden = new Set(this.boxes.filter(box => !box.checked).map(box => box.value));
    this.write();
    this.changed(this.hidden);
  }

  write() {
    const shown = this.boxes.filter(box => box.checked).length, all = this.names.length;
    this.summary.textContent = shown === all ? `${this.label}: all ${all}` : `${this.label}: ${shown} of ${all}`;
  }
}
