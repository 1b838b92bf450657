# SPDX-License-Identifier: BSD-2-Clause
"""Signatures of compiled functions, as their docstrings give them, and the Python types in these.

pybind11 begins a docstring with `name(self: libdyn._core.SE3, x: float = 1.0) -> float`, once for each overload. Types there are those of results;
an argument may be more: a sequence for a list, anything like an array for an array.
"""
import ast
import dataclasses
import inspect
import re
from typing import Optional

BRACKETS = {"(": ")", "[": "]", "{": "}"}


class NoPythonType(ValueError):
    """A signature names a C++ type: the function was added before the type's class, or a bare py::object should be typed (typed.hpp)."""


@dataclasses.dataclass
class Parameter:
    name: str
    type: Optional[str] = None
    default: Optional[str] = None
    kind: inspect._ParameterKind = inspect.Parameter.POSITIONAL_OR_KEYWORD


@dataclasses.dataclass
class Signature:
    parameters: list
    result: str
    doc: str


def end_of(text, start, stops):
    """Returns the index of the first of the characters `stops` that is in no bracket and no string, or len(text)."""
    open_brackets, k = [], start
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


def parts_of(text, separator=","):
    """Splits a text at the separators that are in no bracket and no string."""
    parts, start = [], 0
    while start < len(text):
        end = end_of(text, start, separator)
        parts.append(text[start:end].strip())
        start = end + 1
    return parts


def parameters_of(text):
    """Reads `self: libdyn._core.SE3, x: float = 1.0, *, y: int`."""
    out, kind = [], inspect.Parameter.POSITIONAL_OR_KEYWORD
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


def read_one(text):
    """Reads one signature and the text after it; returns None if it does not begin with one. Getters may have no name."""
    head = re.match(r"\w*\(", text)
    if head is None:
        return None
    end = end_of(text, head.end(), ")")
    if not text.startswith(") -> ", end):
        return None
    result, _, doc = text[end + 5 :].partition("\n")
    return Signature(parameters_of(text[head.end() : end]), result.strip(), doc.strip())


def read(docstring):
    """Returns the signatures at the head of a function's docstring, one for each overload; none if it has no types."""
    overloaded = re.match(r"(\w+)\(\*args, \*\*kwargs\)\nOverloaded function\.\n", docstring)
    if overloaded is None:
        one = read_one(docstring)
        return [one] if one else []
    texts = re.split(rf"^\d+\. (?={overloaded[1]}\()", docstring[overloaded.end() :], flags=re.MULTILINE)
    return [read_one(text) for text in texts[1:]]


def read_untyped(function):
    """Returns the signature of a function that has one for `inspect`, without types."""
    parameters = []
    for p in inspect.signature(function).parameters.values():
        parameters.append(Parameter(p.name, None, None if p.default is p.empty else repr(p.default), p.kind))
    return Signature(parameters, None, inspect.getdoc(function) or "")


def literal(default):
    """Returns a default as a stub can write it: numbers and strings; `...` for the rest."""
    try:
        value = ast.literal_eval(default)
    except (ValueError, SyntaxError):
        return "..."
    return default if value is None or isinstance(value, (bool, int, float, str)) else "..."


class Types:
    """Turns types of signatures into types of stubs. `module` is the name of the compiled module, `classes` are the names of its classes."""

    PLAIN = {"None", "bool", "bytes", "float", "int", "slice", "str", "type", "Any", "ArrayLike"}
    UNTYPED = {"tuple": "tuple[Any, ...]", "dict": "dict[str, Any]", "list": "list[Any]", "Iterable": "Iterable[Any]",
               "function": "Callable[..., Any]"}
    RESULTS = {"List": "list", "Dict": "dict", "Tuple": "tuple", "Set": "set"}
    ARGUMENTS = {"List": "Sequence", "Dict": "Mapping", "Tuple": "tuple", "Set": "AbstractSet"}
    GENERIC = {"Optional", "Union", "Iterator", "Iterable", "Literal", "ClassVar", "type", "dict", "list", "tuple", "Sequence", "Mapping"}

    def __init__(self, module, classes):
        self.module, self.classes = module, classes

    def argument(self, text):
        return self._of(text, True)

    def result(self, text):
        return self._of(text, False)

    def _of(self, text, argument):
        text = text.strip()
        start = end_of(text, 0, "[")
        head, inner = text[:start], parts_of(text[start + 1 : -1]) if start < len(text) else None
        if head.startswith(self.module + "."):
            head = head[len(self.module) + 1 :]
        if head == "numpy.ndarray":
            return self._array(text, argument)
        if head == "os.PathLike":
            return "Union[str, PathLike[str]]" if argument else "Path"
        if head in ("object", "handle"):
            return "object" if argument else "Any"
        if head in self.classes:
            return head if inner is None else f"{head}[{', '.join(inner)}]"
        if inner is None:
            if head in self.PLAIN:
                return head
            if head in self.UNTYPED:
                return self.UNTYPED[head]
        elif head == "NDArray":
            return text
        elif head == "Callable":
            given, result = inner
            if given != "...":
                # A callback gets results of libdyn, and returns an argument.
                given = "[" + ", ".join(self._of(x, not argument) for x in parts_of(given[1:-1])) + "]"
            return f"Callable[{given}, {self._of(result, argument)}]"
        elif head == "Literal":
            return text
        elif head in self.RESULTS and argument and head == "List" and re.fullmatch(r"(float|int)(\[\d+\])?", inner[0]):
            return "ArrayLike"
        elif head in self.GENERIC or head in self.RESULTS:
            # A list of fixed size is List[float[3]].
            inner = [re.sub(r"\[\d+\]$", "", x) for x in inner]
            name = (self.ARGUMENTS if argument else self.RESULTS).get(head, head)
            return f"{name}[{', '.join(x if x == '...' else self._of(x, argument) for x in inner)}]"
        raise NoPythonType(f"'{text}' is no Python type")

    @staticmethod
    def _array(text, argument):
        if argument and "flags.writeable" not in text:
            return "ArrayLike"
        scalar = re.search(r"numpy\.([a-z]+\d+)", text)
        return f"NDArray[{scalar[1]}]" if scalar else "NDArray[Any]"
