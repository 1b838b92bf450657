# SPDX-License-Identifier: BSD-2-Clause
"""The generator of type stubs reads signatures as pybind11 writes them."""
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "libdyn" / "python"))

import signatures  # noqa: E402


class Signatures(unittest.TestCase):
    types = signatures.Types("libdyn._core", {"SE3", "Motion"})

    def test_defaults_may_have_commas_brackets_and_quotes(self):
        array = "numpy.ndarray[numpy.float64[3, 1]] = array([0., 1.])"
        text = f"f(self: libdyn._core.SE3, a: float = 1.5, *, b: {array}, c: str = 'x, ) = y') -> None\n\nDoes it.\n"
        (one,) = signatures.read(text)
        self.assertEqual([(p.name, p.default) for p in one.parameters], [("self", None), ("a", "1.5"), ("b", "array([0., 1.])"), ("c", "'x, ) = y'")])
        self.assertEqual([p.kind.name for p in one.parameters], ["POSITIONAL_OR_KEYWORD"] * 2 + ["KEYWORD_ONLY"] * 2)
        self.assertEqual((one.result, one.doc), ("None", "Does it."))
        self.assertEqual([signatures.literal(p.default) for p in one.parameters[1:]], ["1.5", "...", "'x, ) = y'"])

    def test_each_overload_has_its_own_text(self):
        text = "f(*args, **kwargs)\nOverloaded function.\n\n1. f(x: int) -> int\n\nOne.\n\n2. f(x: str) -> str\n\nTwo, not 1. f of it.\n"
        self.assertEqual([(s.result, s.doc) for s in signatures.read(text)], [("int", "One."), ("str", "Two, not 1. f of it.")])

    def test_a_docstring_without_types_has_no_signature(self):
        self.assertEqual(signatures.read("f(x, y)\n--\n\nDoes it."), [])

    def test_arguments_take_more_than_results_give(self):
        vector = "numpy.ndarray[numpy.float64[m, 1]]"
        writeable = "numpy.ndarray[numpy.float64[m, n], flags.writeable, flags.f_contiguous]"
        cases = [
            (vector, "ArrayLike", "NDArray[float64]"),
            (writeable, "NDArray[float64]", "NDArray[float64]"),
            ("List[str]", "Sequence[str]", "list[str]"),
            ("List[float[3]]", "ArrayLike", "list[float]"),
            ("Dict[str, Union[float, List[float]]]", "Mapping[str, Union[float, ArrayLike]]", "dict[str, Union[float, list[float]]]"),
            ("Tuple[libdyn._core.SE3, libdyn._core.Motion]", "tuple[SE3, Motion]", "tuple[SE3, Motion]"),
            ("object", "object", "Any"),
        ]
        for text, argument, result in cases:
            self.assertEqual((self.types.argument(text), self.types.result(text)), (argument, result))

    def test_a_callback_gets_results_and_returns_an_argument(self):
        text = "Callable[[float, numpy.ndarray[numpy.float64]], numpy.ndarray[numpy.float64]]"
        self.assertEqual(self.types.argument(text), "Callable[[float, NDArray[float64]], ArrayLike]")

    def test_types_of_cpp_are_refused(self):
        for text in ("dyn::Model", "std::vector<int>", "libdyn._core.Unknown", "List[dyn::Contact]"):
            with self.assertRaises(signatures.NoPythonType):
                self.types.result(text)


if __name__ == "__main__":
    unittest.main()
