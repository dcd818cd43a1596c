#!/usr/bin/env python3
r"""Typesets the mathematics of the book: a preprocessor of mdBook that writes MathML, which browsers show without a script or a font.

mdBook calls it by `docs/book.toml`. It replaces blocks ```math and inline $`...`$, as GitHub shows them, in every chapter. It knows the part
of LaTeX that the pages use; anything else is an error that names the command.
"""

import html
import json
import re
import sys

GREEK = dict(zip(
    "alpha beta gamma delta varepsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi psi omega Gamma Delta Theta Lambda "
    "Pi Phi Psi Omega".split(), "αβγδεζηθκλμνξπρστφχψωΓΔΘΛΠΦΨΩ"))
SIGNS = {
    "le": "≤", "ge": "≥", "ne": "≠", "to": "→", "sim": "∼", "cdot": "⋅", "cdots": "⋯", "times": "×", "otimes": "⊗", "partial": "∂",
    "nabla": "∇", "infty": "∞", "perp": "⊥", "lvert": "|", "rvert": "|", "{": "{", "}": "}", "#": "#", "langle": "⟨", "rangle": "⟩",
    "int": "∫", "sum": "∑", "prod": "∏",
}
LARGE = {"int", "sum", "prod"}
BELOW = {"sum", "prod", "max", "min"}
NAMES = {"ln", "exp", "max", "min", "det", "log"}
SPACES = {",": "0.17em", ";": "0.28em", " ": "0.28em", "quad": "1em", "qquad": "2em"}
SCRIPT = {**{chr(65 + i): chr(0x1D49C + i) for i in range(26)}, "B": "ℬ", "E": "ℰ", "F": "ℱ", "H": "ℋ", "I": "ℐ", "L": "ℒ", "M": "ℳ", "R": "ℛ"}
FONTS = {"mathbf", "mathsf", "mathcal", "mathrm", "boldsymbol"}
MATRICES = {"bmatrix": "[]", "pmatrix": "()"}

TOKEN = re.compile(r"\\([a-zA-Z]+|.)|([0-9]+(?:\.[0-9]+)?)|([+:]=|\S)", re.DOTALL)


def tokens(latex):
    """Pairs (kind, text): a command, a number, or a sign. Text groups keep their blanks."""
    place, found = 0, []
    while match := TOKEN.search(latex, place):
        place = match.end()
        command, number, sign = match.groups()
        if command == "text":
            end = latex.index("}", place)
            found.append(("text", latex[place + 1:end]))
            place = end + 1
        elif command in ("begin", "end"):
            end = latex.index("}", place)
            found.append((command, latex[place + 1:end]))
            place = end + 1
        elif command:
            found.append(("command", command))
        else:
            found.append(("number", number) if number else ("sign", sign))
    return found


class Parser:
    """Recursive descent over the tokens of a formula."""

    def __init__(self, latex):
        self.tokens, self.place = tokens(latex), 0

    def next(self):
        self.place += 1
        return self.tokens[self.place - 1]

    def peek(self):
        return self.tokens[self.place] if self.place < len(self.tokens) else ("end of formula", "")

    def accept(self, kind, text):
        """Whether the next token is this one, which is then taken."""
        if self.peek() != (kind, text):
            return False
        self.place += 1
        return True

    def row(self, stop):
        """Elements up to a token of `stop`, which is not taken."""
        out = []
        while self.peek() not in stop and self.peek()[0] != "end of formula":
            out.append(self.scripted())
        return "".join(out)

    def group(self):
        """An argument: braces, or one element."""
        if not self.accept("sign", "{"):
            return self.element()[0]
        inner = self.row([("sign", "}")])
        self.next()
        return f"<mrow>{inner}</mrow>"

    def scripted(self):
        """An element with its index, exponent and primes."""
        base, below = self.element()
        low, high = None, None
        while True:
            if self.accept("sign", "'"):
                high = (high or "") + "<mo>′</mo>"
            elif low is None and self.accept("sign", "_"):
                low = self.group()
            elif self.accept("sign", "^"):
                high = (high or "") + self.group()
            else:
                break
        high = f"<mrow>{high}</mrow>" if high else None
        under = ("munder", "munderover") if below else ("msub", "msubsup")
        if low and high:
            return f"<{under[1]}>{base}{low}{high}</{under[1]}>"
        if low:
            return f"<{under[0]}>{base}{low}</{under[0]}>"
        return f"<msup>{base}{high}</msup>" if high else base

    def element(self):
        """MathML of one element, and whether limits stand below it."""
        kind, text = self.next()
        if kind == "number":
            return f"<mn>{text}</mn>", False
        if kind == "text":
            return f"<mtext>{html.escape(text).replace(' ', chr(0xA0))}</mtext>", False
        if kind == "begin":
            return self.environment(text), False
        if kind == "command":
            return self.command(text), text in BELOW
        if text == "{":
            self.place -= 1
            return self.group(), False
        if text.isalpha():
            return f"<mi>{text}</mi>", False
        return self.sign(text), False

    @staticmethod
    def sign(text):
        """An operator or a bracket; bars take no blanks, as it is not known which is the left one."""
        spaces = ' lspace="0.06em" rspace="0.06em"' if text == "|" else ""
        return f'<mo stretchy="false"{spaces}>{html.escape(text.replace("-", "−"))}</mo>'

    def command(self, name):
        if name in FONTS:
            return self.font(name)
        if name in GREEK:
            return f"<mi>{GREEK[name]}</mi>"
        if name in LARGE:
            return f'<mo largeop="true" stretchy="false">{SIGNS[name]}</mo>'
        if name in SIGNS:
            return self.sign(SIGNS[name])
        if name in NAMES:
            blank = "" if self.peek()[1] in ("(", "_") else f'<mspace width="{SPACES[","]}"/>'
            return f"<mi>{name}</mi>{blank}"
        if name in SPACES:
            return f'<mspace width="{SPACES[name]}"/>'
        if name == "frac":
            return f"<mfrac>{self.group()}{self.group()}</mfrac>"
        if name in ("hat", "tilde"):
            return f"<mover accent=\"true\">{self.group()}<mo>{'^' if name == 'hat' else '~'}</mo></mover>"
        if name == "left":
            return self.fence()
        if name == "big":
            return f'<mo stretchy="false" minsize="1.5em">{self.next()[1]}</mo>'
        raise ValueError(f"unknown command \\{name}")

    def fence(self):
        """What stands between \\left and \\right."""
        opening = html.escape(self.next()[1])
        inner = self.row([("command", "right")])
        self.next()
        return f"<mrow><mo>{opening}</mo>{inner}<mo>{html.escape(self.next()[1])}</mo></mrow>"

    def font(self, name):
        """Letters in a font; words of several letters are upright."""
        words = []
        assert self.accept("sign", "{"), f"\\{name} needs braces"
        while not self.accept("sign", "}"):
            kind, text = self.next()
            words.append(GREEK[text] if kind == "command" else text)
        word = "".join(words)
        if name == "mathcal":
            return f"<mi>{''.join(SCRIPT[letter] for letter in word)}</mi>"
        if name == "mathrm":
            return f'<mi mathvariant="normal">{word}</mi>'
        style = "font-family: sans-serif" if name == "mathsf" else "font-weight: bold"
        return f'<mi mathvariant="normal" style="{style}">{word}</mi>'

    def environment(self, name):
        """Rows of cells: aligned equations or a matrix."""
        ends = [("sign", "&"), ("command", "\\"), ("end", name)]
        rows = [[]]
        while True:
            rows[-1].append(self.row(ends))
            kind, text = self.next()
            if kind == "end":
                break
            if text == "\\":
                rows.append([])
        body = "".join(f"<mtr>{''.join(map(self.cell(name), range(len(row)), row))}</mtr>" for row in rows if any(row))
        table = f"<mtable>{body}</mtable>"
        if name in MATRICES:
            opening, closing = MATRICES[name]
            return f"<mrow><mo>{opening}</mo>{table}<mo>{closing}</mo></mrow>"
        return table

    @staticmethod
    def cell(name):
        """How a cell of a column is aligned: right and left in turns in equations, centred in a matrix."""
        aligned = name == "aligned"

        def one(column, inner):
            side = "text-align: right; padding-right: 0" if column % 2 == 0 else "text-align: left; padding-left: 0"
            display = "<mstyle displaystyle=\"true\">" + inner + "</mstyle>"
            return f'<mtd style="{side}">{display}</mtd>' if aligned else f"<mtd>{inner}</mtd>"

        return one


def mathml(latex, block):
    """A formula as MathML."""
    try:
        parser = Parser(latex)
        inner = parser.row([])
        assert parser.peek()[0] == "end of formula", f"unexpected {parser.peek()[1]}"
    except (ValueError, IndexError, KeyError, AssertionError) as error:
        sys.exit(f"mathml: {error!r} in: {latex}")
    return f'<math{" display=" + chr(34) + "block" + chr(34) if block else ""}><mrow>{inner}</mrow></math>'


TAG = re.compile(r"\\tag\{([^}]*)\}")
EQUATION = '<div style="display: flex; align-items: center; overflow: auto hidden; gap: 1em; padding: 0.5em 0"><div style="flex: 1">{}</div><div>{}</div></div>'


def equation(latex):
    """A block with its label at the right."""
    tag = TAG.search(latex)
    label = f"({html.escape(tag[1].replace('$', ''))})" if tag else ""
    return EQUATION.format(mathml(TAG.sub("", latex), True), label)


BLOCK = re.compile(r"^```math\n(.*?)^```$", re.DOTALL | re.MULTILINE)
INLINE = re.compile(r"\$`([^`]+)`\$")


def escaped(text):
    """MathML inside of a paragraph, where stars, bars and the like would be Markdown."""
    return re.sub(r"(?<=>)[^<]+", lambda found: re.sub(r"[*_|\[\]~^\\]", lambda sign: f"&#{ord(sign[0])};", found[0]), text)


def page(text):
    """A chapter with its mathematics typeset."""
    text = BLOCK.sub(lambda found: equation(found[1]) + "\n", text)
    return INLINE.sub(lambda found: escaped(mathml(found[1], False)), text)


def convert(items):
    for item in items:
        if isinstance(item, dict) and "Chapter" in item:
            chapter = item["Chapter"]
            chapter["content"] = page(chapter["content"])
            convert(chapter["sub_items"])


def main():
    if len(sys.argv) > 1 and sys.argv[1] == "supports":
        sys.exit(sys.argv[2] != "html")
    _, book = json.load(sys.stdin)
    convert(book.get("items") or book.get("sections"))
    json.dump(book, sys.stdout)


if __name__ == "__main__":
    main()
