# SPDX-License-Identifier: BSD-2-Clause
"""Support of the tests that sweep: a folder for each test, and a skip where dyn cannot sweep."""
import os
import pathlib
import tempfile
import unittest

import libdyn as dyn

ARM = pathlib.Path(__file__).parents[2] / "models" / "arm.urdf"


class SweepTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            with tempfile.TemporaryDirectory() as folder:
                dyn.sweep({"model": str(ARM), "task": "compute", "functions": ["com"], "samples": 1}, folder + "/out")
        except dyn.Error as problem:
            if "without HDF5" in str(problem) or "is not there" in str(problem):
                if os.environ.get("DYN_REQUIRE_ALL") == "1":
                    raise
                raise unittest.SkipTest(str(problem))
            raise

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
