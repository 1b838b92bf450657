# SPDX-License-Identifier: BSD-2-Clause
"""Everything public has a docstring, and every parameter has a name."""
import inspect
import re
import types
import unittest

import libdyn as dyn


def public(scope):
    return [(name, value) for name, value in vars(scope).items() if not name.startswith("_")]


def things(module, path="libdyn"):
    """Yields (name, object) of every public class, function, method and property."""
    for name, value in public(module):
        here = f"{path}.{name}"
        if isinstance(value, types.ModuleType):
            # libdyn.pinocchio has the functions of another module's documents.
            if value.__name__.startswith("libdyn.") and value.__name__ != "libdyn.pinocchio":
                yield here, value
                yield from things(value, here)
        elif not str(getattr(value, "__module__", None)).startswith("libdyn"):
            continue  # imported, or a number
        elif isinstance(value, type):
            yield here, value
            # Lists are pybind11's own; their constructor copies.
            if "__init__" in vars(value) and not name.endswith("List"):
                yield f"{here}.__init__", vars(value)["__init__"]
            for member, attribute in public(value):
                if hasattr(value, "__members__") and member in ("name", "value"):
                    continue  # every enumeration of pybind11 has these
                if callable(attribute) or isinstance(attribute, (property, staticmethod, classmethod)):
                    yield f"{here}.{member}", getattr(attribute, "__func__", attribute)
        elif callable(value):
            yield here, value


class Docstrings(unittest.TestCase):
    def test_everything_public_is_documented(self):
        silent = []
        for name, thing in things(dyn):
            text = inspect.getdoc(thing) or ""
            # pybind11 writes signatures itself; the rest is the documentation.
            text = re.sub(r"^(\d+\. )?\w+\(.*\) -> .*$|^\w+\(\*args, \*\*kwargs\)$|^Overloaded function\.$", "", text, flags=re.MULTILINE)
            if not name.endswith("__init__") and len(text.strip()) < 5:
                silent.append(name)
        self.assertEqual(silent, [])

    def test_every_parameter_has_a_name(self):
        unnamed = [name for name, thing in things(dyn) if not isinstance(thing, property) and re.search(r"\barg\d+\b", thing.__doc__ or "")]
        self.assertEqual(unnamed, [])

    def test_signatures_name_no_types_of_cpp(self):
        foreign = [name for name, thing in things(dyn) if re.search(r"\w::\w", thing.__doc__ or "")]
        self.assertEqual(foreign, [])

    def test_functions_of_states_say_their_shapes(self):
        returns_arrays = re.compile(r"-> (Tuple\[)?numpy\.ndarray")
        functions = [name for name, x in public(dyn) if not isinstance(x, type) and returns_arrays.search(x.__doc__ or "")]
        shape = re.compile(r"\((n[qv]|rows|states|\d+|10 \(njoints - 1\)),")
        self.assertGreater(len(functions), 20)
        self.assertEqual([name for name in functions if not shape.search(getattr(dyn, name).__doc__)], [])


if __name__ == "__main__":
    unittest.main()
