#!/usr/bin/env python3
"""Opens the page of a run in headless Chromium and uses it.

    check_report.py DIRECTORY [--picture PNG [--dark]] [--chromium PROGRAM]

DIRECTORY is that of a run for which `stsolve report` has made report.html. Checked are: no error and no message on the
console; nothing is loaded from elsewhere; every place of the slider shows another time, its pictures have the size that was
announced, and the charts mark that time with the numbers of history.csv; every field and window can be chosen; zooming works;
every curve has points inside of its chart; every number of summary.json is in the tables. --picture keeps a picture of the
page. Exits with 1 and says what is wrong if anything is; without a Chromium it says so and exits with 0. The last line counts.
"""

import argparse
import csv
import html
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

PROGRAMS = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable",
            "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome"]

# Runs before the scripts of the page: collects their errors.
LISTEN = """<script>
window.problems = [];
addEventListener("error", (event) => problems.push(String(event.message || event.target.src || event.target)), true);
for (const kind of ["error", "warn"]) console[kind] = (...words) => problems.push(words.join(" "));
</script>"""

# Runs behind them: uses the page and writes what it has seen into an element.
USE = """<script>
addEventListener("load", async () => {
  const seen = { frames: [], choices: [], curves: [], cells: {} };
  const all = (selector) => [...document.querySelectorAll(selector)];
  const field = document.getElementById("field");
  const picture = async () => {
    await field.decode();
    return { src: field.src.length + field.src.slice(-40), alt: field.alt, size: [field.naturalWidth, field.naturalHeight] };
  };
  try {
    const slider = document.getElementById("slider");
    for (let place = 0; slider && place <= slider.max; place++) {
      slider.value = place;
      slider.dispatchEvent(new Event("input"));
      seen.frames.push({ ...(await picture()), time: document.getElementById("time").textContent,
        spoken: slider.getAttribute("aria-valuetext"),
        cursors: all(".chart > svg").map((chart) => [chart.dataset, +chart.querySelector(".cursor").getAttribute("x1")]),
        values: all("output[data-column]").map((output) => [output.dataset.column, output.textContent]) });
    }
    for (const pane of all("input[name=window]")) for (const quantity of all("input[name=quantity]")) {
      pane.click();
      quantity.click();
      seen.choices.push({ ...(await picture()), legend: document.getElementById("legend-label").textContent,
        ticks: all("#legend-ticks span").length });
    }
    if (slider) {
      const stack = document.getElementById("stack");
      const press = (key) => document.getElementById("viewer").dispatchEvent(new KeyboardEvent("keydown", { key }));
      seen.zoom = [stack.style.transform];
      for (const key of ["+", "ArrowRight", "0"]) { press(key); seen.zoom.push(stack.style.transform); }
      const lines = document.getElementById("mesh-lines");
      lines.click();
      await document.getElementById("mesh").decode();
      seen.lines = !document.getElementById("mesh").hidden;
      lines.click();
      slider.focus();
      seen.focus = document.activeElement === slider;
    }
    seen.curves = all(".chart path").filter((path) => path.closest(".chart > svg")).map((path) => {
      const [box, frame] = [path.getBBox(), path.closest("svg").viewBox.baseVal];
      return { length: path.getTotalLength(), points: (path.getAttribute("d").match(/[ML]/g) || []).length,
        box: [box.x, box.y, box.width, box.height], frame: [frame.width, frame.height] };
    });
    for (const cell of all("td[data-key]")) seen.cells[cell.dataset.key] = cell.title;
    seen.charts = all(".chart").length;
    seen.wide = document.documentElement.scrollWidth > innerWidth;
    seen.unnamed = all("button, input, img").filter((e) => !(e.getAttribute("aria-label") || e.labels?.length || e.hasAttribute("alt"))).length;
  } catch (error) { problems.push(String(error.stack || error)); }
  seen.problems = problems;
  const out = document.createElement("pre");
  out.id = "seen";
  out.textContent = JSON.stringify(seen);
  document.body.append(out);
});
</script>"""


def chromium(program, *arguments):
    """What headless Chromium prints; its private files go to a folder that is removed."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        command = [program, "--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                   "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={profile}", "--virtual-time-budget=600000",
                   "--window-size=1280,900", *arguments]
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=600).stdout


def use(program, page):
    """What the scripts above have seen of the page."""
    text = page.read_text(encoding="utf-8")
    text = text.replace("<head>", "<head>" + LISTEN, 1).replace("</body>", USE + "</body>", 1)
    with tempfile.TemporaryDirectory() as folder:
        copy = pathlib.Path(folder, "report.html")
        copy.write_text(text, encoding="utf-8")
        dom = chromium(program, "--dump-dom", copy.as_uri())
    found = re.search(r'<pre id="seen">(.*?)</pre>', dom, re.DOTALL)
    if not found:
        sys.exit(f"{page}: its scripts did not come to their end")
    return json.loads(html.unescape(found.group(1)))


def embedded(page):
    """The data in the page."""
    text = page.read_text(encoding="utf-8")
    return json.loads(re.search(r'<script type="application/json" id="data">(.*?)</script>', text, re.DOTALL).group(1))


def near(a, b, tolerance=1e-5):
    """Whether two numbers agree in all digits that are shown."""
    return math.isclose(a, b, rel_tol=tolerance, abs_tol=0.0) or a == b


def number(text):
    return float(text.replace("\u2212", "-"))


def wrong_frames(seen, data, rows):
    """What is wrong with the places of the slider."""
    pictures = data["pictures"]
    times = pictures["times"] if pictures else []
    if len(seen["frames"]) != len(times):
        yield f"{len(seen['frames'])} places of the slider, {len(times)} times"
    if len({frame["time"] for frame in seen["frames"]}) != len(times):
        yield "two places of the slider show the same time"
    for time, frame in zip(times, seen["frames"]):
        pane = pictures["windows"][0]
        if frame["size"] != [pane["width"], pane["height"]]:
            yield f"t = {time}: a picture of {frame['size']} pixels"
        if not near(number(frame["time"].split()[0]), time) or not frame["spoken"] or "t = " not in frame["alt"]:
            yield f"t = {time}: shown as {frame['time']}"
        row = min(rows, key=lambda row: abs(float(row["t"]) - time), default=None)
        for column, text in frame["values"] if row else []:
            if text == "" or not near(number(text), float(row[column])):
                yield f"t = {time}: {column} is {row[column]}, shown is {text!r}"
        for chart, x in frame["cursors"]:
            t0, t1, x0, x1 = (float(chart[name]) for name in ("t0", "t1", "x0", "x1"))
            if abs(x - (x0 + (max(time, t0) - t0) / (t1 - t0) * (x1 - x0))) > 0.5:
                yield f"t = {time}: marked at {x}"


def wrong_choices(seen, data):
    """What is wrong with the fields and the windows."""
    pictures = data["pictures"]
    if not pictures:
        return
    expected = len(pictures["windows"]) * len(pictures["quantities"])
    if len({choice["alt"] for choice in seen["choices"]}) != expected:
        yield f"not {expected} different pictures to choose"
    if any(choice["ticks"] < 2 or not choice["legend"] for choice in seen["choices"]):
        yield "a legend without numbers"
    start, larger, moved, whole = seen["zoom"]
    if start == larger or moved == larger or whole != start or not seen["lines"] or not seen["focus"]:
        yield f"zoom, lines or keys do nothing: {seen['zoom']}"


def wrong_curves(seen, rows):
    """What is wrong with the charts."""
    if rows and not seen["charts"]:
        yield "no charts"
    for curve in seen["curves"]:
        x, y, width, height = curve["box"]
        inside = x >= 0 and y >= 0 and x + width <= curve["frame"][0] and y + height <= curve["frame"][1]
        if not inside or (curve["points"] > 1 and curve["length"] == 0):
            yield f"a curve outside of its chart, or without points: {curve}"


def flat(value, path=""):
    """Nested tables as pairs of dotted keys and values."""
    if isinstance(value, dict):
        for name, entry in value.items():
            yield from flat(entry, f"{path}.{name}" if path else name)
    else:
        yield path, value


def wrong_figures(seen, directory, data):
    """What is wrong with the tables."""
    summary = directory / "summary.json"
    if not summary.exists():
        return
    for key, value in flat(json.loads(summary.read_text(encoding="utf-8"))):
        if key not in seen["cells"] or json.loads(seen["cells"][key]) != value:
            yield f"{key} is {value}, shown is {seen['cells'].get(key)}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--picture")
    parser.add_argument("--dark", action="store_true")
    parser.add_argument("--chromium")
    arguments = parser.parse_args()
    program = arguments.chromium or next(filter(None, map(shutil.which, PROGRAMS)), None)
    if program is None:
        print("skipped: no Chromium; the page was not opened")
        return
    page = arguments.directory / "report.html"
    with open(arguments.directory / "history.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    seen, data = use(program, page), embedded(page)
    wrong = [*seen["problems"], *wrong_frames(seen, data, rows), *wrong_choices(seen, data), *wrong_curves(seen, rows),
             *wrong_figures(seen, arguments.directory, data)]
    if seen["wide"] or seen["unnamed"]:
        wrong.append(f"wider than its window: {seen['wide']}; elements without a name: {seen['unnamed']}")
    if page.stat().st_size > 10_000_000:
        wrong.append(f"{page.stat().st_size} bytes, at most 10,000,000 are meant")
    if arguments.picture:
        dark = ["--blink-settings=preferredColorScheme=0"] if arguments.dark else []
        height = 3600
        chromium(program, *dark, f"--window-size=1280,{height}", f"--screenshot={arguments.picture}", page.absolute().as_uri())
    for line in wrong:
        print(f"{page}: {line}", file=sys.stderr)
    print(f"{page}: {len(seen['frames'])} times, {len(seen['choices'])} choices, {len(seen['curves'])} curves, "
          f"{len(seen['cells'])} figures, {len(wrong)} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
