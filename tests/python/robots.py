# SPDX-License-Identifier: BSD-2-Clause
"""Robots of several tests."""
import numpy as np

import libdyn as dyn


def ball():
    """A ball above the ground."""
    model = dyn.Model()
    model.add_body("ball", 0, dyn.JointDescription("free", "free_flyer"), dyn.Inertia(1.0, [0, 0, 0], 0.004 * np.eye(3)))
    model.add_geometry("ball_volume", "ball", dyn.Sphere(0.1))
    model.add_geometry("ground", 0, dyn.HalfSpace())
    return model
