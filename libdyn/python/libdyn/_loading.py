# SPDX-License-Identifier: BSD-2-Clause
"""Says what to do where the compiled part of libdyn cannot be imported."""
import importlib.machinery
import importlib.util
import pathlib
import re
import sys


def remedy(problem: ImportError) -> str:
    """Returns a message for an import of libdyn that ended with `problem`."""
    python = f"{sys.version_info.major}.{sys.version_info.minor}"
    folder = pathlib.Path(__file__).parent
    if not any((folder / f"_core{suffix}").exists() for suffix in importlib.machinery.EXTENSION_SUFFIXES):
        found = [path.name for path in sorted(folder.glob("_core.*.so"))]
        if not found:
            return f"libdyn in {folder} has no compiled part. tools/python builds it; `pip install ./libdyn/python` builds and installs it."
        versions = ", ".join(re.sub(r".*cpython-(\d)(\d+).*", r"\1.\2", name) for name in found)
        return (
            f"libdyn in {folder} was built for Python {versions}, and this is Python {python} ({sys.executable}). "
            f"Use that Python, or build libdyn for this one: `{sys.executable} -m pip install ./libdyn/python`."
        )
    if importlib.util.find_spec("numpy") is None:
        return f"libdyn needs numpy, which {sys.executable} (Python {python}) does not find: `pip install numpy`, or install Debian's python3-numpy."
    return f"libdyn in {folder} cannot be loaded: {problem}"
