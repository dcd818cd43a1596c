#!/usr/bin/env python3
"""Opens the page of a run in headless Chromium and uses it.

    check_report.py DIRECTORY [--picture PNG] [--dark]

DIRECTORY is the directory of a run for which `stsolve report` has made report.html. The checks:

* no error and no message on the console; nothing is loaded from elsewhere; the page is at most 10 MB;
* pictures of a run in time play on opening, but not where the system asks for reduced motion; a click pauses them;
* arrow keys move the slider; each position shows another time, and its picture has the announced size;
* in three dimensions arrow keys move the plane of each cut, and each position shows another picture;
* the charts mark that time with the numbers of history.csv; every curve has points inside its chart;
* each field and window can be clicked; keys zoom;
* charts, the picture and the film can be saved, also charts that are folded;
* every number of summary.json is in the tables.

--picture keeps a picture of the page. Exits with 1 and names every error; without a Chromium it says so and exits with 0.
"""

import argparse
import csv
import json
import math
import pathlib
import re
import sys

import headless

# What is seen of the picture and the charts.
FRAME = """(async () => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const field = document.getElementById("field");
  await field.decode();
  return { picture: field.src, alt: field.alt, size: [field.naturalWidth, field.naturalHeight],
    time: document.getElementById("time").textContent, legend: document.getElementById("legend-label").textContent,
    ticks: all("#legend-ticks span").length, moved: document.getElementById("stack").style.transform,
    values: all("output[data-column]").map((output) => [output.dataset.column, output.textContent, output.title]),
    marks: all(".chart > svg").map((chart) => ({ ...chart.dataset, x: chart.querySelector(".cursor").getAttribute("x1") })) };
})()"""

# The curves, the tables and what makes a page usable.
PAGE = """(() => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const named = (e) => e.getAttribute("aria-label") || e.labels?.length || e.hasAttribute("alt");
  const curve = (path) => {
    const [box, frame] = [path.getBBox(), path.closest("svg").viewBox.baseVal];
    return { length: path.getTotalLength(), points: (path.getAttribute("d").match(/[ML]/g) || []).length,
      inside: box.x >= 0 && box.y >= 0 && box.x + box.width <= frame.width && box.y + box.height <= frame.height };
  };
  return { curves: all(".chart > svg path").map(curve), data: JSON.parse(document.getElementById("data").textContent),
    cells: Object.fromEntries(all("td[data-key]").map((cell) => [cell.dataset.key, cell.title])),
    wide: document.documentElement.scrollWidth > innerWidth,
    unnamed: all("button, input, img").filter((e) => !named(e)).length };
})()"""


def number(text):
    return float(text.replace("\u2212", "-"))


def near(text, value, digits=6):
    """Whether a number agrees with its text in all digits that are shown."""
    return text != "" and math.isclose(number(text), value, rel_tol=10 ** (1 - digits), abs_tol=0.0)


def wrong_frame(frame, time, pane, rows):
    """What is wrong with the page when the picture of a time is shown."""
    if frame["size"] != [pane["width"], pane["height"]] or "t = " not in frame["alt"]:
        yield f"t = {time}: a picture of {frame['size']} pixels, described as {frame['alt']}"
    if not near(frame["time"].split()[0], time):
        yield f"t = {time}: shown as {frame['time']}"
    row = min(rows, key=lambda row: abs(float(row["t"]) - time), default=None)
    for column, text, title in frame["values"] if row else []:
        if not near(text, float(row[column]), 3) or float(title) != float(row[column]):
            yield f"t = {time}: {column} is {row[column]}, shown is {text!r}, {title!r}"
    for mark in frame["marks"]:
        t0, t1, x0, x1, x = (float(mark[name]) for name in ("t0", "t1", "x0", "x1", "x"))
        if abs(x - (x0 + (max(time, t0) - t0) / (t1 - t0) * (x1 - x0))) > 0.5:
            yield f"t = {time}: marked at {x}"


# Whether the picture changes within half a second, and whether the button offers a pause.
PLAYS = """(async () => {
  const shown = new Set();
  for (let look = 0; look < 10; look++) {
    shown.add(document.getElementById("time").textContent);
    await new Promise((done) => setTimeout(done, 50));
  }
  return [shown.size > 1, document.getElementById("play").getAttribute("aria-label") === "Pause"];
})()"""


def wrong_play(page, pictures):
    """Whether the pictures play on opening as they should, and a click pauses them."""
    several = len(pictures["times"]) > 2
    for reduced in ("reduce", "no-preference"):
        page.reopen([{"name": "prefers-reduced-motion", "value": reduced}])
        expected = several and reduced == "no-preference"
        if page.evaluate(PLAYS) != [expected] * 2:
            yield f"opened with motion '{reduced}': plays {'not' if expected else 'all the same'}"
    if several:
        page.click("#viewer")
        if page.evaluate(PLAYS) != [False, False]:
            yield "a click does not pause"


def wrong_slider(page, pictures, rows):
    """Goes through all times with the arrow keys."""
    page.evaluate("document.getElementById('slider').focus()")
    page.press("Home", 36)
    shown = []
    for time in pictures["times"]:
        frame = page.evaluate(FRAME)
        shown.append(frame["time"])
        yield from wrong_frame(frame, time, pictures["windows"][0], rows)
        page.press("ArrowRight", 39)
    if len(set(shown)) != len(shown):
        yield f"the slider does not move: {shown}"


def wrong_cuts(page, pictures):
    """Goes through all positions of each cut with the arrow keys."""
    for number, window in enumerate(pictures["windows"]):
        if "cut" not in window:
            continue
        page.click(f"input[name=window][value='{number}'] + span")
        page.evaluate("document.getElementById('cut').focus()")
        page.press("Home", 36)
        for position in window["cut"]["positions"]:
            frame = page.evaluate(FRAME)
            where = re.search(f"{window['cut']['axis']} = ([^:]*):", frame["alt"])
            if not where or not near(where[1], position, 4) or frame["size"] != [window["width"], window["height"]]:
                yield f"{window['label']} at {position}: {frame['alt']}, {frame['size']} pixels"
            page.press("ArrowRight", 39)
        if page.evaluate("[document.getElementById('over-time').hidden, document.getElementById('over-cut').hidden]") != [True, False]:
            yield f"{window['label']}: the wrong slider"
    if len(pictures["windows"]) > 1:
        page.click("input[name=window][value='0'] + span")


def wrong_choices(page, pictures):
    """Looks at every field in every window."""
    seen = set()
    for window in range(len(pictures["windows"])):
        if len(pictures["windows"]) > 1:
            page.click(f"input[name=window][value='{window}'] + span")
        for quantity in range(len(pictures["quantities"])):
            page.click(f"input[name=quantity][value='{quantity}'] + span")
            frame = page.evaluate(FRAME)
            seen.add(frame["alt"])
            expected = [uri for uri, _ in pictures["windows"][window]["pictures"][quantity]]
            # A cut is opened in the middle, the others at the last time.
            expected = expected[(len(expected) - 1) // 2 if "cut" in pictures["windows"][window] else -1]
            if frame["picture"] != expected or frame["ticks"] < 2 or not frame["legend"]:
                yield f"field {quantity} in window {window}: {frame['alt']}, {frame['ticks']} numbers in the legend"
    if len(seen) != len(pictures["windows"]) * len(pictures["quantities"]):
        yield f"pictures that look the same: {sorted(seen)}"


def wrong_zoom(page):
    """Zooms in, moves, and goes back; shows the edges of the cells."""
    page.evaluate("document.getElementById('viewer').focus()")
    moved = [page.evaluate(FRAME)["moved"]]
    for key, code in (("+", 187), ("ArrowRight", 39), ("0", 48)):
        page.press(key, code)
        moved.append(page.evaluate(FRAME)["moved"])
    if len(set(moved[:3])) != 3 or moved[3] != moved[0]:
        yield f"keys do not zoom: {moved}"
    page.click("#mesh-lines")
    width = page.evaluate("document.getElementById('mesh').decode().then(() => document.getElementById('mesh').naturalWidth)")
    if page.evaluate("document.getElementById('mesh').hidden") or width == 0:
        yield "the edges of the cells are not shown"
    page.click("#mesh-lines")


# Everything that can be saved, caught on its way.
SAVE = """(async () => {
  const blobs = [];
  const make = URL.createObjectURL.bind(URL);
  URL.createObjectURL = (blob) => (blobs.push(blob), make(blob));
  HTMLAnchorElement.prototype.click = () => {};
  const buttons = [...document.querySelectorAll("[data-save], #save-picture, #save-film")].filter((b) => !b.hidden);
  buttons.forEach((button) => button.click());
  for (let wait = 0; wait < 300 && blobs.length < buttons.length; wait++) await new Promise((done) => setTimeout(done, 100));
  const size = async (blob) => {
    if (blob.type !== "image/png") return [blob.size, 0];
    const image = await createImageBitmap(blob);
    return [image.width, image.height];
  };
  const all = blobs.map(async (b) => ({ type: b.type, size: await size(b), text: b.type === "text/csv" ? await b.text() : "" }));
  return { buttons: buttons.length, blobs: await Promise.all(all) };
})()"""


def wrong_saves(page, pictures, rows):
    """Saves every chart, the picture and the film."""
    saved = page.evaluate(SAVE)
    if len(saved["blobs"]) != saved["buttons"]:
        yield f"{saved['buttons']} buttons save {len(saved['blobs'])} files"
    for blob in saved["blobs"]:
        if blob["size"][0] < (4 if blob["text"] else 20):
            yield f"an empty file of type {blob['type']}"
        lines = blob["text"].splitlines()
        if blob["type"] == "text/csv" and (len(lines) != min(len(rows), 2001) + 1 or not lines[0].startswith("t,")):
            yield f"a table of {len(lines)} lines that begins with {lines[:1]}"
    sizes = [blob["size"] for blob in saved["blobs"] if blob["type"] == "image/png"]
    # Small pictures are enlarged, so that the legend has room.
    if pictures and not any(width == max(pictures["windows"][0]["width"], 640) for width, _ in sizes):
        yield f"the picture is not among {sizes}"
    types = {blob["type"].split(";")[0] for blob in saved["blobs"]}
    if pictures and len(pictures["times"]) > 1 and "video/webm" not in types:
        yield f"no film among {types}"


def flat(value, path=""):
    """Nested tables as pairs of dotted keys and values."""
    if isinstance(value, dict):
        for name, entry in value.items():
            yield from flat(entry, f"{path}.{name}" if path else name)
    else:
        yield path, value


def wrong_page(seen, rows, directory):
    """What is wrong with curves, tables and the page as a whole."""
    if rows and not seen["curves"]:
        yield "no curves"
    yield from (f"a curve outside of its chart, or without points: {curve}" for curve in seen["curves"]
                if not curve["inside"] or (curve["points"] > 1 and curve["length"] == 0))
    summary = directory / "summary.json"
    for key, value in flat(json.loads(summary.read_text(encoding="utf-8"))) if summary.exists() else []:
        if json.loads(seen["cells"].get(key, "null")) != value:
            yield f"{key} is {value}, shown is {seen['cells'].get(key)}"
    if seen["wide"] or seen["unnamed"]:
        yield f"wider than its window: {seen['wide']}; elements without a name: {seen['unnamed']}"
    size = (directory / "report.html").stat().st_size
    if size > 10_000_000:
        yield f"{size} bytes"


def check(page, directory):
    """All that is wrong, and what was looked at."""
    with open(directory / "history.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    pictures = page.evaluate("JSON.parse(document.getElementById('data').textContent).pictures")
    wrong = list(wrong_play(page, pictures)) if pictures else []
    # Only what is open has a size.
    page.evaluate("document.querySelectorAll('details').forEach((details) => (details.open = true))")
    seen = page.evaluate(PAGE)
    wrong += wrong_page(seen, rows, directory)
    if pictures:
        wrong += [*wrong_cuts(page, pictures), *wrong_slider(page, pictures, rows), *wrong_choices(page, pictures), *wrong_zoom(page)]
        page.click("input[name=window][value='0'] + span") if len(pictures["windows"]) > 1 else None
    page.evaluate("document.querySelectorAll('details').forEach((details) => (details.open = false))")
    wrong += wrong_saves(page, pictures, rows)
    times = len(pictures["times"]) if pictures else 0
    return wrong + page.problems, f"{times} times, {len(seen['curves'])} curves, {len(seen['cells'])} figures"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("directory", type=pathlib.Path)
    parser.add_argument("--picture")
    parser.add_argument("--dark", action="store_true")
    arguments = parser.parse_args()
    report = (arguments.directory / "report.html").absolute()
    program = headless.find()
    if program is None:
        print(f"{report}: skipped, for want of Chromium")
        return
    with headless.Page(program, report.as_uri()) as page:
        if arguments.picture:
            page.picture(arguments.picture, arguments.dark)
        wrong, looked_at = check(page, arguments.directory)
    for line in wrong:
        print(f"{report}: {line}", file=sys.stderr)
    print(f"{report}: {looked_at}, {len(wrong)} wrong")
    sys.exit(1 if wrong else 0)


if __name__ == "__main__":
    main()
