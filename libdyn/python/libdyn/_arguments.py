# SPDX-License-Identifier: BSD-2-Clause
"""What is wrong with a call of a compiled function: the argument that does not fit, what it is, and what is accepted.

pybind11 tries one signature after the other, and fails without a reason. explain() compares the arguments with the signatures once more.
"""
from __future__ import annotations

import collections.abc
import difflib
import inspect
import os
import re
from typing import Any, Optional

import numpy as np

from . import _core
from ._signatures import Parameter, Signature, end_of, parts_of, read

_KINDS = inspect.Parameter
_UNIONS = ("Union", "Optional")
_REMEDIES = {("Model", "CompactModel"): "; compile(model) makes one"}


def explain(function: str, doc: str, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Optional[str]:
    """Returns the text of a TypeError for a call; None if the signatures are not understood or all arguments seem to fit."""
    function = function.lstrip("_")
    problems = [_problem(signature, arguments, keywords) for signature in read(doc)]
    if not problems or None in problems:
        return None
    # The signature that fits best is the one that was meant. Several may fail at the same argument.
    best = max(problem.rank for problem in problems if problem)
    first, *others = [problem for problem in problems if problem and problem.rank == best]
    if first.parameter is None:
        return f"{function} {first.text}"
    kinds = [first.kind, *(x.kind for x in others if x.place == first.place)]
    accepted = _either([phrase for kind in dict.fromkeys(kinds) for phrase in _phrases(kind)])
    remedy = next((text for (given, kind), text in _REMEDIES.items() if type(first.value).__name__ == given and f"a {kind}" in accepted), "")
    name = "" if first.parameter == "value" and function.count(".") == 1 and first.alone else f": {first.parameter}"
    return f"{function}{name} must be {accepted}, not {_described(first.value)}{remedy}"


class _Problem:
    """Why a call does not fit a signature. The rank is the higher, the more of the call fits."""

    def __init__(self, fitting: int, text: str = "", parameter: Optional[Parameter] = None, value: Any = None, place: int = -1, alone: bool = False):
        # An argument of the wrong type tells more than one too many, and one that is missing tells most.
        self.rank = (fitting, 1 if parameter else 2 if "misses" in text else 0)
        self.text, self.value, self.place, self.alone = text, value, place, alone
        self.parameter, self.kind = (parameter.name, parameter.type or "object") if parameter else (None, "")


def _problem(signature: Signature, arguments: tuple[Any, ...], keywords: dict[str, Any]) -> Optional[_Problem]:
    parameters = list(signature.parameters)
    unnamed = [p for p in parameters if re.fullmatch(r"arg\d+", p.name)]
    if unnamed:  # a setter, or an operator
        parameters = [Parameter("self" if k == 0 else "value", p.type, p.default, p.kind) for k, p in enumerate(parameters)]
    method = bool(parameters) and parameters[0].name == "self"
    by_position = [p for p in parameters if p.kind in (_KINDS.POSITIONAL_ONLY, _KINDS.POSITIONAL_OR_KEYWORD)]
    rest = any(p.kind is _KINDS.VAR_POSITIONAL for p in parameters)
    by_name = {p.name: p for p in parameters if p.kind is not _KINDS.VAR_POSITIONAL}
    given = list(zip(by_position, arguments)) + [(by_name[name], x) for name, x in keywords.items() if name in by_name]
    wrong = [
        (p, x, place)
        for place, (p, x) in enumerate(given)
        if not fits(p.type or "object", x) and not (x is None and p.default == "None")
    ]
    fitting = len(given) - len(wrong)
    if len(arguments) > len(by_position) and not rest:
        most, count = len(by_position) - method, len(arguments) - method
        return _Problem(fitting, f"takes {most} positional argument{'s' * (most != 1)} but {count} {'were' if count != 1 else 'was'} given")
    names = [p.name for p in parameters[method:]]
    for name in keywords:
        if name not in by_name:
            near = difflib.get_close_matches(name, names, 1)
            hint = f"; did you mean '{near[0]}'?" if near else f"; it takes {', '.join(names)}" if names else "; it takes none"
            return _Problem(fitting, f"has no argument '{name}'{hint}")
    if wrong:
        return _Problem(fitting, "", *wrong[0], alone=bool(unnamed))
    known = {p.name for p, _ in given}
    for p in parameters:
        if p.default is None and p.kind is not _KINDS.VAR_POSITIONAL and p.name not in known:
            return _Problem(fitting, f"misses the argument '{p.name}'")
    return None


def _split(kind: str) -> tuple[str, list[str]]:
    """Returns the head of a type and the types in its brackets: ("List", ["float"])."""
    start = end_of(kind, 0, "[")
    return kind[:start], parts_of(kind[start + 1 : -1]) if start < len(kind) else []


def _class(head: str) -> Optional[type]:
    found = getattr(_core, head.rpartition(".")[2], None) if head.startswith("libdyn.") else None
    return found if isinstance(found, type) else None


def _shape(inner: list[str]) -> Optional[list[Optional[int]]]:
    """Returns the shape in numpy.float64[m, 3], with None for a size that is free; no shape for an array of any."""
    match = re.match(r"numpy\.\w+\[(.*)\]", inner[0]) if inner else None
    return [int(x) if x.isdigit() else None for x in parts_of(match[1])] if match else None


def _is_sequence(x: Any) -> bool:
    return isinstance(x, (collections.abc.Sequence, np.ndarray)) and not isinstance(x, (str, bytes))


def _is_array(x: Any, inner: list[str]) -> bool:
    if "flags.writeable" in inner:
        return isinstance(x, np.ndarray) and x.flags.writeable and str(x.dtype) in inner[0] and _has_shape(x.shape, _shape(inner))
    try:
        return _has_shape(np.asarray(x, dtype=float).shape, _shape(inner))
    except (TypeError, ValueError):
        return False


def _has_shape(shape: tuple[int, ...], wanted: Optional[list[Optional[int]]]) -> bool:
    if wanted is None:
        return True
    if len(shape) == 1:  # a vector is a matrix of one column, or of one row
        n = shape[0]
        return wanted in ([n, 1], [None, 1], [1, n], [1, None], [None, n], [None, None])
    return len(shape) == 2 and all(want in (None, have) for want, have in zip(wanted, shape))


def fits(kind: str, x: Any) -> bool:
    """Returns whether pybind11 converts x to a type of a signature. Types that are not known count as fitting."""
    head, inner = _split(kind)
    cls = _class(head)
    if cls is not None:
        return isinstance(x, cls)
    if head in _UNIONS:
        return (head == "Optional" and x is None) or any(fits(k, x) for k in inner)
    if head == "numpy.ndarray":
        return _is_array(x, inner)
    if head == "List":
        element, size = re.fullmatch(r"(.*?)(?:\[(\d+)\])?", inner[0], re.DOTALL).groups() if inner else ("object", None)  # type: ignore[union-attr]
        return _is_sequence(x) and (size is None or len(x) == int(size)) and all(fits(element, e) for e in x)
    if head == "Tuple" and "..." not in inner:
        return _is_sequence(x) and len(x) == len(inner) and all(fits(k, e) for k, e in zip(inner, x))
    if head == "Dict":
        return isinstance(x, dict) and all(fits(inner[0], k) and fits(inner[1], e) for k, e in x.items())
    if head == "int":
        return hasattr(x, "__index__") and not isinstance(x, np.ndarray)
    if head == "float":
        return (hasattr(x, "__float__") or hasattr(x, "__index__")) and np.ndim(x) == 0
    if head == "None":
        return x is None
    if head in ("Callable", "function"):
        return callable(x)
    plain = {"str": (str, bytes), "os.PathLike": (str, bytes, os.PathLike), "dict": (dict,), "tuple": (tuple,), "type": (type,), "slice": (slice,)}
    return isinstance(x, plain[head]) if head in plain else True


def _phrases(kind: str) -> list[str]:
    """Returns what a type is called in a sentence, one phrase for each alternative."""
    head, inner = _split(kind)
    name = head.rpartition(".")[2]
    if _class(head) is not None:
        return [f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"]
    if head in _UNIONS:
        return [phrase for k in inner for phrase in _phrases(k)] + ["None"] * (head == "Optional")
    if head == "numpy.ndarray":
        shape, what = _shape(inner), "a writable array of float64" if "flags.writeable" in inner else "an array of numbers"
        if shape is None:
            return [what]
        if shape[-1] == 1:
            return [f"{what} with shape ({'n' if shape[0] is None else shape[0]},)"]
        return [f"{what} with shape ({', '.join(m if n is None else str(n) for n, m in zip(shape, 'mn'))})"]
    if head == "List" and inner:
        element, _, size = inner[0].rstrip("]").partition("[")
        if element in ("float", "int") and (not size or size.isdigit()):
            noun = "numbers" if element == "float" else "integers"
            return [f"{size} {noun}" if size else f"a list of {noun}"]
        return [f"a list, each element {_either(_phrases(inner[0]))}"]
    if head == "Dict" and inner:
        return [f"a dict whose values are {_either(_phrases(inner[1]))}"]
    known = {"float": "a number", "int": "an integer", "bool": "a bool", "os.PathLike": "a path", "Callable": "a function", "function": "a function",
             "List": "a list", "Tuple": f"a tuple of {len(inner)}", "Iterable": "an iterable", "NDArray": "an array of numbers"}
    return [known.get(head, kind if head in ("None", "ArrayLike", "Literal") else f"a {name}")]


def _either(phrases: list[str]) -> str:
    """Joins alternatives: a, b or c."""
    phrases = list(dict.fromkeys(phrases))
    # Arrays differ in their shapes only.
    prefix = "an array of numbers with shape "
    shapes = [x[len(prefix) :] for x in phrases if x.startswith(prefix)]
    if shapes:
        phrases = [x for x in phrases if not x.startswith(prefix)] + [prefix + " or ".join(shapes)]
    return " or ".join(filter(None, [", ".join(phrases[:-1]), phrases[-1]]))


def _described(x: Any) -> str:
    """Says what an argument is, with the shape and dtype of an array."""
    if isinstance(x, np.ndarray):
        return f"an array of {x.dtype} with shape {x.shape}"
    if x is None or isinstance(x, (bool, int, float)) or (isinstance(x, str) and len(x) < 40):
        return repr(x)
    name = type(x).__name__
    article = "an" if name[0] in "aeiouAEIOU" else "a"
    if isinstance(x, dict):
        return f"a dict of {_contents(list(x.values())) if x else '0'}"
    if isinstance(x, (list, tuple)):
        return f"{article} {name} of {_contents(x)}"
    return f"{article} {name}"


def _contents(x: Any) -> str:
    try:
        numbers = np.asarray(x, dtype=float)
        return f"{len(x)} number{'s' * (len(x) != 1)}" if numbers.ndim == 1 else f"numbers with shape {numbers.shape}"
    except (TypeError, ValueError):
        return " or ".join(sorted({type(element).__name__ for element in x}))
