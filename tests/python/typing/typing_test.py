# SPDX-License-Identifier: BSD-2-Clause
"""Type stubs agree with the module, and typed programs pass mypy --strict. It needs Debian's package mypy."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

import libdyn

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
            programs = [HERE / "program.py"]
            for k, text in enumerate(snippets()):
                programs.append(pathlib.Path(folder) / f"snippet_{k}.py")
                programs[-1].write_text(text)
            self.assertGreater(len(programs), 3)
            status, report = run("mypy", "--strict", *programs[:1], *sorted(PACKAGE.rglob("_core/*.pyi")), PACKAGE / "__init__.py")
            self.assertEqual(status, 0, report)
            # The documents leave types of parameters out, as most scripts do.
            status, report = run("mypy", "--strict", "--allow-untyped-defs", "--allow-untyped-calls", "--allow-untyped-decorators", *programs[1:])
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
"""
        status, report = run("mypy", "--strict", "-c", wrong)
        lines = re.findall(r"^<string>:(\d+): error", report, flags=re.MULTILINE)
        self.assertEqual(sorted(set(lines), key=int), ["4", "5", "6", "7", "8", "9", "10"], report)

    def test_the_typed_program_runs(self):
        done = subprocess.run([sys.executable, HERE / "program.py", SOURCE / "models" / "biped.urdf"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)


if __name__ == "__main__":
    unittest.main()
