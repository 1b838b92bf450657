# SPDX-License-Identifier: BSD-2-Clause
"""Messages of the library name classes, functions and values as C++ spells them; here they get the names that Python has for them.

Need::mass_matrix becomes Need.MASS_MATRIX, computeFrameJacobian becomes compute_frame_jacobian, Simulator::setController becomes
Simulator.set_controller. A value of an enumeration that Python gives as a text becomes that: Trust::any is trust='any'. An option is an argument.
"""
from __future__ import annotations

import functools
import re
import types
from typing import Optional

from . import _core

# Names of a program's own are in quotes. An apostrophe inside or after a word begins no quotation.
_QUOTED = r"(?<!\w)'[^']*'"
_PATH = r"\w+(?:::\w+)+"
_CAMEL = r"(?<![\w.])[a-z]\w*[a-z][A-Z]\w*"
_PIECE = re.compile(f"{_QUOTED}|{_PATH}|{_CAMEL}")


def _member(owner: object, name: str) -> Optional[str]:
    return next((x for x in (name, _core._python_name(name), name.upper()) if hasattr(owner, x)), None)


@functools.lru_cache(maxsize=None)
def _functions() -> frozenset[str]:
    """Returns the names of all functions, methods and properties."""
    out = set(vars(_core))
    for thing in vars(_core).values():
        if isinstance(thing, (type, types.ModuleType)):
            out.update(vars(thing))
    return frozenset(out)


def _path(parts: list[str]) -> str:
    *scopes, owner, name = parts
    if owner.endswith("Options"):
        return f"the argument {name}"
    holder = getattr(_core, owner, None)
    member = None if holder is None else _member(holder, name)
    if member:
        return f"{owner}.{member}"
    return f"{_core._python_name(owner)}='{name}'" if owner[:1].isupper() and name.islower() else "::".join(parts)


def _in_python(found: re.Match[str]) -> str:
    text = found[0]
    if text.startswith("'"):
        return text
    if "::" in text:
        return _path(text.split("::"))
    name = _core._python_name(text)
    return name if name in _functions() else text


def in_python(text: str) -> str:
    """Returns a message of the library in Python's names."""
    return _PIECE.sub(_in_python, text)
