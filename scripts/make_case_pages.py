#!/usr/bin/env python3
"""Writes the pages of the cases in docs/src/cases, with pictures and the numbers to expect, from runs.

    make_case_pages.py [NAME]... [--results DIRECTORY] [--keep-pictures]      default: all cases

A page holds the comment at the head of the case, a picture, and the figures of summary.json. Seconds are left out, because they stand on the
page that `make_speed_page.py` writes. Results are looked for in DIRECTORY/NAME (default: runs, where `stsolve run cases/NAME.toml` leaves them).
A case without results keeps its picture and figures; with --keep-pictures all keep their pictures. `case_pictures.py` draws, mostly by the program, $STSOLVE or scripts/stsolve. The list of
pages, with small pictures, and the table of contents are written anew. Needs the module stsolve (scripts/wheel --here) and the Python packages of
scripts/requirements.txt.
"""

import argparse
import json
import pathlib
import tomllib

import case_pictures

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOOK = ROOT / "docs" / "src"

# Sections of summary.json that are figures of the run, and what they are called.
FIGURES = {
    "unknowns": "unknowns of a slab", "slabs": "slabs", "time": "time reached", "newton": "Newton steps", "krylov": "Krylov iterations",
    "mesh_quality": "mesh", "conservation": "conservation", "error": "error", "steady": "steady flow", "walls": "walls", "openings": "openings", "bodies": "bodies",
    "structure": "structure", "cost": "cost",
}
# Figures that stay out of the pages: the parts of the cost, which are for programmers.
INTERNAL = "cost.parts."
# The first line of a case, for editors.
SCHEMA_LINE = "#:schema ./case.schema.json\n"
# Below this a number is round-off, of which no digit is to be expected.
ROUND_OFF = 1e-11


def header(text):
    """The paragraphs of the comment at the head of a case."""
    lines = []
    for line in text.removeprefix(SCHEMA_LINE).splitlines():
        if not line.startswith("#"):
            break
        lines.append(line[1:].removeprefix(" ").rstrip())
    return "\n".join(lines).split("\n\n")


def markdown(paragraph):
    """A paragraph on one line, with its first words in bold if they say what it is about; a star is a star. Indented lines stay as they are."""
    if paragraph.startswith("    "):
        return paragraph
    paragraph = " ".join(paragraph.split("\n"))
    lead, colon, rest = paragraph.replace("*", r"\*").partition(":")
    known = ("what it shows", "where it comes from", "what to expect", "what it costs")
    return f"**{lead}:**{rest}" if colon and lead.lower().startswith(known) else paragraph


def short(value):
    """A figure as it may be expected again."""
    if isinstance(value, float):
        return "round-off" if 0 < abs(value) < ROUND_OFF else f"{value:.5g}"
    if isinstance(value, list):
        return ", ".join(short(entry) for entry in value)
    return str(value)


def figures(summary):
    """Rows (section, key, value) of what summary.json tells."""
    def flat(prefix, value):
        if isinstance(value, dict):
            for key, inner in value.items():
                yield from flat(f"{prefix}.{key}", inner)
        else:
            yield prefix, value

    for section, title in FIGURES.items():
        for key, value in flat(section, summary.get(section, {})):
            if value != {} and not key.endswith("seconds") and not key.startswith(INTERNAL):
                yield title, key, short(value)


def write_page(case, run, keep_pictures):
    """The page of a case, from its file and its run; without a run, with the picture and the figures that it has."""
    page = BOOK / "cases" / f"{case.stem}.md"
    if (run / "summary.json").exists():
        summary = json.loads((run / "summary.json").read_text())
        kept = keep_pictures and page.exists()
        shown = picture_and_figures(page.read_text())[0] if kept else picture(case.stem, run, summary)
        rows = table_of_figures(summary)
    elif page.exists():
        shown, rows = picture_and_figures(page.read_text())
    else:
        return
    page.write_text("\n".join([*text(case), *shown, *description(case), *rows]).rstrip() + "\n")
    print(case.stem)


def text(case):
    """The title of a page, and how to run the case."""
    title = tomllib.loads(case.read_text())["title"]
    return [f"# {title}", "", f"`scripts/stsolve run cases/{case.name}` runs [the case](../../../cases/{case.name}).", ""]


def description(case):
    """The paragraphs at the head of a case."""
    return [line for paragraph in header(case.read_text()) for line in (markdown(paragraph), "")]


def picture(name, run, summary):
    """Draws the picture of a run; the lines that show it."""
    file = BOOK / "pictures" / f"case_{name}.png"
    shows = case_pictures.draw(name, run, summary, file)
    return [f"![{shows}](../pictures/{file.name})", ""] if shows else []


def table_of_figures(summary):
    """The lines of the figures of a run."""
    machine = summary["machine"]
    where = f"{machine['processors']} processors ({machine.get('processor', machine['system'])})"
    rows = [f"| {section} | `{key}` | {value} |" for section, key, value in figures(summary)]
    return ["## Figures", "", f"Of `summary.json`, by version {summary['version']} on {where}:", "", "| | key | value |", "|---|---|---|", *rows]


def picture_and_figures(page):
    """The lines of the picture and of the figures of a page."""
    lines = page.splitlines()
    shown = [line for line in lines if line.startswith("![")]
    rows = [line for line in lines[lines.index("## Figures"):] if f"`{INTERNAL}" not in line]
    return [*shown, *[""] * len(shown)], rows


def thumbnail(name, title):
    """A cell that shows the small picture of a case, or an empty one."""
    small = BOOK / "pictures" / "small" / f"{name}.png"
    return f"[![{title}](../pictures/small/{small.name})]({name}.md)" if small.exists() else ""


def write_lists():
    """The page of all pages, and their entries in the table of contents."""
    pages = sorted(page for page in (BOOK / "cases").glob("*.md") if page.stem != "README")
    titles = {page.stem: page.read_text().splitlines()[0].removeprefix("# ") for page in pages}
    table = ["# Cases", "", "The shipped cases, each with a picture and the numbers to expect. `scripts/make_case_pages.py` writes the pages from",
             "the cases and their runs. [Speed](../speed.md) lists the seconds of some.", "", "| | case | shows |", "|---|---|---|"]
    table += [f"| {thumbnail(name, title)} | [`{name}`]({name}.md) | {title} |" for name, title in titles.items()]
    (BOOK / "cases" / "README.md").write_text("\n".join(table) + "\n")
    summary = BOOK / "SUMMARY.md"
    lines = [line for line in summary.read_text().splitlines() if not line.startswith("  - [")]
    place = lines.index("- [Cases](cases/README.md)") + 1
    lines[place:place] = [f"  - [{title}](cases/{name}.md)" for name, title in titles.items()]
    summary.write_text("\n".join(lines) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*")
    parser.add_argument("--results", type=pathlib.Path, default=pathlib.Path("runs"))
    parser.add_argument("--keep-pictures", action="store_true")
    arguments = parser.parse_args()
    for case in sorted((ROOT / "cases").glob("*.toml")):
        if not arguments.names or case.stem in arguments.names:
            write_page(case, arguments.results / case.stem, arguments.keep_pictures)
    write_lists()


if __name__ == "__main__":
    main()
