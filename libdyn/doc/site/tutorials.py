# SPDX-License-Identifier: BSD-2-Clause
"""tutorials.py FOLDER: runs the tutorials, and writes a page of each to FOLDER, as Doxygen reads it, with its output and pictures.

The order is that of libdyn/doc/tutorials.md. An exception of a tutorial ends the program.
"""
import contextlib
import html
import io
import os
import pathlib
import re
import sys

import matplotlib

import filter as site

SCRIPTS = "libdyn/python/tutorials"
INK = "#123456"  # stands for the page's text colour, which is light or dark
STYLE = {
    "svg.fonttype": "none",
    "font.family": "sans-serif",
    "font.size": 9,
    "axes.titlesize": 10,
    "axes.prop_cycle": matplotlib.cycler(color=["#2f7fd6", "#d9622b", "#2a9d5f", "#a45bc4", "#b58a00"]),
    "figure.facecolor": "none",
    "axes.facecolor": "none",
    "savefig.facecolor": "none",
    "legend.frameon": False,
    **dict.fromkeys(["text.color", "axes.edgecolor", "axes.labelcolor", "axes.titlecolor", "xtick.color", "ytick.color", "grid.color"], INK),
}


def cells_of(text):
    """Yields each cell of a script: whether it is prose, the number of its first line, and its lines. What comes before the first cell is left out."""
    lines = text.split("\n")
    starts = [k for k, line in enumerate(lines) if line.startswith("# %%")] + [len(lines)]
    for start, end in zip(starts, starts[1:]):
        body = lines[start + 1 : end]
        while body and not body[-1]:
            body.pop()
        yield "[markdown]" in lines[start], start + 2, body


def prose(lines):
    return [line[2:] if line.startswith("# ") else line.lstrip("#") for line in lines]


def raw(text):
    return ["", rf"\htmlonly[block]{text}\endhtmlonly", ""]


def drawing(figure, salt):
    """Returns a figure as an SVG element for the middle of a page."""
    matplotlib.rcParams["svg.hashsalt"] = salt
    file = io.StringIO()
    figure.savefig(file, format="svg", metadata={"Date": None, "Creator": None, "Format": None, "Type": None})
    svg = file.getvalue()
    svg = svg[svg.index("<svg") :].replace(INK, "currentColor")
    # The clip paths and markers of all figures of a page share its names.
    svg = re.sub(r'(id="|href="#|url\(#)', rf"\g<1>{salt}-", svg)
    titles = ", ".join(filter(None, (axes.get_title() for axes in figure.axes)))
    return svg.replace("<svg", f'<svg role="img" aria-label="{html.escape(titles)}"', 1)


def page_of(script, neighbours):
    """Runs a script; returns the Markdown lines of its page."""
    from matplotlib import pyplot

    path = f"{SCRIPTS}/{script}"
    namespace = {"__name__": "__main__", "__file__": os.path.abspath(path)}
    out = []
    for is_prose, first, lines in cells_of(pathlib.Path(path).read_text(encoding="utf-8")):
        if is_prose:
            out += site.markdown(path, ["", *prose(lines), ""])
            continue
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(compile("\n" * (first - 1) + "\n".join(lines), path, "exec"), namespace)
        figures = [drawing(pyplot.figure(number), f"figure{first}") for number in pyplot.get_fignums()]
        pyplot.close("all")
        if figures and lines[0].startswith("@picture"):  # how a picture is drawn says little about libdyn
            lines = []
        if lines:
            out += ["", "```python", *lines, "```", ""]
        if printed.getvalue():
            out += raw(f'<pre class="output">{html.escape(printed.getvalue().rstrip())}</pre>')
        for svg in figures:
            out += raw(f'<div class="figure">{svg}</div>')
    before, after = neighbours
    end = [f"The script of this page is `{path}`."]
    end += [f"Before: [{title_of(before)}]({before})."] if before else []
    end += [f"Next: [{title_of(after)}]({after})."] if after else []
    return [*out, *site.markdown(path, ["", " ".join(end)])]


def title_of(script):
    return re.search("^# # (.*)", pathlib.Path(SCRIPTS, script).read_text(encoding="utf-8"), re.MULTILINE)[1]


def main(folder):
    matplotlib.use("agg")
    matplotlib.rcParams.update(STYLE)
    sys.path.insert(0, SCRIPTS)
    listed = re.findall(r"\(\.\./python/tutorials/(\w+\.py)\)", pathlib.Path("libdyn/doc/tutorials.md").read_text(encoding="utf-8"))
    there = {path.name for path in pathlib.Path(SCRIPTS).glob("*.py")} - {"support.py"}
    if set(listed) != there:
        sys.exit(f"libdyn/doc/tutorials.md and {SCRIPTS} differ: {', '.join(sorted(set(listed) ^ there))}")
    folder.mkdir(parents=True, exist_ok=True)
    for before, script, after in zip([None, *listed], listed, [*listed[1:], None]):
        # Doxygen reads this suffix as Markdown, too, and filter.py leaves it as it is.
        (folder / script).with_suffix(".markdown").write_text("\n".join(page_of(script, (before, after))), encoding="utf-8")


main(pathlib.Path(sys.argv[1]))
