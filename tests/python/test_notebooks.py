"""Executes the notebooks, cell by cell, in memory; the line of progress below a cell reaches its end."""

import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient

NOTEBOOKS = Path(__file__).resolve().parents[2] / "docs/notebooks"


def texts(notebook):
    """The text of all outputs."""
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            yield output.get("data", {}).get("text/plain", output.get("text", ""))


def execute(path):
    notebook = nbformat.read(path, as_version=4)
    NotebookClient(notebook, timeout=300, resources={"metadata": {"path": path.parent}}).execute()
    lines = [text for text in texts(notebook) if "elapsed" in text]
    runs = sum("progress=True" in cell.source for cell in notebook.cells if cell.cell_type == "code")
    assert len(lines) >= runs > 0 and all("100 %" in line for line in lines), lines


def main():
    failed, paths = 0, sorted(NOTEBOOKS.glob("*.ipynb"))
    for path in paths:
        try:
            execute(path)
        except Exception as error:  # noqa: BLE001
            failed += 1
            print(f"{path.name}: {type(error).__name__}: {error}")
    print(f"{len(paths) - failed} passed, {failed} failed")
    sys.exit(failed > 0 or not paths)


if __name__ == "__main__":
    main()
