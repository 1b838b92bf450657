# SPDX-License-Identifier: BSD-2-Clause
"""The wheel has everything that the module needs, and the build backend answers pip."""
import importlib.metadata
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

import libdyn

SOURCE = pathlib.Path(__file__).parents[2]
# Its folder must not get into sys.path: processes that other tests start would find the package's sources there, without the compiled part.
SPEC = importlib.util.spec_from_file_location("build_backend", SOURCE / "libdyn" / "python" / "build_backend.py")
build_backend = importlib.util.module_from_spec(SPEC)
SPEC.loader.exec_module(build_backend)

sys.path.pop(0)  # processes that other tests start would find the package without its compiled part there


class Wheel(unittest.TestCase):
    def test_a_wheel_works_away_from_the_build_tree(self):
        build = pathlib.Path(libdyn.__file__).parents[2]
        with tempfile.TemporaryDirectory() as folder:
            name = build_backend.pack(build, folder)
            site = pathlib.Path(folder) / "site"
            with zipfile.ZipFile(pathlib.Path(folder) / name) as wheel:
                wheel.extractall(site)
                recorded = {line.split(",")[0] for line in wheel.read(f"libdyn-{build_backend.VERSION}.dist-info/RECORD").decode().split()}
                self.assertEqual(recorded, set(wheel.namelist()))
            for file in ("py.typed", "_core/__init__.pyi", "_core/cholesky.pyi", "include/dyn_sdk/joint_plugin.hpp"):
                self.assertIn(f"libdyn/{file}", recorded)
            self.assertFalse([name for name in recorded if "__pycache__" in name])
            (found,) = importlib.metadata.distributions(name="libdyn", path=[str(site)])
            self.assertEqual((found.version, found.requires, found.metadata["Requires-Python"]), (libdyn.__version__, ["numpy"], ">=3.9"))
            for path in site.rglob("*"):
                path.chmod(0o755)
            program = """
import libdyn, libdyn.pinocchio, sys
assert libdyn.pinocchio.buildSampleModelHumanoid().nv == 34
model = libdyn.compile(libdyn.load(sys.argv[1], root="free_flyer"))
data = libdyn.Data(model)
print(libdyn.rnea(model, data, libdyn.neutral(model), [0.0] * model.nv, [0.0] * model.nv)[2])
maps = open("/proc/self/maps").read()
for library in ("libdyn.so", "libdyn_parsers.so", "dyn_standard.so", "_core"):
    assert any(library in line and sys.argv[2] in line for line in maps.splitlines()), library
assert sys.argv[3] not in maps
"""
            answer = subprocess.run(
                [sys.executable, "-c", program, SOURCE / "models" / "biped.urdf", str(site), f"{build}/"],
                env={"PATH": os.environ["PATH"], "PYTHONPATH": str(site)}, cwd=folder, capture_output=True, text=True)
            self.assertEqual(answer.returncode, 0, answer.stderr)
            self.assertGreater(float(answer.stdout), 100)

    def test_metadata_are_there_before_a_build(self):
        with tempfile.TemporaryDirectory() as folder:
            name = build_backend.prepare_metadata_for_build_wheel(folder)
            self.assertEqual(importlib.metadata.PathDistribution(pathlib.Path(folder) / name).version, libdyn.__version__)

    def test_a_build_needs_no_network_where_numpy_is_installed(self):
        self.assertEqual(build_backend.get_requires_for_build_wheel(), [])

    def test_what_there_is_not_says_what_to_do_instead(self):
        with self.assertRaisesRegex(SystemExit, "PYTHONPATH=build/python"):
            build_backend.build_editable(".")
        with self.assertRaisesRegex(SystemExit, "pip wheel ./libdyn/python"):
            build_backend.build_sdist(".")

    def test_a_build_for_another_python_is_not_packed(self):
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "python" / "libdyn").mkdir(parents=True)
            with self.assertRaisesRegex(SystemExit, "no module for this Python"):
                build_backend.pack(pathlib.Path(folder), folder)


if __name__ == "__main__":
    unittest.main()
