#!/usr/bin/env python3
"""Checks the built book: every relative link leads to a file and an anchor, and no formula is left as LaTeX.

    check_book.py BOOK

BOOK is the directory of HTML pages that scripts/make_book makes. Ends with an error that names each link that leads nowhere and each page with LaTeX.
"""

import html.parser
import pathlib
import sys
import urllib.parse

# Repeats every chapter in one page, with links that are relative to the chapters.
PRINTED = "print.html"
# What `mathml.py` replaces, as mdBook writes it if that script did not run.
LATEX = ('class="language-math"', "$<code>")


class Page(html.parser.HTMLParser):
    """What a page links to, and the anchors that it has."""

    def __init__(self, path):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.anchors.add(value)
            elif name in ("href", "src") and value:
                self.links.append(value)


def anchors(file, known={}):
    if file not in known:
        known[file] = Page(file).anchors
    return known[file]


def broken(file, link):
    """What is wrong with a link of a page, or nothing."""
    parts = urllib.parse.urlsplit(link)
    if parts.scheme or parts.netloc or link == "/":
        return None
    target = (file.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else file
    if not target.exists():
        return "no such file"
    fragment = urllib.parse.unquote(parts.fragment)
    if fragment and target.suffix == ".html" and fragment not in anchors(target):
        return "no such anchor"
    return None


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    book = pathlib.Path(sys.argv[1]).resolve()
    pages = [page for page in sorted(book.rglob("*.html")) if page.name not in (PRINTED, "404.html")]
    links = [(page, link) for page in pages for link in Page(page).links]
    errors = [f"{page.relative_to(book)}: {link}: {why}" for page, link in links if (why := broken(page, link))]
    errors += [f"{page.relative_to(book)}: LaTeX" for page in pages if any(sign in page.read_text(encoding="utf-8") for sign in LATEX)]
    print("\n".join([*errors, f"{len(links)} links on {len(pages)} pages, {len(errors)} errors"]))
    sys.exit(1 if errors or not links else 0)


if __name__ == "__main__":
    main()
