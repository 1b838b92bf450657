# SPDX-License-Identifier: BSD-2-Clause
"""Results of libdyn.pinocchio agree with those of Pinocchio itself in extended precision (the folder golden of the reference data)."""
import json
import os
import pathlib
import unittest

import numpy as np

import libdyn.pinocchio as pin

SHARED = pathlib.Path(os.environ.get("DYN_SHARED", pathlib.Path(__file__).parents[3] / "shared"))
FRAMES = {"local": pin.LOCAL, "local_world_aligned": pin.LOCAL_WORLD_ALIGNED, "world": pin.WORLD}


@unittest.skipUnless(SHARED.is_dir(), "no reference data (set DYN_SHARED to the folder that has it)")
class Golden(unittest.TestCase):
    def robots(self):
        for path in sorted((SHARED / "golden").glob("*.json")):
            if path.stem != "lie_groups":
                document = json.loads(path.read_text())
                root = [pin.JointModelFreeFlyer()] if document["root"] == "free_flyer" else []
                yield document, pin.buildModelFromUrdf(SHARED / "models" / document["file"], *root)

    def compare(self, name, result, reference, expected=0.0):
        """Compares to within 1e-12 of the largest entry, or ten times the error that Pinocchio itself has in double precision."""
        reference = np.array(reference)
        result = np.asarray(result, dtype=float).reshape(reference.shape)
        error = np.abs(result - reference).max() / max(np.abs(reference).max(), 1e-300)
        self.compared += 1
        self.assertLessEqual(error, max(1e-12, 10 * expected), f"{self.robot}: {name}")

    def test_models_have_the_numbering_of_pinocchio(self):
        for document, model in self.robots():
            self.assertEqual((model.nq, model.nv, model.njoints - 1), (document["nq"], document["nv"], len(document["joints"])))
            for i, joint in enumerate(document["joints"], 1):
                found = (model.names[i], model.joints[i].shortname(), model.names[model.parents[i]], model.idx_qs[i], model.idx_vs[i], model.nqs[i])
                self.assertEqual(found, tuple(joint[key] for key in ("name", "type", "parent", "idx_q", "idx_v", "nq")))
                np.testing.assert_allclose(model.jointPlacements[i].rotation.ravel(), joint["placement_R"], atol=1e-14)
                np.testing.assert_allclose(model.jointPlacements[i].translation, joint["placement_p"], atol=1e-14)
                np.testing.assert_allclose(model.inertias[i].mass, joint["mass"], rtol=1e-13)

    def test_results_are_those_of_pinocchio(self):
        self.compared = 0
        for document, model in self.robots():
            self.robot = document["robot"]
            data = model.createData()
            for sample in document["samples"]:
                with self.subTest(robot=self.robot):
                    self.check_dynamics(model, data, sample, document["double_rel_err"])
                    self.check_frames(model, data, document, sample)
        self.assertGreater(self.compared, 1000)

    def check_dynamics(self, model, data, s, errors):
        q, v, a, tau = (np.array(s[key]) for key in ("q", "v", "a", "tau"))
        results = {
            "rnea": pin.rnea(model, data, q, v, a),
            "nle": pin.nle(model, data, q, v),
            "gravity_torque": pin.computeGeneralizedGravity(model, data, q),
            "M": pin.crba(model, data, q),
            "aba": pin.aba(model, data, q, v, tau),
            "Minv": pin.computeMinverse(model, data, q),
            "coriolis_matrix": pin.computeCoriolisMatrix(model, data, q, v),
            "Jcom": pin.jacobianCenterOfMass(model, data, q),
            "com": pin.centerOfMass(model, data, q, v, a),
            "vcom": data.vcom[0],
            "acom": data.acom[0],
            "Ag": pin.ccrba(model, data, q, v),
            "hg": data.hg.vector,
            "dAg": pin.dccrba(model, data, q, v),
            "dhg": pin.computeCentroidalMomentumTimeVariation(model, data, q, v, a).vector,
            "kinetic_energy": pin.computeKineticEnergy(model, data, q, v),
            "potential_energy": pin.computePotentialEnergy(model, data, q),
        }
        results["dtau_dq"], results["dtau_dv"], _ = pin.computeRNEADerivatives(model, data, q, v, a)
        results["ddq_dq"], results["ddq_dv"], _ = pin.computeABADerivatives(model, data, q, v, tau)
        momentum = pin.computeCentroidalDynamicsDerivatives(model, data, q, v, a)
        results.update(zip(("dhg_dq", "dhgdot_dq", "dhgdot_dv", "dhgdot_da"), momentum))
        for name, result in results.items():
            self.compare(name, np.ravel(result), s[name], errors.get(name, 0.0))

    def check_frames(self, model, data, document, s):
        q, v, a = (np.array(s[key]) for key in ("q", "v", "a"))
        pin.computeJointJacobiansTimeVariation(model, data, q, v)
        pin.forwardKinematics(model, data, q, v, a)
        pin.updateFramePlacements(model, data)
        for frame in s["oMf"]:
            M = data.oMf[model.getFrameId(frame["name"], pin.BODY)]
            self.compare(f"oMf {frame['name']}", np.concatenate([M.rotation.ravel(), M.translation]), [*frame["R"], *frame["p"]])
        for k, frame in enumerate(document["jacobian_frames"]):
            i = model.getFrameId(frame["name"], pin.BODY)
            for name, reference in FRAMES.items():
                for key, get in (("J", pin.getFrameJacobian), ("dJ", pin.getFrameJacobianTimeVariation)):
                    if f"frame{k}_{key}_{name}" in s:
                        self.compare(f"{key} {name}", get(model, data, i, reference).ravel(), s[f"frame{k}_{key}_{name}"])
            self.compare("velocity", pin.getFrameVelocity(model, data, i).vector, s[f"frame{k}_velocity_local"])
            self.compare("acceleration", pin.getFrameAcceleration(model, data, i).vector, s[f"frame{k}_acceleration_local_spatial"])
            classical = pin.getFrameClassicalAcceleration(model, data, i, pin.LOCAL_WORLD_ALIGNED)
            self.compare("classical", classical.vector, s[f"frame{k}_acceleration_world_aligned_classical"])

    def test_contacts_are_those_of_pinocchio(self):
        self.compared = 0
        for document, model in self.robots():
            if not document["contacts"]["frames"]:
                continue
            self.robot = document["robot"]
            data = model.createData()
            kind = pin.CONTACT_6D if document["contacts"]["dim"] == 6 else pin.CONTACT_3D
            frames = [model.frames[model.getFrameId(name)] for name in (x["name"] for x in document["contacts"]["frames"])]
            contacts = [pin.RigidConstraintModel(kind, model, x.parentJoint, x.placement) for x in frames]
            datas = [x.createData() for x in contacts]
            pin.initConstraintDynamics(model, data, contacts)
            for s in document["samples"]:
                q, v, tau = (np.array(s[key]) for key in ("q", "v", "tau"))
                errors = document["double_rel_err"]
                if s.get("contact_ddq") is not None:
                    ddq = pin.constraintDynamics(model, data, q, v, tau, contacts, datas)
                    self.compare("contact_ddq", ddq, s["contact_ddq"], errors["contact_ddq"])
                    self.compare("contact_lambda", data.lambda_c, s["contact_lambda"], errors["contact_lambda"])
                    forces = np.concatenate([x.contact_force.vector[: contact.size()] for x, contact in zip(datas, contacts)])
                    np.testing.assert_array_equal(forces, data.lambda_c)
                pin.computeJointJacobians(model, data, q)
                self.compare("contact_J", pin.getConstraintsJacobian(model, data, contacts, datas).ravel(), s["contact_J"], errors["contact_J"])
                for restitution, name in ((0.0, "impulse_"), (0.5, "impulse_restitution_0.5_")):
                    after = pin.impulseDynamics(model, data, q, v, contacts, datas, restitution)
                    self.compare(name, after, s[name + "v_after"], errors[name + "v_after"])
                    self.compare(name, data.impulse_c, s[name + "lambda"], errors[name + "lambda"])
        self.assertGreater(self.compared, 50)


if __name__ == "__main__":
    unittest.main()
