# SPDX-License-Identifier: BSD-2-Clause
"""Errors of the package's own Python code, with the attributes of those of the library."""

from ._core import Error


def error(code: str, message: str, file: str = "", line: int = 0) -> Error:
    """Returns an Error whose message begins with its place."""
    place = f"{file}:{line}: " if line else f"{file}: " if file else ""
    out = Error(place + message)
    out.code, out.file, out.line, out.joint = code, file, line, ""
    return out
