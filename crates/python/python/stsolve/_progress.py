"""One line that shows how far a run is: on a terminal, or below the cell of a notebook. Elsewhere there is none."""

import shutil
import sys

WIDTH = 24


def _time(seconds):
    """3 s, 2:05 min, 1:04 h"""
    seconds = round(seconds)
    if seconds < 60:
        return f"{seconds} s"
    minutes, unit = (seconds, "min") if seconds < 3600 else (seconds // 60, "h")
    return f"{minutes // 60}:{minutes % 60:02d} {unit}"


def line(slab, time, end, part, seconds):
    """The line of a run that has done `slab` slabs and a `part` of its way from the start to the `end` in so many seconds."""
    bar = ("=" * round(WIDTH * part)).ljust(WIDTH)
    left = f", {_time(seconds * (1 - part) / part)} left" if part > 0 else ""
    return f"[{bar}] {100 * part:3.0f} %  slab {slab}  t = {time:.6g} of {end:.6g}  {_time(seconds)} elapsed{left}"


class Terminal:
    """Writes the line over the last one."""

    def __init__(self, stream):
        self.stream, self.length = stream, 0

    def show(self, text):
        text = text[: shutil.get_terminal_size().columns - 1]
        self.stream.write("\r" + text.ljust(self.length))
        self.stream.flush()
        self.length = len(text)

    def close(self):
        if self.length:
            self.stream.write("\n")
            self.stream.flush()


class Notebook:
    """Changes an output of the cell."""

    def __init__(self):
        self.handle = None

    def show(self, text):
        from IPython.display import display

        data = {"text/plain": text}
        if self.handle is None:
            self.handle = display(data, raw=True, display_id=True)
        else:
            self.handle.update(data, raw=True)

    def close(self):
        pass


def _in_notebook():
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return shell is not None and hasattr(shell, "kernel")


class Progress:
    """The line of one run. `show` takes its numbers."""

    def __init__(self):
        if _in_notebook():
            self.place = Notebook()
        elif sys.stderr is not None and sys.stderr.isatty():
            self.place = Terminal(sys.stderr)
        else:
            self.place = None
        self.last = None

    def show(self, *numbers):
        if self.place and numbers[0] > 0 and (text := line(*numbers)) != self.last:
            self.place.show(text)
            self.last = text

    def close(self):
        if self.place:
            self.place.close()
