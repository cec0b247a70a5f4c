"""Drives a browser over one page; see check-report, which calls this."""

import base64
import json
import os
import sys
import time
import urllib.error
import urllib.parse
import urllib.request

SERVER, PAGE, WORK, BROWSER, PICTURES = sys.argv[1:6]

# Elements that overflow the page to the right, unless they are in a scrolling container.
OVERFLOWING = """
const wide = document.documentElement.clientWidth;
const scrolls = e => { for (; e; e = e.parentElement) if (e.classList.contains('scroll') || e.localName === 'pre') return true; return false; };
return {
    page: [document.documentElement.scrollWidth, wide],
    out: [...document.body.querySelectorAll('*')]
        .filter(e => !scrolls(e) && !e.closest('svg') && !e.closest('.voice') && e.checkVisibility()
            && e.getBoundingClientRect().right > wide + 0.5)
        .map(e => e.tagName + '#' + e.id + ': ' + e.textContent.trim().slice(0, 40)).slice(0, 5),
    text: [...document.querySelectorAll('svg.chart')]
        .flatMap(svg => { const box = svg.viewBox.baseVal; return [...svg.querySelectorAll('text')]
            .filter(t => { const b = t.getBBox(); return b.x < -1 || b.x + b.width > box.width + 1; })
            .map(t => svg.closest('figure').id + ': ' + t.textContent); }).slice(0, 5),
    small: [...document.querySelectorAll('svg.chart')].filter(svg => svg.checkVisibility())
        .map(svg => [svg, Math.min(...[...svg.querySelectorAll('text')].map(t => parseFloat(getComputedStyle(t).fontSize)))
            * svg.getBoundingClientRect().width / svg.viewBox.baseVal.width])
        .filter(([svg, size]) => size < 11.9)
        .map(([svg, size]) => svg.closest('figure').id + ': ' + size.toFixed(1) + ' px').slice(0, 5),
    dark: matchMedia('(prefers-color-scheme: dark)').matches,
    paper: getComputedStyle(document.body).backgroundColor,
    loaded: performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:')),
    height: document.documentElement.scrollHeight,
};
"""

# Columns that cannot be scrolled into view as a whole beside the first column, which is fixed.
# Tables of up to six columns (nine on a desktop) must not scroll.
CUT_OFF = """
const problems = [];
for (const table of document.querySelectorAll('main table')) {
    const box = table.closest('.scroll');
    if (!box) { problems.push(table.id + ' has no element that scrolls'); continue; }
    const heads = [...table.tHead.rows[table.tHead.rows.length - 1].cells].filter(c => !c.hidden);
    const wide = box.scrollWidth > box.clientWidth + 1;
    if (wide && innerWidth >= 768 && heads.length <= (innerWidth >= 1200 ? 9 : 6)) problems.push(table.id + ' is wider than the page');
    const first = table.querySelector('tbody th[scope=row]');
    if (wide && getComputedStyle(first).position !== 'sticky') problems.push(table.id + ': the first column goes away');
    for (const head of heads.slice(1)) {
        const left = box.getBoundingClientRect().left;
        const stays = first.getBoundingClientRect().width;
        box.scrollLeft += head.getBoundingClientRect().left - left - stays;
        const at = head.getBoundingClientRect(), room = box.getBoundingClientRect();
        if (at.left < room.left + stays - 2 || at.right > room.right + 2) {
            problems.push(table.id + ': cut off: ' + head.textContent);
        }
        if (head.scrollWidth > head.clientWidth + 1) problems.push(table.id + ': text cut off: ' + head.textContent);
    }
    box.scrollLeft = 0;
}
return problems;
"""

# The headline and the first rows of the matrix are on the first screen.
FIRST_SCREEN = """
const late = [];
const headline = document.querySelector('.headline'), matrix = document.querySelector('table[data-columns=algorithm]');
for (const [what, node] of [['headline', headline], ['matrix', matrix?.tBodies[0].rows[0]]]) {
    const box = node?.getBoundingClientRect();
    if (!box || box.bottom > Math.min(innerHeight, 844)) late.push(`${what} ends at ${box?.bottom} px`);
}
return late;
"""

# Effects of clicks on tables and charts: sorting, filters, hidden columns.
EXPLORED = """
const problems = [];
const expect = (what, ok) => { if (!ok) problems.push(what); };
const table = document.querySelector('table[data-rows=algorithm]');
expect('there is a table of algorithms', table);
if (!table) return problems;
const rows = () => [...table.tBodies[0].rows].filter(r => !r.classList.contains('part') && !r.hidden);
const names = () => rows().map(r => r.cells[0].textContent);
const number = row => parseFloat(row.cells[1].textContent.replace(/^~/, '').replace(/,/g, ''));
const before = names().join();
const sort = table.tHead.querySelectorAll('button.sort')[1];
expect('the head of a column is a button', sort);
sort.click();
let values = rows().map(number).filter(v => !isNaN(v));
expect('a click sorts upwards: ' + values, values.every((v, i) => !i || values[i - 1] <= v));
expect('aria-sort says so', sort.closest('th').getAttribute('aria-sort') === 'ascending');
sort.click();
values = rows().map(number).filter(v => !isNaN(v));
expect('the next click sorts downwards: ' + values, values.every((v, i) => !i || values[i - 1] >= v));
sort.click();
expect('the third click undoes it', names().join() === before);

const menus = [...document.querySelectorAll('.filters details')];
const box = (menu, name) => [...menu.querySelectorAll('input')].find(i => i.value === name);
const charts = () => [...document.querySelectorAll('figure svg.chart text')].filter(t => !t.closest('[hidden]'))
    .map(t => t.textContent).join(' ');
const algorithms = menus.find(m => m.textContent.startsWith('Algorithms'));
expect('algorithms can be filtered', algorithms);
if (algorithms) {
    const name = names()[0], all = charts().split(name).length;
    box(algorithms, name).click();
    expect('the table follows the filter of algorithms', !names().includes(name));
    expect('charts follow the filter of algorithms', charts().split(name).length < all);
    const matrix = document.querySelector('table[data-columns=algorithm]');
    const column = [...matrix.tHead.rows[0].cells].findIndex(cell => nameIn(cell) === name);
    expect('the matrix follows the filter of algorithms', column > 0 && [...matrix.rows].every(r => r.cells[column].hidden));
    const said = [...document.querySelectorAll('.headline')].filter(p => p.checkVisibility());
    const remark = [...document.querySelectorAll('.headlines .hint')].some(p => p.checkVisibility() && p.textContent.startsWith('No sentence'));
    expect('the headline follows the filter', (said.length || remark) && said.every(p => ![p.dataset.faster, p.dataset.slower].includes(name)));
    expect('the address keeps the filter', new URLSearchParams(location.hash.slice(1)).get('hidden-algorithm') === name);
    const hidden = hiddenByAddress();
    expect('the address is read', hidden.algorithm.has(name) && hidden.algorithm.size === 1 && !hidden.model.size);
    box(algorithms, name).click();
    expect('everything comes back', names().join() === before && charts().split(name).length === all);
}
const models = menus.find(m => m.textContent.startsWith('Models'));
if (models) {
    const name = table.tBodies[0].querySelector('.of').textContent;
    const drawn = () => [...document.querySelectorAll('svg.chart .b')].filter(t => t.textContent === name && !t.closest('[hidden]')).length;
    const all = drawn();
    box(models, name).click();
    expect('the table follows the filter of models', table.tBodies[0].hidden);
    expect('charts follow the filter of models', all > 0 && drawn() === 0);
    [...models.querySelectorAll('button')][1].click();
    // The papers' values and the picture stay.
    expect('without models there are no charts',
        [...document.querySelectorAll('figure')].every(f => f.hidden || f.id.includes('-paper-') || f.querySelector('image')));
    [...models.querySelectorAll('button')][0].click();
    expect('all models come back', !table.tBodies[0].hidden && drawn() === all);
}
const columns = table.closest('section').querySelector('details.menu');
expect('columns can be hidden', columns);
if (columns) {
    const head = table.tHead.rows[0].cells[2];
    columns.querySelectorAll('input')[1].click();
    expect('a hidden column is gone', head.getBoundingClientRect().width === 0
        && rows().every(r => r.cells[2].getBoundingClientRect().width === 0));
    columns.querySelectorAll('input')[1].click();
    expect('a hidden column comes back', head.getBoundingClientRect().width > 0);
}
return problems;
"""

# Values on hover, markers inside the axes, ticks. Returns the next steps for a real pointer.
CHARTS = """
const problems = [];
for (const svg of document.querySelectorAll('figure svg.chart[role=application]')) {
    const id = svg.closest('figure').id;
    const axis = [...svg.querySelectorAll('line.axis')].map(l => l.getBBox());
    if (!axis.length) { problems.push(id + ': no axis'); continue; }
    const left = Math.min(...axis.map(b => b.x)) - 1, right = Math.max(...axis.map(b => b.x + b.width)) + 1;
    const bottom = Math.max(...axis.map(b => b.y + b.height)) + 1;
    const top = axis.length > 1 ? Math.min(...axis.map(b => b.y)) : 0;
    const names = [...svg.querySelectorAll('text.t')].map(t => t.getBBox().y);
    for (const mark of svg.querySelectorAll('.mark, .open')) {
        const svgBox = svg.getBoundingClientRect(), unit = svg.viewBox.baseVal.width / svgBox.width;
        const b = mark.getBoundingClientRect();
        const x = (b.left - svgBox.left) * unit, y = (b.top - svgBox.top) * unit;
        const legend = names.some(n => Math.abs(n - y) < 8);
        if (legend) continue;
        if (x < left || x + b.width * unit > right || y + b.height * unit > bottom || y < top - 1) {
            problems.push(id + ': a marker outside of the axes at ' + x.toFixed(1) + ', ' + y.toFixed(1));
            break;
        }
    }
    if (svg.querySelectorAll('text.m').length < 2) problems.push(id + ': fewer than two ticks');
}
const svg = [...document.querySelectorAll('figure svg.chart[role=application]')].find(s => s.querySelector('.mark'));
if (!svg) return { problems: [...problems, 'no chart'] };
svg.scrollIntoView({ block: 'center', behavior: 'instant' });
const marks = [...svg.querySelectorAll('.mark')], b = marks[marks.length - 1].getBoundingClientRect();
return { problems, at: [Math.round(b.x + b.width / 2), Math.round(b.y + b.height / 2)] };
"""

TIP = """
const tip = document.querySelector('.tip'), b = tip.getBoundingClientRect();
return { shown: !tip.hidden, text: tip.textContent, inside: b.left >= 0 && b.right <= innerWidth };
"""

# The accessible name of each focusable element and each image.
NAMES = """
const problems = [];
const name = e => {
    const by = e.getAttribute('aria-labelledby');
    if (by) return by.split(' ').map(id => document.getElementById(id)?.textContent ?? '').join(' ').trim();
    if (e.getAttribute('aria-label')) return e.getAttribute('aria-label');
    if (e.labels && e.labels.length) return e.labels[0].textContent.trim();
    return e.textContent.trim();
};
for (const e of document.querySelectorAll('a, button, select, input, summary, [tabindex], [role], canvas, svg, table')) {
    if (e.closest('svg') && e.localName !== 'svg') continue;
    if (e.getAttribute('role') === 'status') continue;
    if (!name(e)) problems.push('no name: ' + e.outerHTML.slice(0, 100));
}
const ids = [...document.querySelectorAll('[id]')].map(e => e.id);
for (const id of ids) if (ids.indexOf(id) !== ids.lastIndexOf(id)) problems.push('id stands there twice: ' + id);
for (const e of document.querySelectorAll('[aria-labelledby], [aria-describedby]')) {
    for (const key of ['aria-labelledby', 'aria-describedby']) {
        for (const id of (e.getAttribute(key) ?? '').split(' ').filter(Boolean)) {
            if (!document.getElementById(id)) problems.push('no element ' + id);
        }
    }
}
return problems;
"""

# The elements that the keyboard reaches, by kind.
FOCUS = """
const e = document.activeElement;
return e === document.body ? '' : e.className && e.localName === 'button' ? 'button.' + e.className
    : e.localName === 'div' ? 'div.' + e.className : e.localName === 'svg' ? 'svg' : e.localName;
"""

KEYS = {"Tab": 9, "ArrowRight": 39, "ArrowLeft": 37, "Enter": 13, "Escape": 27, "Home": 36}


def call(method, path, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(SERVER + path, data, {"Content-Type": "application/json"}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=600) as answer:
            return json.load(answer)["value"]
    except urllib.error.HTTPError as error:
        sys.exit(f"check-report: {path}: {error.read().decode()[:500]}")


def wait_for_driver():
    for _ in range(600):
        try:
            urllib.request.urlopen(SERVER + "/status", timeout=5)
            return
        except OSError:
            time.sleep(0.1)
    sys.exit("check-report: chromedriver does not answer")


def session(name):
    arguments = [
        "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
        "--disable-background-networking", "--disable-component-update", "--disable-sync",
        f"--user-data-dir={os.path.join(WORK, name)}",
    ]
    wanted = {
        "browserName": "chrome",
        "goog:chromeOptions": {"args": arguments, "binary": BROWSER},
        "goog:loggingPrefs": {"browser": "ALL", "performance": "ALL"},
    }
    return call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]


class Browser:
    """One window of the browser."""

    def __init__(self):
        self.base = "/session/" + session("profile")
        self.problems = []
        self.where = ""

    def devtools(self, command, **parameters):
        return call("POST", self.base + "/goog/cdp/execute", {"cmd": command, "params": parameters})

    def run(self, script):
        return call("POST", self.base + "/execute/sync", {"script": script, "args": []})

    def open(self, width, scheme, medium="", page=PAGE):
        self.where = f"{width}-{scheme}" + (f"-{medium}" if medium else "")
        if page != PAGE:
            self.where = f"{page.rsplit('/', 1)[-1].removesuffix('.html')}-{self.where}"
        self.devtools("Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1,
                      mobile=width < 600)
        self.devtools("Emulation.setEmulatedMedia", media=medium,
                      features=[{"name": "prefers-color-scheme", "value": scheme}])
        call("POST", self.base + "/url", {"url": page})
        self.height = self.run("return document.documentElement.scrollHeight;")
        self.run("document.querySelectorAll('details.more').forEach(d => { d.open = true; });")

    def wrong(self, *what):
        self.problems += [f"{self.where}: {one}" for one in what]

    def expect(self, what, ok):
        if not ok:
            self.wrong(what)

    def wait(self, what, happens):
        """Asks until it happens, for at most a minute."""
        for _ in range(600):
            if happens():
                return
            time.sleep(0.1)
        self.wrong(what)

    def press(self, key):
        for kind in ("keyDown", "keyUp"):
            text = {"text": "\r"} if key == "Enter" and kind == "keyDown" else {}
            self.devtools("Input.dispatchKeyEvent", type=kind, key=key, code=key,
                          windowsVirtualKeyCode=KEYS[key], **text)

    def pointer(self, kind, at, button="none"):
        self.devtools("Input.dispatchMouseEvent", type=kind, x=at[0], y=at[1], button=button,
                      buttons=0 if button == "none" else 1, clickCount=1 if button == "left" else 0)

    def picture(self):
        if not PICTURES:
            return
        os.makedirs(PICTURES, exist_ok=True)
        width, height = self.run("return [innerWidth, document.documentElement.scrollHeight];")
        shot = self.devtools("Page.captureScreenshot", captureBeyondViewport=True,
                             clip={"x": 0, "y": 0, "width": width, "height": min(height, 14000), "scale": 1})
        with open(os.path.join(PICTURES, self.where + ".png"), "wb") as file:
            file.write(base64.b64decode(shot["data"]))


def check_layout(browser, scheme):
    seen = browser.run(OVERFLOWING)
    scrolls, wide = seen["page"]
    browser.expect(f"the page is {scrolls} px wide in a window of {wide} px", scrolls <= wide)
    browser.wrong(*(f"sticks out: {what}" for what in seen["out"]))
    browser.wrong(*(f"text outside of its chart: {what}" for what in seen["text"]))
    browser.wrong(*(f"text below 12 px: {what}" for what in seen["small"]))
    browser.wrong(*(f"the page loads {what}" for what in seen["loaded"]))
    # The background must be light or dark as the colour scheme requires.
    red = int(seen["paper"].split("(")[1].split(",")[0])
    dark = scheme == "dark"
    browser.expect(f"the ground is {seen['paper']}", seen["dark"] == dark and (red < 128) == dark)
    browser.wrong(*(f"not on the first screen: {what}" for what in browser.run(FIRST_SCREEN)))
    browser.wrong(*browser.run(CUT_OFF))
    # Menus must also stay in the window.
    for number in range(browser.run("return document.querySelectorAll('details.menu').length;")):
        browser.run(f"document.querySelectorAll('details.menu')[{number}].open = true;")
        browser.wrong(*(f"a menu sticks out: {what}" for what in browser.run(OVERFLOWING)["out"]))
        browser.run(f"document.querySelectorAll('details.menu')[{number}].open = false;")


def check_values(browser):
    found = browser.run(CHARTS)
    browser.wrong(*found["problems"])
    if "at" not in found:
        return
    tip = {}

    # Scrolling, which may not have ended yet, hides the tooltip.
    def is_shown():
        browser.pointer("mouseMoved", [2, 2])
        browser.pointer("mouseMoved", found["at"])
        tip.update(browser.run(TIP))
        return tip["shown"]

    browser.wait("no value is shown on hover", is_shown)
    browser.expect(f"a value is shown on hover, not {tip}", ": " in tip["text"] and tip["inside"])
    browser.pointer("mouseMoved", [2, 2])
    browser.expect("the value goes away", not browser.run(TIP)["shown"])
    browser.devtools("Input.dispatchTouchEvent", type="touchStart",
                     touchPoints=[{"x": found["at"][0], "y": found["at"][1]}])
    browser.devtools("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    browser.run("document.activeElement.blur(); scrollTo({ top: 0, behavior: 'instant' });")


def check_keyboard(browser):
    """Everything can be reached with Tab, and charts are read with arrows."""
    # Focus starts at the top of the page.
    browser.open(1440, "light")
    reached = {}
    for _ in range(2500):
        browser.press("Tab")
        kind = browser.run(FOCUS)
        if not kind:
            break
        reached[kind] = reached.get(kind, 0) + 1
        if kind == "svg" and reached[kind] == 1:
            browser.press("ArrowRight")
            first = browser.run(TIP)
            browser.press("ArrowRight")
            second = browser.run(TIP)
            browser.expect("arrow keys read values", first["shown"] and second["shown"])
            spoken = browser.run("return document.querySelector('.voice[role=status]').textContent;")
            browser.expect("a screen reader hears the value", spoken == second["text"])
            browser.press("Escape")
            browser.expect("Escape hides the value", not browser.run(TIP)["shown"])
        if kind == "button.sort" and reached[kind] == 1:
            browser.press("Enter")
            browser.expect("Enter sorts", browser.run("return !!document.querySelector('[aria-sort=ascending]');"))
    counts = browser.run("""return {
        svg: document.querySelectorAll('svg[tabindex]').length,
        'button.sort': document.querySelectorAll('button.sort').length,
        summary: document.querySelectorAll('summary').length,
    };""")
    for kind, count in counts.items():
        browser.expect(f"the keyboard reaches {reached.get(kind, 0)} of {count} {kind}",
                       reached.get(kind, 0) >= count)


def check_console(browser):
    for entry in call("POST", browser.base + "/se/log", {"type": "browser"}):
        browser.wrong(f"console: {entry['message']}")
    for entry in call("POST", browser.base + "/se/log", {"type": "performance"}):
        message = json.loads(entry["message"])["message"]
        if message["method"] == "Network.requestWillBeSent":
            url = message["params"]["request"]["url"]
            allowed = ("file:", "data:", "blob:", "chrome:", "about:")
            browser.expect(f"the network is asked for {url}", url.startswith(allowed))


# Addresses of links, with those within the page that lead to nothing.
LINKS = """
const links = [...document.querySelectorAll('a[href]')].map(a => a.getAttribute('href'));
return { links, lost: links.filter(l => l.startsWith('#') && !document.getElementById(l.slice(1))),
    title: document.title, headings: document.querySelectorAll('h1').length };
"""


def check_site(browser, directory):
    """Every page of a site at three widths: layout, names, links, titles, and the keyboard."""
    pages, titles = sorted(name for name in os.listdir(directory) if name.endswith(".html")), {}
    for page in pages:
        size = os.path.getsize(os.path.join(directory, page))
        browser.where = page
        browser.expect(f"it has {size} bytes", size < 500_000)
        for width in (360, 768, 1440):
            browser.open(width, "light", page=f"{PAGE}/{page}")
            seen = browser.run(OVERFLOWING)
            browser.expect(f"the page is {seen['page'][0]} px wide", seen["page"][0] <= seen["page"][1])
            browser.wrong(*(f"sticks out: {what}" for what in seen["out"] + seen["text"] + seen["small"]))
            browser.wrong(*browser.run(CUT_OFF))
            check_console(browser)
            if width == 768 and page != "index.html":
                continue
            browser.picture()
        browser.wrong(*browser.run(NAMES))
        found = browser.run(LINKS)
        browser.expect(f"the title is that of {titles.get(found['title'])}", found["title"] not in titles)
        browser.expect("the page has one heading", found["title"] and found["headings"] == 1)
        titles[found["title"]] = page
        browser.wrong(*(f"leads nowhere: {link}" for link in found["lost"]))
        for link in set(found["links"]):
            path = os.path.join(directory, link.split("#")[0])
            local = not link.startswith(("#", "https:", "data:"))
            browser.expect(f"leads nowhere: {link}", not local or os.path.isfile(path))
    browser.open(1440, "light", page=f"{PAGE}/index.html")
    reached = 0
    for _ in range(500):
        browser.press("Tab")
        kind = browser.run(FOCUS)
        if not kind:
            break
        reached += kind == "a"
    links = browser.run("return document.querySelectorAll('a[href]').length;")
    browser.expect(f"the keyboard reaches {reached} of {links} links", reached == links)
    return f"{len(pages)} pages at 360, 768 and 1440 px: nothing cut off, no errors, no requests; links, titles, names and keyboard work"


def finish(browser, done):
    call("DELETE", browser.base)
    for problem in browser.problems:
        print("check-report: " + problem, file=sys.stderr)
    if browser.problems:
        sys.exit(1)
    print("check-report: " + done)


def main():
    wait_for_driver()
    browser = Browser()
    directory = urllib.parse.unquote(PAGE.removeprefix("file://"))
    if os.path.isdir(directory):
        finish(browser, check_site(browser, directory))
        return
    for width in (360, 768, 1440):
        for scheme in ("light", "dark"):
            browser.open(width, scheme)
            check_layout(browser, scheme)
            browser.picture()
            if scheme == "light":
                browser.wrong(*browser.run(NAMES))
                browser.wrong(*browser.run(EXPLORED))
                check_values(browser)
                if width == 1440:
                    check_keyboard(browser)
            check_console(browser)
    browser.open(1000, "light", "print")
    seen = browser.run(OVERFLOWING)
    browser.wrong(*(f"sticks out: {what}" for what in seen["out"]))
    browser.wrong(*(f"cut off in print: {what}" for what in browser.run(
        "return [...document.querySelectorAll('.scroll')].filter(e => e.scrollHeight > e.clientHeight + 2)"
        ".map(e => e.querySelector('table').id);")))
    browser.expect("controls are not printed", browser.run(
        "return [...document.querySelectorAll('nav, .filters, .menu')]"
        ".every(e => getComputedStyle(e).display === 'none');"))
    browser.picture()
    # The content must also be there without scripts.
    browser.devtools("Emulation.setScriptExecutionDisabled", value=True)
    browser.open(360, "light", "")
    browser.where = "without scripts"
    browser.devtools("Emulation.setScriptExecutionDisabled", value=False)
    seen = browser.run(OVERFLOWING)
    browser.wrong(*(f"sticks out: {what}" for what in seen["out"]))
    browser.wrong(*browser.run(CUT_OFF))
    browser.expect("charts are drawn without scripts", browser.run(
        "return !document.querySelector('.filters') && [...document.querySelectorAll('svg.chart')]"
        ".every(svg => svg.querySelectorAll('text, image').length > 0);"))
    browser.picture()
    browser.open(1440, "light")
    finish(browser, f"{browser.height} px long at 1440; 360, 768 and 1440 px, light, dark, print and without scripts: nothing cut off, "
           "no errors, no requests; sorting, filters, values, keyboard and names work")


main()
