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

# Elements that stick out of the page to the right, unless they scroll within a container of their own.
OVERFLOWING = """
const wide = document.documentElement.clientWidth;
const scrolls = e => { for (; e; e = e.parentElement) if (e.classList.contains('scroll')) return true; return false; };
return {
    page: [document.documentElement.scrollWidth, wide],
    out: [...document.body.querySelectorAll('*')]
        .filter(e => !scrolls(e) && !e.closest('svg') && e.getBoundingClientRect().right > wide + 0.5)
        .map(e => e.tagName + '#' + e.id + ': ' + e.textContent.trim().slice(0, 40)).slice(0, 5),
    text: [...document.querySelectorAll('svg.chart')]
        .flatMap(svg => { const box = svg.viewBox.baseVal; return [...svg.querySelectorAll('text')]
            .filter(t => { const b = t.getBBox(); return b.x < -1 || b.x + b.width > box.width + 1; })
            .map(t => svg.querySelector('title').textContent + ': ' + t.textContent); }).slice(0, 5),
    dark: matchMedia('(prefers-color-scheme: dark)').matches,
    paper: getComputedStyle(document.body).backgroundColor,
    loaded: performance.getEntriesByType('resource').map(e => e.name).filter(n => !n.startsWith('data:')),
    height: document.documentElement.scrollHeight,
};
"""


def call(method, path, body=None):
    data = None if body is None else json.dumps(body).encode()
    request = urllib.request.Request(SERVER + path, data, {"Content-Type": "application/json"}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=120) as answer:
            return json.load(answer)["value"]
    except urllib.error.HTTPError as error:
        sys.exit(f"check-report: {path}: {error.read().decode()[:500]}")


def wait_for_driver():
    for _ in range(100):
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
        "goog:loggingPrefs": {"browser": "ALL"},
    }
    return call("POST", "/session", {"capabilities": {"alwaysMatch": wanted}})["sessionId"]


def devtools(base, command, **parameters):
    return call("POST", base + "/goog/cdp/execute", {"cmd": command, "params": parameters})


def main():
    wait_for_driver()
    base = "/session/" + session("profile")
    problems = []
    for width in (360, 1440):
        for scheme in ("light", "dark"):
            name = f"{width}-{scheme}"
            devtools(base, "Emulation.setDeviceMetricsOverride", width=width, height=900, deviceScaleFactor=1,
                     mobile=width < 600)
            devtools(base, "Emulation.setEmulatedMedia",
                     features=[{"name": "prefers-color-scheme", "value": scheme}])
            call("POST", base + "/url", {"url": PAGE})
            seen = call("POST", base + "/execute/sync", {"script": OVERFLOWING, "args": []})
            scrolls, wide = seen["page"]
            if scrolls > wide:
                problems.append(f"{name}: the page is {scrolls} px wide in a window of {wide} px")
            problems += [f"{name}: sticks out: {what}" for what in seen["out"]]
            problems += [f"{name}: text outside of its chart: {what}" for what in seen["text"]]
            problems += [f"{name}: the page loads {what}" for what in seen["loaded"]]
            # What the scheme asks for: a light or a dark ground.
            red = int(seen["paper"].split("(")[1].split(",")[0])
            if seen["dark"] != (scheme == "dark") or (red < 128) != (scheme == "dark"):
                problems.append(f"{name}: the ground is {seen['paper']}")
            for entry in call("POST", base + "/se/log", {"type": "browser"}):
                problems.append(f"{name}: console: {entry['message']}")
            if PICTURES:
                os.makedirs(PICTURES, exist_ok=True)
                shot = devtools(base, "Page.captureScreenshot", captureBeyondViewport=True,
                                clip={"x": 0, "y": 0, "width": width, "height": min(seen["height"], 12000),
                                      "scale": 1})
                with open(os.path.join(PICTURES, name + ".png"), "wb") as file:
                    file.write(base64.b64decode(shot["data"]))
    call("DELETE", base)
    for problem in problems:
        print("check-report: " + problem, file=sys.stderr)
    if problems:
        sys.exit(1)
    print("check-report: 360 px and 1440 px, light and dark: no errors, nothing overflows")


main()
