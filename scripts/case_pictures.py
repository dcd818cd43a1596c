#!/usr/bin/env python3
"""Draws the pictures of the cases for docs/src/cases and README.md, from runs.

    case_pictures.py NAME... [--results DIRECTORY]

A picture shows a field at the last step, with title, colours and the edges of cells; the program draws it, $STSOLVE or scripts/stsolve. Structures
and meshes without a flow are drawn by other scripts. `make_case_pages.py` draws the pictures of the pages that it writes. Of
`naca0012_heave_pitch`, run with `--set output.every=1`, also the movie of README.md is made.
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tomllib

import PIL.Image

ROOT = pathlib.Path(__file__).resolve().parent.parent
PICTURES = ROOT / "docs" / "src" / "pictures"
SCRIPTS = ROOT / "scripts"

WIDTH = 800
# The largest width and height of a small picture on the page of all cases.
THUMBNAIL = (200, 130)

# The window behind a body that sheds vortices.
STREET = "-2,-4,14,4"
VORTICES = "vortices, oblique"

# What the program draws of a flow: the field, Mach number without an entry, and options of `stsolve report`.
DRAWN = {
    "channel_cylinder": ("vorticity", {"window": "whole domain", "range": "-10,10"}),
    "couette": ("temperature", {}),
    "cylinder_m1": ("vorticity", {}),
    "cylinder_mach_3": ("mach", {"window": "-1.3,-1.3,0,1.3", "width": 420}),
    "cylinder_steady": ("vorticity", {"window": "-2,-2,6,2", "range": "-4,4"}),
    "cylinder_street": ("vorticity", {"window": STREET, "range": "-2,2"}),
    "cylinder_viv": ("vorticity", {"window": STREET, "range": "-2,2"}),
    "flapping_free": ("vorticity", {"window": "-0.75,-1.25,3.25,1.25", "range": "-20,20"}),
    "flapping_wing_3d": ("mach", {"window": VORTICES, "q_level": 0.3}),
    "flexible_plate_3d": ("mach", {"window": "z=0.3"}),
    "flutter_airfoil": ("pressure", {"window": "-0.75,-0.75,1.75,0.75"}),
    "heated_cavity": ("temperature", {}),
    "kelvin_helmholtz": ("density", {}),
    "manufactured": ("density", {}),
    "naca0012_heave": ("vorticity", {"window": "-0.75,-0.25,3.25,1.75", "range": "-20,20"}),
    "naca0012_heave_pitch": ("vorticity", {"window": "-0.75,-0.45,3.25,1.75", "range": "-30,30"}),
    "naca0012_paper": ("vorticity", {"window": "-0.75,-0.25,2.25,1.75", "range": "-30,30"}),
    "naca0012_wave": ("mach", {"window": VORTICES}),
    "rough_channel": ("vorticity", {}),
    "sod": ("density", {}),
    "sphere_300": ("mach", {"window": "z=0"}),
    "taylor_green_3d": ("mach", {"window": VORTICES}),
    "turek_hron_fsi1": ("vorticity", {"range": "-10,10"}),
    "turek_hron_fsi2": ("vorticity", {"range": "-50,50"}),
    "turek_hron_fsi3": ("vorticity", {"range": "-100,100"}),
    "turbulent_channel": ("mach", {"window": "z=0.5"}),
    "turbine_blade_3d": ("mach", {"window": "z=0.11"}),
    "turbine_blade_3d_rough": ("mach", {"window": "z=0.11"}),
    "vortex": ("vorticity", {}),
    "vortex_period": ("vorticity", {}),
    "vortex_sinusoidal": ("vorticity", {}),
    "wedge": ("pressure", {}),
}
# Flows whose field is uniform: the mesh is drawn.
UNIFORM = {"free_stream", "free_stream_3d"}
# Parts of meshes that move without a flow, x0 x1 y0 y1.
WINDOW = {"airfoil_motion": (-0.6, 1.6, 0, 2)}
# From where a mesh in three dimensions is seen, and which part of it.
VIEW = {
    "free_stream_3d": ["--from", 1.0, 0.7, 0.5],
    "channel_roughness_3d": ["--from", 0.6, 1.6, 1.2, "--zoom", 0.98],
    "turbine_blade_roughness_3d": ["--from", -0.55, 0.5, 1.0, "--focus", 0.45, 0.25, 0.2, "--zoom", 3.4],
}

# The movie of README.md.
MOVIE = "naca0012_heave_pitch"
MOVIE_OPTIONS = {"window": "-0.75,-0.85,2.65,1.2", "range": "-30,30", "width": 520}


def draw(name, run, summary, picture):
    """A picture of the last step, or of all, with its small copy; what it shows, or nothing."""
    shows = shown(name, run, summary, picture)
    if shows:
        small(name, picture)
    return shows


def shown(name, run, summary, picture):
    """Has the program or a script draw; what that shows."""
    result = run / "result.vtkhdf"
    if "flow" in summary["unknowns"] and name not in UNIFORM:
        return by_program(name, run, picture)
    if "structure" in summary:
        return by_script("the structure at several times", "plot_structure.py", run, picture)
    if summary["mesh"]["dimension"] == 2:
        window = ["--window", *WINDOW[name]] if name in WINDOW else []
        return by_script("mesh at the end", "plot_mesh.py", result, "--output", picture, *window)
    if name in VIEW:
        arguments = ["--field", "jacobian", "--width", WIDTH, "--title", title(name), *VIEW[name]]
        return by_script("surface of the mesh at the end, by det J / det J_0", "render_vtk.py", result, picture, *arguments)
    return None


def title(name):
    """The title of a case."""
    return tomllib.loads((ROOT / "cases" / f"{name}.toml").read_text())["title"]


def by_program(name, run, picture):
    """The picture of the program."""
    field, options = DRAWN.get(name, ("mach", {}))
    shutil.move(report(run, "picture", field, {"width": WIDTH, **options}), picture)
    words = "Mach number" if field == "mach" else field
    if options.get("window") != VORTICES:
        return f"{words} at the end"
    surface = f"the surface Q = {options['q_level']}" if "q_level" in options else "a surface of the Q criterion"
    return f"{words} on {surface} at the end"


def report(run, kind, field, options):
    """Calls `stsolve report`; the file that it has written."""
    words = [f"--{key.replace('_', '-')}={value}" for key, value in options.items()]
    command = [os.environ.get("STSOLVE", SCRIPTS / "stsolve"), "report", run, f"--{kind}={field}", *words]
    printed = subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout
    return pathlib.Path(printed.split(".png: ")[0] + ".png")


def by_script(shows, script, *arguments):
    """Has a script draw; what that shows."""
    subprocess.run([sys.executable, *map(str, [SCRIPTS / script, *arguments])], check=True, stdout=subprocess.DEVNULL)
    return shows


def small(name, picture):
    """The small copy of a picture."""
    file = PICTURES / "small" / f"{name}.png"
    file.parent.mkdir(exist_ok=True)
    image = PIL.Image.open(picture).convert("RGB")
    image.thumbnail(THUMBNAIL, PIL.Image.Resampling.LANCZOS)
    image.quantize(64).save(file, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="+")
    parser.add_argument("--results", type=pathlib.Path, default=pathlib.Path("runs"))
    arguments = parser.parse_args()
    for name in arguments.names:
        run = arguments.results / name
        summary = json.loads((run / "summary.json").read_text())
        print(f"{name}: {draw(name, run, summary, PICTURES / f'case_{name}.png')}")
        if name == MOVIE:
            shutil.move(report(run, "movie", "vorticity", MOVIE_OPTIONS), PICTURES / "moving_airfoil.png")


if __name__ == "__main__":
    main()
