# SPDX-License-Identifier: BSD-2-Clause
"""filter.py FILE: prepares a source file for Doxygen. Line numbers stay as they are, so that Doxygen's messages name the right lines.

Markdown: headings get GitHub's anchors, and links lead to pages of the site; a link to a file that is no page becomes its path.
Headers: the symbols of each header make a group of their own, below a group for each folder. Special member functions need no words.
"""
import html
import os
import re
import sys


def is_page(path):
    """Returns whether the site has a page of a file of the source tree: of Markdown, and of tutorials (tutorials.py)."""
    return path.endswith(".md") or (path.startswith("libdyn/python/tutorials/") and path.endswith(".py"))


def page_of(path):
    """Returns the name of the page of a file of the source tree."""
    if path == "README.md":
        return "index"
    path = re.sub(r"^libdyn/(doc/|python/(?=tutorials/))", "", os.path.splitext(path)[0])
    return re.sub(r"[^a-z0-9]+", "_", path.lower())


def anchor_of(page, heading):
    """Returns the anchor that GitHub gives a heading, made unique by the page's name."""
    words = re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")
    return f"{page}-{words}"


def readable_code(line):
    """Writes code spans with quotation marks or tags in a way that Doxygen reads rightly."""

    def span(match):
        if re.search(r"'|\\\|", match[1]):
            return f"<code>{html.escape(match[1]).replace('&#x27;', '&apos;')}</code>"
        return f"`{match[0]}`" if re.search("[<>]", match[1]) else match[0]

    return re.sub(r"`([^`]+)`", span, line)


def markdown(path, lines):
    page = page_of(path)
    folder = os.path.dirname(path)

    def link(match):
        picture, text, target = match.groups()
        if re.match(r"[a-z]+:", target):
            return match[0]
        target, _, anchor = target.partition("#")
        file = os.path.normpath(os.path.join(folder, target)) if target else path
        if picture:
            return f"![{text}]({os.path.basename(file)})"
        if not is_page(file):
            return f"{text} (`{file}`)" if text.strip("`") != os.path.basename(file) else f"`{file}`"
        page_there = page_of(file)
        return f"[{text}](@ref {page_there}-{anchor})" if anchor else f"[{text}](@ref {page_there})"

    in_code = False
    for line in lines:
        if line.startswith("```"):
            in_code = not in_code
        heading = re.match(r"(#+) (.*)", line)
        if in_code or line.startswith("    "):
            pass
        elif heading and heading[1] == "#":
            line = "# " + heading[2].replace("`", "") + f" {{#{'mainpage' if page == 'index' else page}}}"
        elif heading:
            line = f"{line} {{#{anchor_of(page, heading[2])}}}"
        else:
            line = readable_code(re.sub(r"(!?)\[((?:`[^`]*`|[^\]`])*)\]\(([^) ]+)\)", link, line))
        yield line


def header(path, lines):
    name = re.search(r"/(?:include|sdk)/(.*)", path)[1]
    group = re.sub(r"\W", "_", name)
    parent = re.sub(r"\W", "_", os.path.dirname(name))
    described, opens = False, False
    for line in lines:
        if line.startswith("// SPDX"):
            line = f"/** \\defgroup {group} {name}"
        elif line.startswith("//") and not described:
            line = line[2:]
        elif line.startswith("#pragma once"):
            line = f"\\ingroup {parent} */"
            described = True
        elif re.match(r"namespace dyn\b.*\{$", line):
            line += f" /** \\addtogroup {group}"
            opens = True
        elif opens:
            line = "\\{ */ " + line
            opens = False
        elif re.match(r"\}  // namespace dyn\b", line):
            line = "/** \\} */ " + line
        else:
            line = re.sub(r"^ *(constexpr )?(\w+)\((const )?\2&&?( \w+)?\)( noexcept)?( = (default|delete))?;.*", "", line)
            line = re.sub(r"^ *(\w+)& operator=\((const )?\1&&?( \w+)?\).*;.*", "", line)
            line = re.sub(r"^ *(virtual )?~\w+\(.*;.*", "", line)
            if "///" in line:
                line = readable_code(line)
        yield line


if __name__ == "__main__":
    path = os.path.relpath(sys.argv[1])
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    filters = {".md": markdown, ".hpp": header}
    print("\n".join(filters.get(os.path.splitext(path)[1], lambda _, unchanged: unchanged)(path, lines)))
