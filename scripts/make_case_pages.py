#!/usr/bin/env python3
"""Writes the pages of the cases in docs/src/cases, with pictures and the numbers to expect, from runs.

    make_case_pages.py [NAME]... [--results DIRECTORY]      default: all cases that have results

A page holds what the comment at the head of the case says, a picture, and the figures of summary.json. Results are looked for in
DIRECTORY/NAME (default: runs, where `stsolve run cases/NAME.toml` leaves them); a case without results keeps the page that it has. The
list of pages and the table of contents are written anew. Needs the Python packages of scripts/requirements.txt.
"""

import argparse
import json
import pathlib
import subprocess
import sys
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
BOOK = ROOT / "docs" / "src"
SCRIPTS = ROOT / "scripts"

# What is drawn: the mesh where the flow is uniform or there is none, otherwise a field; and in which window (x0, y0, x1, y1), if not all.
UNIFORM = {"free_stream", "free_stream_3d"}
FIELD = {"couette": "temperature", "manufactured": "density", "cylinder_m1": "vorticity", "cylinder_steady": "vorticity", "channel_cylinder": "vorticity",
         "cylinder_street": "pressure"}
WINDOW = {
    "naca0012_heave": (-0.75, -0.25, 3.25, 1.75), "cylinder_steady": (-2, -2, 6, 2), "airfoil_motion": (-0.6, 0, 1.6, 2),
    "naca0012_wave": (-0.75, -0.5, 2.25, 1.0), "naca0012_heave_pitch": (-0.75, -0.25, 3.25, 1.75), "naca0012_paper": (-0.75, -0.25, 2.25, 1.75), "cylinder_street": (-2, -4, 14, 4),
}
# From where a mesh in three dimensions is seen.
DIRECTION = {"channel_roughness_3d": (0.6, 1.6, 1.2), "turbine_blade_roughness_3d": (-1.0, 0.8, 1.0)}
WIDTH = 800

# Sections of summary.json that are figures of the run, and what they are called.
FIGURES = {
    "unknowns": "unknowns of a slab", "slabs": "slabs", "time": "time reached", "newton": "Newton steps", "krylov": "Krylov iterations",
    "mesh_quality": "mesh", "conservation": "conservation", "error": "error", "steady": "steady flow", "walls": "walls", "openings": "openings",
    "structure": "structure", "cost": "cost",
}
# Below this a number is round-off, of which no digit is to be expected.
ROUND_OFF = 1e-11


def header(text):
    """The paragraphs of the comment at the head of a case."""
    lines = []
    for line in text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line[1:].strip())
    return [" ".join(part.split("\n")) for part in "\n".join(lines).split("\n\n")]


def markdown(paragraph):
    """A paragraph with its first words in bold, if they say what it is about; a star is a star."""
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
            if value != {}:
                yield title, key, short(value)


def draw(name, run, summary, picture):
    """A picture of the last step, or of all; what it shows, or nothing."""
    result, window = run / "result.vtkhdf", WINDOW.get(name)
    if "structure" in summary:
        return drawn("the structure at several times", "plot_structure.py", run, picture)
    if "flow" in summary["unknowns"] and name not in UNIFORM:
        field = FIELD.get(name, "mach")
        arguments = ["--field", field, "--width", WIDTH, *(["--window", *window] if window else [])]
        return drawn(f"{field} at the end", "render_vtk.py", result, picture, *arguments)
    if summary["mesh"]["dimension"] == 2:
        arguments = ["--window", window[0], window[2], window[1], window[3]] if window else []
        return drawn("mesh at the end", "plot_mesh.py", result, "--output", picture, *arguments)
    if name in DIRECTION:
        arguments = ["--field", "jacobian", "--width", WIDTH, "--from", *DIRECTION[name]]
        return drawn("surface of the mesh at the end, by det J / det J_0", "render_vtk.py", result, picture, *arguments)
    return None


def drawn(shows, script, *arguments):
    """Has a script draw; what that shows."""
    subprocess.run([sys.executable, *map(str, [SCRIPTS / script, *arguments])], check=True, stdout=subprocess.DEVNULL)
    return shows


def write_page(case, run):
    """The page of a case, from its file and its run."""
    name, text = case.stem, case.read_text()
    summary = json.loads((run / "summary.json").read_text())
    picture = BOOK / "pictures" / f"case_{name}.png"
    title, paragraphs = tomllib.loads(text)["title"], header(text)
    page = [f"# {title}", "", f"`scripts/stsolve run cases/{name}.toml` runs [the case](../../../cases/{name}.toml).", ""]
    shows = draw(name, run, summary, picture)
    if shows:
        page += [f"![{shows}](../pictures/{picture.name})", ""]
    for paragraph in paragraphs:
        page += [markdown(paragraph), ""]
    machine = summary["machine"]
    page += ["## Figures", "", f"Of `summary.json`, by version {summary['version']} on {machine['processors']} processors "
             f"({machine.get('processor', machine['system'])}):", "", "| | key | value |", "|---|---|---|"]
    page += [f"| {section} | `{key}` | {value} |" for section, key, value in figures(summary)]
    (BOOK / "cases" / f"{name}.md").write_text("\n".join(page).rstrip() + "\n")


def write_lists():
    """The page of all pages, and their entries in the table of contents."""
    pages = sorted(page for page in (BOOK / "cases").glob("*.md") if page.stem != "README")
    titles = {page.stem: page.read_text().splitlines()[0].removeprefix("# ") for page in pages}
    table = ["# Cases", "", "What is shipped in `cases`, each with a picture and the numbers to expect. The pages are written by",
             "`scripts/make_case_pages.py` from the cases and their runs.", "", "| case | shows |", "|---|---|"]
    table += [f"| [`{name}`]({name}.md) | {title} |" for name, title in titles.items()]
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
    arguments = parser.parse_args()
    for case in sorted((ROOT / "cases").glob("*.toml")):
        run = arguments.results / case.stem
        if (not arguments.names or case.stem in arguments.names) and (run / "summary.json").exists():
            write_page(case, run)
            print(case.stem)
    write_lists()


if __name__ == "__main__":
    main()
