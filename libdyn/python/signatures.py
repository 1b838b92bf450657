# SPDX-License-Identifier: BSD-2-Clause
"""The Python types in the signatures of compiled functions (libdyn/_signatures.py), as stubs write them."""
import ast
import inspect
import pathlib
import re
import sys

sys.path.append(str(pathlib.Path(__file__).parent / "libdyn"))
from _signatures import Parameter, Signature, end_of, parts_of, read  # noqa: E402, F401


class NoPythonType(ValueError):
    """A signature names a C++ type: the function was added before the type's class, or a bare py::object should be typed (typed.hpp)."""


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
