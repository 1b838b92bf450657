# SPDX-License-Identifier: BSD-2-Clause
"""Writes type stubs of the compiled module, whose sources editors and type checkers cannot read.

    python3 stubs.py MODULE FOLDER

imports the shared object MODULE (libdyn/_core...so) and writes FOLDER/__init__.pyi, and FOLDER/NAME.pyi for each of its submodules. The build runs
it whenever the module changes, so stubs are never older than the module.
"""
import contextlib
import importlib.util
import inspect
import pathlib
import re
import sys
import types

from signatures import NoPythonType, Parameter, Signature, Types, literal, read, read_untyped

NAME = "libdyn._core"
NOTE = "# Written by libdyn/python/stubs.py from the compiled module."
IMPORTS = {
    "_typeshed": ["structseq"],
    "collections.abc": ["Callable", "Iterable", "Iterator", "Mapping", "Sequence", "Set as AbstractSet"],
    "typing": ["Any", "ClassVar", "Generic", "Literal", "NoReturn", "Optional", "Protocol", "TypeVar", "Union", "final", "overload"],
    "os": ["PathLike"],
    "pathlib": ["Path"],
    "numpy": ["float32", "float64"],
    "numpy.typing": ["ArrayLike", "NDArray"],
}
# The base of all pybind11 classes; attributes that take more than they give; numbers of a named tuple of arrays.
TYPES = '''
_Scalar = TypeVar("_Scalar", float32, float64)
_Read = TypeVar("_Read", covariant=True)
_Write = TypeVar("_Write", contravariant=True)

class _pybind11_type(type): ...
class _pybind11_object(metaclass=_pybind11_type):
    """A class without a constructor of its own: programs get its objects from functions."""
    def __init__(self, *args: NoReturn, **kwargs: NoReturn) -> None: ...

class _Attribute(Protocol[_Read, _Write]):
    def __get__(self, instance: object, owner: Optional[type[Any]] = None, /) -> _Read: ...
    def __set__(self, instance: Any, value: _Write, /) -> None: ...
'''

# Functions of the catalogue have no types in their signatures, but names that say them.
ARRAY = "numpy.ndarray[numpy.float64, flags.writeable]"
ARRAYS = f"tuple[{ARRAY}, ...]"
CATALOGUE = {"model": "CompactModel", **dict.fromkeys(("q", "v", "a", "tau"), "numpy.ndarray"), "fext": "Optional[numpy.ndarray]"}

# Special methods that come with every object.
INHERITED = {"__module__", "__doc__", "__dict__", "__weakref__", "__new__", "__members__", "__entries", "__hash__", "__annotations__"}
INHERITED |= {"__qualname__", "__getstate__", "__setstate__", "__reduce__", "__static_attributes__", "__firstlineno__", "__orig_bases__"}


def docstring(text, indent):
    """Returns the lines of a docstring at this indent."""
    text = inspect.cleandoc(text or "").replace("\\", "\\\\").replace('"""', '\\"\\"\\"')
    if not text:
        return []
    if text.endswith('"'):
        text += " "
    first, *rest = text.split("\n")
    lines = [f'{indent}"""{first}'] + [f"{indent}{line}".rstrip() for line in rest]
    if rest:
        return [*lines, f'{indent}"""']
    return [lines[0] + '"""']


class Writer:
    """The stub of one module."""

    def __init__(self, module, classes):
        self.module, self.types, self.lines = module, Types("libdyn", classes), []

    def parameters(self, name, signature, method):
        out, kinds = [], inspect.Parameter
        # pybind11 calls parameters arg0, arg1... that can be given by position only.
        unnamed = iter(["key", "value"] if name in ("__getitem__", "__setitem__", "__delitem__") else ["other"])
        for p in signature.parameters[method:]:
            if re.fullmatch(r"arg\d+", p.name):
                if (known := next(unnamed, None)) is None:
                    raise NoPythonType(f"its parameter {p.name} has no name")
                p = Parameter(known, p.type, p.default, kinds.POSITIONAL_ONLY)
            if p.kind is not kinds.POSITIONAL_ONLY and out and out[-1].kind is kinds.POSITIONAL_ONLY:
                out.append(Parameter("/"))
            if p.kind is kinds.KEYWORD_ONLY and not any(x.kind in (kinds.KEYWORD_ONLY, kinds.VAR_POSITIONAL) for x in out):
                out.append(Parameter("*", kind=kinds.KEYWORD_ONLY))
            out.append(p)
        if out and out[-1].kind is kinds.POSITIONAL_ONLY:
            out.append(Parameter("/"))
        texts = ["self"] if method else []
        for p in out:
            stars = {kinds.VAR_POSITIONAL: "*", kinds.VAR_KEYWORD: "**"}.get(p.kind, "")
            default = f" = {literal(p.default)}" if p.default is not None else ""
            kind = self.types.argument(p.type) if p.type else ""
            # pybind11 takes None for pointers, and does not say so.
            kind = f"Optional[{kind}]" if p.default == "None" and not kind.startswith(("Optional", "Any", "None", "object")) else kind
            texts.append(f"{stars}{p.name}: {kind}{default}" if p.type else p.name)
        return ", ".join(texts)

    def function(self, name, signatures, indent="", method=False, static=False):
        # Overloads for a vector and a matrix are one here: both take arrays.
        heads = {}
        for s in signatures:
            result = "None" if name == "__init__" else self.types.result(s.result)
            heads.setdefault(f"{indent}def {name}({self.parameters(name, s, method)}) -> {result}:", docstring(s.doc, indent + "    "))
        for head, doc in heads.items():
            self.lines += [f"{indent}@overload"] if len(heads) > 1 else []
            self.lines += [f"{indent}@staticmethod"] if static else []
            self.lines += [head, *doc] if doc else [head + " ..."]

    def method(self, name, value, indent):
        signatures = read(getattr(value, "__func__", value).__doc__ or "")
        if not signatures and name == "__init__":
            return  # of a class that programs do not make
        if not signatures:
            raise NoPythonType(f"the docstring of {name} has no signature")
        if name in ("__eq__", "__ne__"):
            signatures = [Signature(signatures[0].parameters, "bool", signatures[0].doc)]
            signatures[0].parameters[1].type = "object"
        if name == "__iter__":
            signatures[0].result = f"Iterator[{self.element}]"
        self.function(name, signatures, indent, method=not isinstance(value, staticmethod), static=isinstance(value, staticmethod))

    def attribute(self, name, value, indent):
        """A property. One that takes more than it gives is a descriptor, because mypy wants a property to take and give the same."""
        (getter,) = read(value.fget.__doc__)
        read_type = self.types.result(getter.result)
        write_type = None
        if value.fset is not None:
            (setter,) = read(value.fset.__doc__)
            write_type = self.types.argument(setter.parameters[1].type)
        doc = docstring(value.__doc__, indent)
        if write_type not in (None, read_type):
            self.lines += [f"{indent}{name}: _Attribute[{read_type}, {write_type}]", *doc]
            return
        body = docstring(value.__doc__, indent + "    ")
        self.lines += [f"{indent}@property", f"{indent}def {name}(self) -> {read_type}:" + ("" if body else " ..."), *body]
        if write_type:
            self.lines += [f"{indent}@{name}.setter", f"{indent}def {name}(self, value: {write_type}) -> None: ..."]

    def constant(self, name, value, indent="", owner=None):
        kind = type(value)
        text = kind.__name__ if kind.__module__ == "builtins" or kind.__name__ in self.types.classes else "Any"
        # Values of an enumeration belong to its class; others stand for what each object has.
        self.lines.append(f"{indent}{name}: {f'ClassVar[{text}]' if kind is owner else text}")

    def class_(self, cls):
        if issubclass(cls, tuple):
            return self.named_tuple(cls)
        foreign = [b for b in cls.__bases__ if b.__name__ != "pybind11_object"]
        bases = ", ".join(b.__name__ for b in foreign) or "_pybind11_object"
        indent = "    "
        self.lines += ["", f"class {cls.__name__}({bases}):", *docstring(cls.__doc__, indent)]
        if "__members__" in vars(cls):
            self.lines.append(f"{indent}__members__: ClassVar[dict[str, {cls.__name__}]]")
        if vars(cls).get("__hash__", cls) is None:
            self.lines.append(f"{indent}__hash__: ClassVar[None]  # type: ignore[assignment]")
        items = read((getattr(cls, "__getitem__", None) or cls).__doc__ or "")
        self.element = items[0].result if items else "object"
        entries = vars(cls).get("__entries", {})  # of an enumeration: values and their docstrings
        for name, value in vars(cls).items():
            if name in INHERITED or name.startswith("_pybind11"):
                continue
            with place(f"{cls.__name__}.{name}"):
                if isinstance(value, property):
                    self.attribute(name, value, indent)
                elif callable(value) or isinstance(value, staticmethod):
                    self.method(name, value, indent)
                else:
                    self.constant(name, value, indent, cls)
                    self.lines += docstring(entries.get(name, ("", ""))[1], indent)
        return None

    def named_tuple(self, cls):
        fields = [name for name, value in vars(cls).items() if isinstance(value, types.MemberDescriptorType)]
        arrays = ", ".join(["NDArray[_Scalar]"] * len(fields))
        self.lines += ["", "@final", f"class {cls.__name__}(structseq[NDArray[_Scalar]], tuple[{arrays}], Generic[_Scalar]):"]
        self.lines += docstring(cls.__doc__, "    ")
        self.lines += ["    if sys.version_info >= (3, 10):", f"        __match_args__ = {tuple(fields)}"]
        for name in fields:
            self.lines += ["    @property", f"    def {name}(self) -> NDArray[_Scalar]:", *docstring(vars(cls)[name].__doc__ or "", "        ")]
            self.lines[-1] += "" if self.lines[-1].endswith('"') else " ..."

    def catalogue(self, name, function):
        """A function of the catalogue: an overload for each kind of data, and one for `out=` of several results."""
        base = read_untyped(function)
        several = f"{name}_result" if hasattr(self.module, f"{name}_result") else None

        def overload(data, scalar, out=None):
            parameters = []
            for p in base.parameters:
                kind = {"data": data, "out": out}.get(p.name) or CATALOGUE.get(p.name)
                if p.name in ("fext", "out") and data != "Data":
                    continue  # of single states only
                if kind is None:
                    raise NoPythonType(f"the parameter '{p.name}' has no type; begin the docstring with a typed signature, as pybind11 does")
                parameters.append(Parameter(p.name, kind, None if out == ARRAYS and p.name == "out" else p.default, p.kind))
            result = out if out == ARRAYS else f"{several}[{scalar}]" if several else f"numpy.ndarray[numpy.{scalar}]"
            return Signature(parameters, result, base.doc)

        overloads = [overload("Data", "float64", out) for out in (["None", ARRAYS] if several else [f"Optional[{ARRAY}]"])]
        if "BatchData" in base.doc:
            overloads += [overload("BatchData", "float64"), overload("BatchDataFloat", "float32")]
        self.function(name, overloads)

    def contents(self):
        """Writes classes first: a name of a class is then known wherever it stands."""
        members = {name: value for name, value in vars(self.module).items() if not name.startswith("__") or name == "__version__"}
        for value in members.values():
            if isinstance(value, type):
                self.class_(value)
        self.lines.append("")
        for name, value in members.items():
            if isinstance(value, types.ModuleType):
                self.lines.append(f"from . import {name} as {name}")
            elif callable(value) and not isinstance(value, type):
                signatures = read(value.__doc__ or "")
                with place(name):
                    self.function(name, signatures) if signatures else self.catalogue(name, value)
            elif not isinstance(value, type):
                self.constant(name, value)

    def write(self, path):
        self.contents()
        main = self.module.__name__ == NAME
        text = (TYPES if main else "") + "\n".join(self.lines) + "\n"
        used = set(re.findall(r"\w+", text))
        head = [*docstring(self.module.__doc__, ""), NOTE, *(["import sys"] if "sys" in used else [])]
        for module, names in IMPORTS.items():
            mine = [name for name in names if name.split()[-1] in used]
            head += [f"from {module} import {', '.join(mine)}"] if mine else []
        foreign = sorted(self.types.classes & used - set(vars(self.module)))
        head += [f"from . import {', '.join(foreign)}"] if foreign else []
        path.write_text("\n".join(head) + "\n" + text)


problems = []


@contextlib.contextmanager
def place(name):
    """Goes on after a signature without Python types, so that all of them are reported at once."""
    try:
        yield
    except NoPythonType as problem:
        problems.append(f"{name}: {problem}")


def main(module_path, folder):
    spec = importlib.util.spec_from_file_location(NAME, module_path)
    core = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(core)
    classes = {name for name, value in vars(core).items() if isinstance(value, type)}
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    Writer(core, classes).write(folder / "__init__.pyi")
    for name, value in vars(core).items():
        if isinstance(value, types.ModuleType):
            Writer(value, classes | {c for c, x in vars(value).items() if isinstance(x, type)}).write(folder / f"{name}.pyi")
    if problems:
        sys.exit("\n".join(["libdyn/python/stubs.py cannot write types:", *problems, NoPythonType.__doc__]))


if __name__ == "__main__":
    main(*sys.argv[1:])
