#!/usr/bin/env python3
"""Finds sentences that are too long, in the pages, in the comments of the shipped cases and in the documentation of the sources:

    scripts/check_sentences.py [--words 35] [FILE]...

Prints file:line and the number of words. Code blocks and formulas do not count; each cell of a table is a text of its own.
Ends with an error if there is one.
"""

import argparse
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PAGES = ["*.md", "docs/src/**/*.md", "crates/**/*.md", "scripts/*.md"]
SOURCES = ["crates/**/*.rs", "tests/**/*.rs", "fuzz/**/*.rs"]
CASES = ["cases/*.toml"]

# What ends a paragraph or begins one: headings, list items, rules of tables.
ITEM = re.compile(r"^\s*([*+-]|\d+[.)])\s+")
# A sentence ends before an upper-case letter, a figure, code or a link.
END = re.compile(r"(?<=[.!?])[)\"'*_]*\s+(?=[\"'(*_\[]*[A-Z0-9`\[])")
# Initials of a name follow a comma, a bracket, "and", or other initials; "det J." ends a sentence.
ABBREVIATIONS = re.compile(r"\b(e\.g|i\.e|cf|et al|vs|Eq|Fig|Sec|No)\.\s|(?:^|(?<=[,(&>/] )|(?<=\()|(?<=and )|(?<=[A-Z][,.] ))[A-Z]\.\s")
LINK = re.compile(r"!?\[([^\]]*)\]\([^)]*\)")
CODE = re.compile(r"\$?`+[^`]*`+\$?")


def markdown(lines):
    """Paragraphs of numbered lines of Markdown: lists of (number, text)."""
    fence, code, paragraph = False, False, []
    for number, line in lines:
        bare = line.strip()
        if bare.startswith("```"):
            fence, begins = not fence, True
        elif fence:
            continue
        else:
            code = line.startswith("    ") and (code or not paragraph)
            begins = code or not bare or bare[0] in "#|" or ITEM.match(line)
        if begins and paragraph:
            yield paragraph
            paragraph = []
        if fence or code or bare.startswith("```") or not bare:
            continue
        if bare.startswith("|"):
            yield from ([(number, cell)] for cell in cells(bare))
        else:
            paragraph.append((number, ITEM.sub("", line, count=1).strip()))
        if bare.startswith("#"):
            yield paragraph
            paragraph = []
    if paragraph:
        yield paragraph


def cells(row):
    """The cells of a row of a table; code may hold bars."""
    return CODE.sub("code", row).strip("|").split("|")


def marked(lines, mark):
    """Blocks of comments: runs of lines that begin with the mark, numbered, without it."""
    block = []
    for number, line in enumerate(lines, 1):
        found = mark.match(line)
        if found:
            block.append((number, found[1]))
        elif block:
            yield block
            block = []
    if block:
        yield block


def texts(path):
    """The paragraphs of a file."""
    lines = path.read_text(encoding="utf-8").splitlines()
    if path.suffix == ".md":
        blocks = [list(enumerate(lines, 1))]
    else:
        mark = r"\s*//[/!] ?(.*)" if path.suffix == ".rs" else r"#(?!:schema) ?(.*)"
        blocks = marked(lines, re.compile(mark))
    for block in blocks:
        yield from markdown(block)


def sentences(paragraph):
    """The sentences of a paragraph: (number of the line where it begins, words)."""
    text, starts = "", []
    for number, line in paragraph:
        starts.append((len(text), number))
        text += line + " "
    # Of the same length, so that places still tell their lines.
    same = lambda found, sign: sign * len(found[0])
    text = CODE.sub(lambda found: same(found, "C"), text)
    text = LINK.sub(lambda found: found[1].ljust(len(found[0])), text)
    text = ABBREVIATIONS.sub(lambda found: found[0].replace(".", ","), text)
    place = 0
    for end in [found.end() for found in END.finditer(text)] + [len(text)]:
        first = max(number for start, number in starts if start <= place)
        yield first, words(text[place:end])
        place = end


def words(sentence):
    """How many words: a piece of code is one, signs are none."""
    return sum(any(map(str.isalnum, word)) for word in sentence.split())


def files():
    """All files that are read, but for those that a build made."""
    found = (path for pattern in PAGES + SOURCES + CASES for path in ROOT.glob(pattern))
    return sorted(path for path in found if "target" not in path.relative_to(ROOT).parts)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--words", type=int, default=35)
    parser.add_argument("files", nargs="*", type=Path)
    arguments = parser.parse_args()
    found = 0
    for path in arguments.files or files():
        for paragraph in texts(path.resolve()):
            for line, count in sentences(paragraph):
                if count > arguments.words:
                    found += 1
                    print(f"{path.resolve().relative_to(ROOT)}:{line}: {count} words")
    print(f"{found} sentences of more than {arguments.words} words")
    sys.exit(found > 0)


if __name__ == "__main__":
    main()
