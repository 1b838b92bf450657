# SPDX-License-Identifier: BSD-2-Clause
"""Results that pass through Python agree with the project's references as those of C++ do (tests/truth/data_sets.hpp has the same bounds)."""
import json
import pathlib
import unittest

import numpy as np

import libdyn as dyn

SOURCE = pathlib.Path(__file__).parents[2]
TYPES = dyn.JointRegistry.standard()
TYPES.load_directory(pathlib.Path(dyn.__file__).parents[2] / "examples")

# Each function has its arguments, and each of its results a reference, the reference of its scale, and the largest error in units of 2^-53.
FUNCTIONS = {
    "rnea": ("qva", [("rnea", "rnea_scale", 10)]),
    "non_linear_effects": ("qv", [("nle", "rnea_scale", 10)]),
    "generalized_gravity": ("q", [("gravity", "rnea_scale", 10)]),
    "aba": ("qvt", [("aba", "aba_scale", 4)]),
    "crba": ("q", [("M", None, 15)]),
    "compute_joint_jacobians": ("q", [("J", None, 15)]),
    "jacobian_center_of_mass": ("q", [("Jcom", None, 15)]),
    "ccrba": ("qv", [("hg", None, 15), ("Ag", None, 15)]),
    "compute_centroidal_momentum_time_variation": ("qva", [("hg", None, 15), ("dhg", None, 30), ("Ag", None, 15), ("dAg", None, 30)]),
    "compute_minverse": ("q", [("Minv", None, 100)]),
    "compute_rnea_derivatives": ("qva", [("dtau_dq", None, 100), ("dtau_dv", None, 100), ("M", None, 15)]),
    "compute_aba_derivatives": ("qvt", [("ddq_dq", None, 100), ("ddq_dv", None, 100), ("Minv", None, 100), ("aba", "aba_scale", 4)]),
    "compute_coriolis_matrix": ("qv", [("coriolis_matrix", None, 100)]),
    "compute_centroidal_dynamics_derivatives": (
        "qva", [("dhg_dq", None, 100), ("dhgdot_dq", None, 100), ("dhgdot_dv", None, 100), ("Ag", None, 15)]),
}


def numbers(texts):
    return np.array([float(x) for x in texts])


class References(unittest.TestCase):
    def check(self, name, result, truth, key, scale, most):
        if key not in truth:
            return 0
        reference = numbers(truth[key])
        size = numbers(truth[scale]) if scale else np.abs(reference).max()
        error = np.abs(result.reshape(-1) - reference)
        worst = np.max(np.divide(error, size, out=np.where(error > 0, np.inf, 0.0), where=np.broadcast_to(size, error.shape) > 0)) * 2**53
        self.assertLessEqual(worst, most, f"{name}: {key}")
        return 1

    def test_every_function_of_the_catalogue_agrees_with_its_references(self):
        compared = dict.fromkeys(FUNCTIONS, 0)
        for path in sorted((SOURCE / "tests" / "truth" / "references").glob("*.json")):
            document = json.loads(path.read_text())
            description = dyn.load(SOURCE / document["file"], root=document["root"], mimic=document.get("mimic", "independent"))
            model = dyn.compile(description, dissipation=False, armature=False, registry=TYPES)
            data = dyn.Data(model)
            for sample in document["samples"]:
                inputs = {"q": sample["q"], "v": sample["v"], "a": sample["a"], "t": sample["tau"]}
                for name, (arguments, outputs) in FUNCTIONS.items():
                    if name == "compute_joint_jacobians" and document.get("mimic") == "coupled":
                        continue
                    results = getattr(dyn, name)(model, data, *(inputs[x] for x in arguments))
                    for result, output in zip((results,) if len(outputs) == 1 else results, outputs):
                        compared[name] += self.check(f"{path.stem}: {name}", result, sample["truth"], *output)
        self.assertGreater(min(compared.values()), 10, compared)

    def test_no_function_of_the_catalogue_is_forgotten(self):
        def takes_out(thing):
            return "out=None" in (getattr(thing, "__text_signature__", None) or "")

        catalogue = {name for name in dir(dyn) if takes_out(getattr(dyn, name))}
        self.assertEqual(catalogue - {"compute_static_torque"}, set(FUNCTIONS))


if __name__ == "__main__":
    unittest.main()
