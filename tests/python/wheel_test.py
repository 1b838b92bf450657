# SPDX-License-Identifier: BSD-2-Clause
"""The wheel has everything that the module needs."""
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import zipfile

import libdyn

SOURCE = pathlib.Path(__file__).parents[2]
sys.path.insert(0, str(SOURCE / "libdyn" / "python"))

import build_backend  # noqa: E402

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


if __name__ == "__main__":
    unittest.main()
