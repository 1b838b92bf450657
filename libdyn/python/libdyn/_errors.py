# SPDX-License-Identifier: BSD-2-Clause
"""Errors of the package's own Python code, with the attributes of those of the library."""

from ._core import Error


def error(code: str, message: str, file: str = "", line: int = 0) -> Error:
    """Returns an Error whose message begins with its place."""
    place = f"{file}:{line}" if line else file
    out = Error(f"{place}: {message}" if place else message)
    out.code, out.file, out.line, out.joint, out.place = code, file, line, "", place
    out.remedy = message.rpartition("; ")[2] if "; " in message else ""
    return out
