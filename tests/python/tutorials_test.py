# SPDX-License-Identifier: BSD-2-Clause
"""The tutorials run with numpy alone, and their assertions hold. tools/docs runs them with pictures."""
import contextlib
import io
import pathlib
import runpy
import sys
import unittest

TUTORIALS = pathlib.Path(__file__).parents[2] / "libdyn" / "python" / "tutorials"


class Tutorials(unittest.TestCase):
    def setUp(self):
        sys.path.insert(0, str(TUTORIALS))
        self.addCleanup(sys.path.remove, str(TUTORIALS))
        sys.modules["matplotlib"] = None  # cannot be imported, as where it is not installed
        for module in ("matplotlib", "support"):
            self.addCleanup(sys.modules.pop, module, None)

    def test_every_tutorial_proves_its_claims(self):
        scripts = sorted(set(TUTORIALS.glob("*.py")) - {TUTORIALS / "support.py"})
        self.assertEqual(len(scripts), 8)
        for script in scripts:
            with self.subTest(script.stem), contextlib.redirect_stdout(io.StringIO()):
                runpy.run_path(str(script), run_name="__main__")


if __name__ == "__main__":
    unittest.main()
