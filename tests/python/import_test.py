# SPDX-License-Identifier: BSD-2-Clause
"""Imports under unusual circumstances work, or say what to do. Each runs in a process of its own, and none crashes."""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import libdyn

PACKAGE = pathlib.Path(libdyn.__file__).parent
COMPUTE = """
def compute():
    robot = libdyn.Model()
    hinge = libdyn.JointDescription("hinge", "revolute", {"axis": [0, 1, 0]})
    robot.add_body("rod", 0, hinge, libdyn.Inertia(2.0, [0, 0, -1], [[0.01, 0, 0], [0, 0.01, 0], [0, 0, 0.01]]))
    model = libdyn.compile(robot)
    return libdyn.rnea(model, libdyn.Data(model), [0.0], [0.0], [1.0])[0]
"""


def run(program, *options, path=None, folder=None):
    """Runs a program by this Python; returns the finished process."""
    environment = {"PATH": os.environ["PATH"], "PYTHONPATH": str(path or PACKAGE.parent)}
    return subprocess.run([sys.executable, *options, "-c", program], env=environment, cwd=folder, capture_output=True, text=True, timeout=300)


class Imports(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def copy(self, name, compiled=True):
        """Copies the package into a folder; returns the folder."""
        shutil.copytree(PACKAGE, self.folder / name / "libdyn", ignore=None if compiled else shutil.ignore_patterns("*.so", "__pycache__"))
        return self.folder / name

    def says(self, process, *messages):
        self.assertEqual(process.returncode, 1, process.stderr)
        self.assertIn("ImportError: ", process.stderr)
        for message in messages:
            self.assertIn(message, process.stderr)

    def works(self, process, output):
        self.assertEqual((process.returncode, process.stdout.strip()), (0, output), process.stderr)

    def test_without_numpy_the_message_says_to_install_it(self):
        program = f"import sys; sys.path.insert(0, {str(PACKAGE.parent)!r}); import libdyn"
        self.says(run(program, "-I", "-S"), "libdyn needs numpy", "pip install numpy")

    def test_another_python_is_told_which_one_the_module_was_built_for(self):
        place = self.copy("other", compiled=False)
        (place / "libdyn" / "_core.cpython-36m-x86_64-linux-gnu.so").touch()
        python = f"{sys.version_info.major}.{sys.version_info.minor}"
        self.says(run("import libdyn", path=place), "was built for Python 3.6", f"this is Python {python}", "pip install ./libdyn/python")

    def test_a_package_without_its_compiled_part_says_how_to_build_it(self):
        self.says(run("import libdyn", path=self.copy("bare", compiled=False)), "has no compiled part", "tools/python")

    def test_a_library_that_is_missing_is_named(self):
        place = self.copy("alone")
        self.says(run("import libdyn", path=place), "libdyn")

    def test_the_first_of_two_installations_is_used_and_the_second_refused(self):
        other = self.folder / "second"
        other.mkdir()
        # Another installation has the same libraries at other places.
        shutil.copytree(PACKAGE, other / "python" / "libdyn")
        os.symlink(PACKAGE.parents[1] / "lib", other / "lib")
        program = COMPUTE + f"""
import sys
sys.path.append({str(other / "python")!r})
import libdyn
first = libdyn.__file__
for name in [name for name in sys.modules if name.startswith("libdyn")]:
    del sys.modules[name]
old = libdyn
sys.path.insert(0, sys.path[-1])
try:
    import libdyn
    print("imported")
except ImportError as problem:
    assert "already" in str(problem), problem
    print("refused")
libdyn = old
print(compute() == 2.01)
"""
        self.works(run(program), "refused\nTrue")

    def test_the_module_can_be_imported_again(self):
        program = COMPUTE + """
import importlib, sys
import libdyn
importlib.reload(libdyn)
for name in [name for name in sys.modules if name.startswith("libdyn")]:
    del sys.modules[name]
import libdyn
print(compute())
"""
        self.works(run(program), "2.01")

    def test_a_thread_can_import_the_module_and_others_use_it(self):
        program = COMPUTE + """
import threading
def work():
    global libdyn
    import libdyn
threads = [threading.Thread(target=work) for _ in range(4)]
for thread in threads: thread.start()
for thread in threads: thread.join()
print(compute())
"""
        self.works(run(program), "2.01")

    @unittest.skipIf(sys.version_info >= (3, 13), "the interface of subinterpreters is another")
    def test_a_subinterpreter_is_refused_and_harms_nothing(self):
        program = COMPUTE + """
import _xxsubinterpreters as interpreters
{first}
id = interpreters.create()
try:
    interpreters.run_string(id, "import libdyn")
except interpreters.RunFailedError as problem:
    assert "ImportError" in str(problem), problem  # numpy's, if it has been imported already
interpreters.destroy(id)
import libdyn
print(compute())
"""
        for first in ("", "import libdyn"):
            self.works(run(program.replace("{first}", first)), "2.01")

    def test_a_child_process_computes_with_the_batch_of_its_parent(self):
        program = COMPUTE + """
import os
import numpy as np
import libdyn
robot = libdyn.Model()
robot.add_body("ball", 0, libdyn.JointDescription("free", "free_flyer"), libdyn.Inertia(1.0))
model = libdyn.compile(robot)
batch = libdyn.BatchData(model, 100, threads=2)
q = np.tile(libdyn.neutral(model), (100, 1))
v = np.zeros((100, model.nv))
before = libdyn.rnea(model, batch, q, v, v)
child = os.fork()
if child == 0:
    same = np.array_equal(libdyn.rnea(model, batch, q, v, v), before) and compute() == 2.01
    os._exit(0 if same else 1)
print(os.waitpid(child, 0)[1], np.array_equal(libdyn.rnea(model, batch, q, v, v), before))
"""
        self.works(run(program), "0 True")


if __name__ == "__main__":
    unittest.main()
