# SPDX-License-Identifier: BSD-2-Clause
"""Type stubs agree with the module, and typed programs pass mypy --strict. It needs Debian's package mypy."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest

import libdyn.pinocchio

HERE = pathlib.Path(__file__).parent
SOURCE = HERE.parents[2]
PACKAGE = pathlib.Path(libdyn.__file__).parent


def run(module, *arguments):
    """Runs a tool of mypy on the module of the build tree; returns its exit status and what it printed."""
    path = str(PACKAGE.parent)
    environment = {**os.environ, "PYTHONPATH": path, "MYPYPATH": path, "MYPY_CACHE_DIR": f"{path}/mypy_cache"}
    done = subprocess.run([sys.executable, "-m", module, *map(str, arguments)], cwd=HERE, env=environment, capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


def snippets():
    """Returns the Python programs in the documents."""
    text = (SOURCE / "libdyn" / "doc" / "python.md").read_text()
    return re.findall(r"^```python\n(.*?)^```$", text, flags=re.MULTILINE | re.DOTALL)


def functions_of(module):
    """Yields (name, function, whether its first argument is an object) of the public functions and methods that are written in this package."""
    for name, thing in vars(module).items():
        members = vars(thing).items() if isinstance(thing, type) else [("", thing)]
        for member, value in members:
            function = getattr(value, "__func__", getattr(value, "fget", value))
            if not isinstance(function, types.FunctionType) or not function.__module__.startswith(module.__name__):
                continue
            # Functions that other functions make have none of their own.
            if "<" not in function.__qualname__ and not re.match("_[a-z]|__getattr__", function.__name__):
                yield f"{name}.{member}".rstrip("."), function, bool(member) and not isinstance(value, staticmethod)


class Types(unittest.TestCase):
    def test_stubs_have_what_the_module_has(self):
        # Modules in Python have their types in their sources, which mypy itself compares.
        sources = [path.relative_to(PACKAGE).with_suffix("") for path in PACKAGE.rglob("*.py") if path.name != "__init__.py"]
        sources += [path.relative_to(PACKAGE).parent for path in PACKAGE.glob("*/__init__.py")]
        with tempfile.NamedTemporaryFile("w") as allowlist:
            allowlist.writelines(f"libdyn\\.{'.'.join(path.parts)}\\..*\n" for path in sources)
            allowlist.flush()
            status, report = run("mypy.stubtest", "libdyn", "--allowlist", allowlist.name, "--ignore-unused-allowlist", "--mypy-config-file", HERE / "mypy.ini")
        self.assertEqual(status, 0, report)

    def test_the_package_and_programs_pass_strict_checks(self):
        with tempfile.TemporaryDirectory() as folder:
            programs = [HERE / "program.py", HERE / "pinocchio_program.py"]
            for k, text in enumerate(snippets()):
                programs.append(pathlib.Path(folder) / f"snippet_{k}.py")
                programs[-1].write_text(text)
            self.assertGreater(len(programs), 4)
            status, report = run("mypy", "--strict", *programs[:2], *sorted(PACKAGE.rglob("_core/*.pyi")), PACKAGE / "__init__.py")
            self.assertEqual(status, 0, report)
            # The documents leave types of parameters out, as most scripts do.
            status, report = run("mypy", "--strict", "--allow-untyped-defs", "--allow-untyped-calls", "--allow-untyped-decorators", *programs[2:])
        self.assertEqual(status, 0, report)

    def test_wrong_programs_are_found(self):
        wrong = """
import libdyn as dyn
model = dyn.compile(dyn.Model())
dyn.rnea(model, model, [0.0], [0.0], [0.0])  # no data
dyn.compile(dyn.Model(), locks={})  # no such option
model.nq = 3  # read-only
model.joint(3)  # a name is a str
dyn.SE3().act(None)  # nothing to act on
dyn.SE3.translations(0, 0, 1)  # no such function
x: str = dyn.neutral(model)
import libdyn.pinocchio as pin
robot = pin.buildSampleModelManipulator()
pin.rnea(robot, robot, pin.neutral(robot), [0.0], [0.0])  # no data
pin.rneas  # no such function
robot.createData().oMj  # no such field
robot.createData().oMi[0].rotations  # no such property
y: str = pin.crba(robot, robot.createData(), pin.neutral(robot))
"""
        status, report = run("mypy", "--strict", "-c", wrong)
        lines = re.findall(r"^<string>:(\d+): error", report, flags=re.MULTILINE)
        self.assertEqual(sorted(set(lines), key=int), ["4", "5", "6", "7", "8", "9", "10", "13", "14", "15", "16", "17"], report)

    def test_the_typed_programs_run(self):
        for program in ("program.py", "pinocchio_program.py"):
            done = subprocess.run([sys.executable, HERE / program, SOURCE / "models" / "biped.urdf"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stderr)

    def test_functions_of_the_package_pinocchio_have_types(self):
        checked, untyped = 0, []
        for name, function, bound in functions_of(libdyn.pinocchio):
            parameters = function.__code__.co_argcount + function.__code__.co_kwonlyargcount - bound
            checked += 1
            if len(function.__annotations__) < parameters + 1:
                untyped.append(name)
        self.assertEqual(untyped, [])
        self.assertGreater(checked, 500)


if __name__ == "__main__":
    unittest.main()
