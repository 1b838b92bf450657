# SPDX-License-Identifier: BSD-2-Clause
"""check_links.py FOLDER: checks that each link between the pages in a folder leads to a page and to a place on it, and that the menu has each document."""
import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    def __init__(self, path):
        super().__init__()
        self.places, self.links = set(), []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("id", "name") and value:
                self.places.add(value)
            elif name in ("href", "src", "data") and value:
                self.links.append(value)


folder = pathlib.Path(sys.argv[1])
pages = {path.name: Page(path) for path in folder.glob("*.html")}
problems = []
for name, page in pages.items():
    for link in page.links:
        url = urllib.parse.urlparse(link)
        if url.scheme:
            continue
        there, place = urllib.parse.unquote(url.path) or name, urllib.parse.unquote(url.fragment)
        if not (folder / there).exists():
            problems.append(f"{name}: the link {link} leads nowhere")
        elif place and there in pages and place not in pages[there].places:
            problems.append(f"{name}: {there} has no place '{place}'")
for document in pathlib.Path("libdyn/doc").glob("*.md"):
    if f"{document.stem}.html" not in pages["index.html"].links:
        problems.append(f"libdyn/doc/site/header.html: the menu has no link to {document.stem}.html")
print("\n".join(problems), file=sys.stderr, end="\n" if problems else "")
print(f"{len(pages)} pages, {sum(len(page.links) for page in pages.values())} links")
sys.exit(bool(problems))
