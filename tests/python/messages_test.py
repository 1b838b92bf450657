# SPDX-License-Identifier: BSD-2-Clause
"""Errors name what Python has, the argument that does not fit, and what is accepted; objects are printed with readable numbers."""
import pathlib
import re
import types
import unittest

import numpy as np

import libdyn as dyn
from libdyn import _core, _names

SOURCE = pathlib.Path(__file__).parents[2]
# These write C++.
WRITERS = {"libdyn/src/traced_joint/source.cpp"}


def literals():
    """Yields (file:line, text) of the string literals of the library and its readers."""
    for folder in ("libdyn/src", "libdyn/include", "parsers"):
        for path in sorted((SOURCE / folder).rglob("*.[ch]pp")):
            name = str(path.relative_to(SOURCE))
            for line, text in enumerate(path.read_text().split("\n"), 1):
                if name not in WRITERS and not text.lstrip().startswith(("//", "#")):
                    yield from ((f"{name}:{line}", found) for found in re.findall(r'"((?:[^"\\]|\\.)*)"', text))


def arm():
    model = dyn.Model()
    model.name = "arm"
    model.add_body("rod", 0, dyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]}), dyn.Inertia(2.0, [0, 0, -1.0], 0.01 * np.eye(3)))
    return model


class Names(unittest.TestCase):
    def test_no_message_has_names_of_cpp(self):
        # Text in quotes is a program's own.
        spelled = [(place, re.sub(r"(?<!\w)'[^']*'", "", _names.in_python(text))) for place, text in literals() if re.search(r"\w::\w", text)]
        self.assertGreater(len(spelled), 40)
        self.assertEqual([x for x in spelled if "::" in x[1] and "C++" not in x[1]], [])

    def test_functions_have_their_names_of_python(self):
        cases = {
            "crba: data was made without Need::mass_matrix; make it as Data(model, Need::mass_matrix)": "crba: data was made without "
            "Need.MASS_MATRIX; make it as Data(model, Need.MASS_MATRIX)",
            "call forwardKinematics(model, data, q) first": "call forward_kinematics(model, data, q) first",
            "Simulator::setController: the model's joint": "Simulator.set_controller: the model's joint",
            "cholesky::decompose, computeRNEADerivatives": "cholesky.decompose, compute_rnea_derivatives",
            "'leftKnee' of 'a::b', setController": "'leftKnee' of 'a::b', set_controller",
            "or load it with Trust::any": "or load it with trust='any'",
            "(GeometryOptions::packages, --package)": "(the argument packages, --package)",
            "a camelCase word that is no function": "a camelCase word that is no function",
        }
        for text, wanted in cases.items():
            self.assertEqual(_names.in_python(text), wanted)

    def test_errors_of_calls_are_pythons(self):
        model = dyn.compile(arm())
        cases = [
            (lambda: dyn.frame_placement(model, dyn.Data(model), 1), r"frame_placement: .* call forward_kinematics\(model, data, q\) first"),
            (lambda: dyn.crba(model, dyn.Data(model, dyn.Need.STATE), [0.0]), r"without (Need\.MASS_MATRIX); make it as Data\(model, \1\)"),
            (lambda: dyn.crba(model, dyn.BatchData(model, 1, dyn.Need.STATE), [[0.0]]), r"the batch was made without Need\.MASS_MATRIX"),
            (lambda: dyn.Simulator(model).reset([0.0, 0.0], [0.0]), r"^Simulator\.reset: q has 2 entries"),
        ]
        for call, text in cases:
            with self.assertRaisesRegex(dyn.Error, text) as caught:
                call()
            self.assertTrue(str(caught.exception).endswith(caught.exception.remedy))

    def test_a_path_in_a_message_stays_what_it_is(self):
        with self.assertRaises(dyn.Error) as caught:
            dyn.load("no/forwardKinematics Need::mass_matrix.urdf")
        self.assertEqual(caught.exception.file, "no/forwardKinematics Need::mass_matrix.urdf")
        self.assertIn("no/forwardKinematics Need::mass_matrix.urdf", str(caught.exception))


class Arguments(unittest.TestCase):
    def test_the_argument_that_does_not_fit_is_named(self):
        description = arm()
        model = dyn.compile(description)
        data, q, X = dyn.Data(model), [0.0], dyn.SE3()
        acts_on = "a Motion, a Force, an Inertia or an array of numbers with shape (3,) or (m, 3)"
        cases = [
            (lambda: dyn.compute_frame_jacobian(model, data, q, "rod", 7), "compute_frame_jacobian: reference must be a ReferenceFrame, not 7"),
            (
                lambda: dyn.compute_frame_jacobian(model, data, np.zeros((2, 3), np.float32), 1),
                "compute_frame_jacobian: q must be an array of numbers with shape (n,), not an array of float32 with shape (2, 3)",
            ),
            (lambda: dyn.neutral(description), "neutral: model must be a CompactModel, not a Model; compile(model) makes one"),
            (
                lambda: dyn.Simulator(description),
                "Simulator: model must be a CompactModel or a ConstraintSet, not a Model; compile(model) makes one",
            ),
            (lambda: X.act(np.zeros(4)), f"SE3.act: x must be {acts_on}, not an array of float64 with shape (4,)"),
            (lambda: X.act(model), f"SE3.act: x must be {acts_on}, not a CompactModel"),
            (lambda: dyn.SE3(np.eye(3), [1, 2]), "SE3: p must be an array of numbers with shape (3,), not a list of 2 numbers"),
            (lambda: dyn.Sphere("a"), "Sphere: radius must be a number, not 'a'"),
            (lambda: dyn.Data(), "Data misses the argument 'model'"),
            (lambda: dyn.Inertia(1, [0, 0, 0], np.eye(3), 4), "Inertia takes 3 positional arguments but 4 were given"),
            (lambda: dyn.Simulator(model, integratr="rk4"), "Simulator has no argument 'integratr'; did you mean 'integrator'?"),
            (lambda: dyn.Sphere(1, colour=3), "Sphere has no argument 'colour'; it takes radius"),
            (lambda: setattr(description, "gravity", [1, 2]), "Model.gravity must be 3 numbers, not a list of 2 numbers"),
            (lambda: setattr(description.bodies[1].joint, "lower", "a"), "JointDescription.lower must be a number or a list of numbers, not 'a'"),
            (lambda: description.bodies["rod"], "BodyList.__getitem__: index must be an integer or a slice, not 'rod'"),
            (lambda: dyn.compile(description, outputs=[1, "a"]), "compile: outputs must be a list, each element a str, not a list of int or str"),
            (lambda: dyn.compile(description, lock=3), "compile: lock must be a dict whose values are a number, a list of numbers or None, not 3"),
            (lambda: dyn.load("robot.urdf", root=3), "load: root must be a str, not 3"),
        ]
        for call, text in cases:
            with self.assertRaises(TypeError) as caught:
                call()
            self.assertEqual(str(caught.exception), text)

    def test_every_function_answers_in_one_line(self):
        class Other:
            pass

        asked = 0
        for scope in (_core, _core.cholesky, _core.srdf, *(x for x in vars(_core).values() if isinstance(x, type))):
            if isinstance(scope, type) and (issubclass(scope, (tuple, Exception)) or hasattr(scope, "__members__")):
                continue
            for name, thing in vars(scope).items():
                function = getattr(scope, name)
                if not callable(function) or name in ("__class__", "__new__", "__init_subclass__", "__subclasshook__", "__getattribute__"):
                    continue
                if isinstance(function, type) and isinstance(scope, types.ModuleType) and function.__doc__ and hasattr(function, "__members__"):
                    continue
                for arguments in ((Other(),), (Other(),) * 3, (Other(),) * 30):
                    try:
                        function(*arguments)
                    except TypeError as problem:
                        asked += 1
                        self.assertNotIn("incompatible", str(problem), f"{scope.__name__}.{name}")
                        self.assertNotIn("\n", str(problem), f"{scope.__name__}.{name}")
                    except dyn.Error:
                        pass
        self.assertGreater(asked, 1000)

    def test_callbacks_are_told_what_they_must_return(self):
        def run(controller=None, event=None, finder=None):
            simulator = dyn.Simulator(dyn.compile(arm()))
            simulator.set_controller(controller)
            simulator.set_events([("top", event, "rising")] if event else [])
            if finder:
                simulator.set_contacts(dyn.ContactFinder(finder))
            simulator.advance(0.01)

        cases = [
            ({"controller": lambda t, q, v: "a"}, "the controller must return an array of numbers, not an object of type str"),
            ({"controller": lambda t, q, v: None}, "the controller must return an array of numbers, not None"),
            ({"event": lambda t, q, v: "a"}, "the function of an event must return a number, not an object of type str"),
            ({"finder": lambda q, reach: ["a"]}, "the finder of contacts must return a list of ContactPoint, not an object of type list"),
        ]
        for callbacks, text in cases:
            with self.assertRaises(TypeError) as caught:
                run(**callbacks)
            self.assertEqual(str(caught.exception), text)

    def test_errors_of_a_callback_keep_their_own_words(self):
        def controller(t, q, v):
            raise TypeError("f(): incompatible function arguments. It is mine")

        simulator = dyn.Simulator(dyn.compile(arm()))
        simulator.set_controller(controller)
        with self.assertRaisesRegex(TypeError, "It is mine"):
            simulator.step()


class Texts(unittest.TestCase):
    def test_numbers_are_printed_as_numpy_prints_them(self):
        noisy = 0.1 + 0.2
        self.assertEqual(repr(dyn.Motion([noisy, 1 / 3, 0], [-0.0, 1e-17, 1e300])), "Motion([0.3, 0.33333333, 0.0], [0.0, 1e-17, 1e+300])")
        self.assertTrue(repr(dyn.SE3.translation(noisy, np.nan, -np.inf)).endswith(", [0.0, 0.0, 1.0]], [0.3, nan, -inf])"))
        self.assertTrue(repr(dyn.Inertia(noisy)).startswith("Inertia(0.3, [0.0, 0.0, 0.0], [[0.0,"))
        self.assertEqual((repr(dyn.Sphere(noisy)), repr(dyn.Box(1, 2, noisy))), ("Sphere(0.3)", "Box(1.0, 2.0, 0.3)"))
        with np.printoptions(precision=3):
            self.assertEqual(repr(dyn.Force([1 / 3, 2 / 3, 1e-9])), "Force([0.333, 0.667, 1e-09], [0.0, 0.0, 0.0])")

    def test_needs_are_printed_as_they_are_written(self):
        need = dyn.Need
        self.assertEqual((repr(need.STATE), repr(need.MASS_MATRIX)), ("Need.STATE", "Need.MASS_MATRIX"))
        self.assertEqual(repr(need.MASS_MATRIX | need.DERIVATIVES), "Need.MASS_MATRIX|Need.DERIVATIVES")

    def test_parts_of_a_model_say_their_names(self):
        model = arm()
        model.add_frame("tip", "rod")
        self.assertEqual(repr(model.bodies), "[<body 'universe'>, <body 'rod'>]")
        self.assertEqual((repr(model.frames[0]), repr(model.joint("hinge"))), ("<frame 'tip'>", "<joint 'hinge' of type revolute>"))
        compiled = dyn.compile(model)
        self.assertEqual(repr(dyn.Data(compiled)), "<libdyn.Data of 'arm'>")
        self.assertEqual(repr(dyn.BatchDataFloat(compiled, 5, threads=2)), "<libdyn.BatchDataFloat: at most 5 states, 2 threads>")


if __name__ == "__main__":
    unittest.main()
