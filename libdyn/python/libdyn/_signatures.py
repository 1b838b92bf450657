# SPDX-License-Identifier: BSD-2-Clause
"""Signatures of compiled functions, as their docstrings give them.

pybind11 begins a docstring with `name(self: libdyn.SE3, x: float = 1.0) -> float`, once for each overload. Types there are those of results;
an argument may be more: a sequence for a list, anything like an array for an array.
"""
from __future__ import annotations

import dataclasses
import inspect
import re
from typing import Any, Optional

BRACKETS = {"(": ")", "[": "]", "{": "}"}


@dataclasses.dataclass
class Parameter:
    name: str
    type: Optional[str] = None
    default: Optional[str] = None
    kind: Any = inspect.Parameter.POSITIONAL_OR_KEYWORD


@dataclasses.dataclass
class Signature:
    parameters: list[Parameter]
    result: Optional[str]
    doc: str


def end_of(text: str, start: int, stops: str) -> int:
    """Returns the index of the first of the characters `stops` that is in no bracket and no string, or len(text)."""
    open_brackets: list[str] = []
    k = start
    while k < len(text):
        c = text[k]
        if not open_brackets and c in stops:
            return k
        if c in BRACKETS:
            open_brackets.append(BRACKETS[c])
        elif open_brackets and c == open_brackets[-1]:
            open_brackets.pop()
        elif c in "'\"":
            k += 1
            while k < len(text) and text[k] != c:
                k += 2 if text[k] == "\\" else 1
        k += 1
    return len(text)


def parts_of(text: str, separator: str = ",") -> list[str]:
    """Splits a text at the separators that are in no bracket and no string."""
    parts: list[str] = []
    start = 0
    while start < len(text):
        end = end_of(text, start, separator)
        parts.append(text[start:end].strip())
        start = end + 1
    return parts


def parameters_of(text: str) -> list[Parameter]:
    """Reads `self: libdyn._core.SE3, x: float = 1.0, *, y: int`."""
    out: list[Parameter] = []
    kind: Any = inspect.Parameter.POSITIONAL_OR_KEYWORD
    for part in parts_of(text):
        if part == "*":
            kind = inspect.Parameter.KEYWORD_ONLY
        elif part == "/":
            for parameter in out:
                parameter.kind = inspect.Parameter.POSITIONAL_ONLY
        elif part.startswith("*"):
            kind_of_rest = inspect.Parameter.VAR_KEYWORD if part.startswith("**") else inspect.Parameter.VAR_POSITIONAL
            out.append(Parameter(part.lstrip("*").split(":")[0], "object", None, kind_of_rest))
        else:
            name, _, rest = part.partition(":")
            type_end = end_of(rest, 0, "=")
            default = rest[type_end + 1 :].strip() or None
            out.append(Parameter(name.strip(), rest[:type_end].strip(), default, kind))
    return out


def read_one(text: str) -> Optional[Signature]:
    """Reads one signature and the text after it; returns None if it does not begin with one. Getters may have no name."""
    head = re.match(r"\w*\(", text)
    if head is None:
        return None
    end = end_of(text, head.end(), ")")
    if not text.startswith(") -> ", end):
        return None
    result, _, doc = text[end + 5 :].partition("\n")
    return Signature(parameters_of(text[head.end() : end]), result.strip(), doc.strip())


def read(docstring: str) -> list[Signature]:
    """Returns the signatures at the head of a function's docstring, one for each overload; none if it has no types."""
    overloaded = re.match(r"(\w+)\(\*args, \*\*kwargs\)\nOverloaded function\.\n", docstring)
    if overloaded is None:
        one = read_one(docstring)
        return [one] if one else []
    texts = re.split(rf"^\d+\. (?={overloaded[1]}\()", docstring[overloaded.end() :], flags=re.MULTILINE)
    return [one for one in map(read_one, texts[1:]) if one]
