# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # A joint of your own
#
# This tutorial writes a joint type that libdyn does not have. You write where the joint moves its body, in one line of Python. Motion subspace,
# derivatives and every algorithm follow from it, at the speed of a joint written in C++.
#
#     tools/python libdyn/python/tutorials/your_own_joint.py

# %%
import tempfile

import numpy as np

import libdyn as dyn
from support import picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## A cam
#
# A disc turns about an axle that is not in its centre. A follower rests on it and moves up and down by twice the offset h. The coordinate is the
# angle of the disc; the follower's height is
#
#     z(q) = h (1 - cos q)
#
# The function gets q and the parameters p of one joint of this type. It returns the pose of the moved body. `parameters` names each parameter and
# its unit.


# %%
@dyn.joint(nq=1, parameters={"h": "m"})
def cam(q, p):
    """A follower on a cam: moves along z by h (1 - cos q)."""
    return dyn.SE3.translation(0, 0, p.h * (1 - dyn.cos(q[0])))


# %% [markdown]
# The function runs once, on numbers that record what is done to them. The record becomes C++, and the system's compiler makes a plugin of it. You
# can read the source:

# %%
print(dyn.joint.source(cam))

# %% [markdown]
# ## A model with the joint
#
# From now on "cam" is a joint type like "revolute". A slider of 2 kg rides on the cam.

# %%
robot = dyn.Model()
h, mass = 0.1, 2.0
slide = dyn.JointDescription("slide", "cam", {"h": h})
robot.add_body("slider", 0, slide, dyn.Inertia(mass, [0, 0, 0], 0.01 * np.eye(3)))
model = dyn.compile(robot)
data = dyn.Data(model)

angle = np.array([np.pi / 2])
dyn.forward_kinematics(model, data, angle, np.array([3.0]))
print(f"height at 90 degrees: {dyn.frame_placement(model, data, 'slider').p[2]:.3f} m")
print(f"speed at 3 rad/s:     {dyn.frame_velocity(model, data, 'slider').linear[2]:.3f} m/s")

# %% [markdown]
# ## Dynamics by hand, and by libdyn
#
# The height is z(q), so the speed is z' dq/dt with z' = h sin q, and the kinetic energy is m z'^2 (dq/dt)^2 / 2. Lagrange's equation gives the
# torque:
#
#     tau = m z'^2 ddq + m z' z'' (dq/dt)^2 + m g z'
#
# `rnea` knows the same without being told: the joint's motion subspace and its rate come from the pose by exact differentiation.

# %%
q, v, a = np.array([0.7]), np.array([2.0]), np.array([-1.5])
z1, z2 = h * np.sin(q), h * np.cos(q)
by_hand = mass * (z1**2 * a + z1 * z2 * v**2 + 9.81 * z1)
by_libdyn = dyn.rnea(model, data, q, v, a)
print("torque by hand:  ", by_hand, "N m")
print("torque by libdyn:", by_libdyn, "N m")

# %% [markdown]
# ## Everything else works, too
#
# Derivatives, batches, simulation, code generation: no algorithm of libdyn knows the types of joints. Here is the torque over a whole turn at 60
# rpm, as one batch, and the derivative of the torque by q against differences.

# %%
turn = np.linspace(0, 2 * np.pi, 200)[:, None]
speed = np.full_like(turn, 2 * np.pi)
batch = dyn.BatchData(model, len(turn))
torques = dyn.rnea(model, batch, turn, speed, np.zeros_like(turn))
print(f"torque of the cam shaft between {torques.min():.2f} and {torques.max():.2f} N m")

derivatives = dyn.compute_rnea_derivatives(model, data, q, v, a)
step = 1e-6
ahead, behind = dyn.rnea(model, data, q + step, v, a), dyn.rnea(model, data, q - step, v, a)
by_differences = (ahead - behind) / (2 * step)
print("d tau / dq:", derivatives.dtau_dq.ravel(), "by differences:", by_differences)


# %%
@picture("height [m]", "torque [N m] at 60 rpm")
def _(height, torque):
    height.plot(np.degrees(turn), h * (1 - np.cos(turn)))
    torque.plot(np.degrees(turn), torques)
    for axes in (height, torque):
        axes.set_xlabel("q [degrees]")


# %% [markdown]
# ## A simulation
#
# Pushed from the lowest point, the slider climbs as far as its energy allows: with less than m g 2 h it swings back, with more it goes over the
# top. Near the lowest point and at the top the cam does not move the slider (z' = 0), and the mass matrix is singular there. A little rotor
# inertia, which every real shaft has, cures it.

# %%
rotor = 1e-3  # kg m^2
robot.bodies[1].joint.armature = rotor
model = dyn.compile(robot)
simulator = dyn.Simulator(model, integrator="gauss6", dt=1e-3)


def highest(energy):
    """Returns the greatest angle [rad] within a second, started at the bottom with this energy [J]."""
    simulator.reset([0.0], [np.sqrt(2 * energy / rotor)])
    angles = []
    simulator.advance(1.0, np.linspace(0.001, 1.0, 1000), lambda t, q, v: angles.append(q[0]))
    return max(angles)


top = mass * 9.81 * 2 * h
low, high = highest(0.5 * top), highest(1.1 * top)
print(f"with half of that energy it climbs to {np.degrees(low):.1f} degrees")
print(f"with 10 % more than that it turns {high / (2 * np.pi):.1f} times in a second")

# %% [markdown]
# ## Give it away
#
# `export_plugin` writes a folder with the C++ source, a CMakeLists.txt and a robot that has the joint. Built once, the plugin works from C++, from
# the command `dyn` and in URDF files. [Joint plugins](../../doc/joint_plugins.md) describes what it may have in addition: its own closed forms,
# limits, and a configuration space.

# %%
with tempfile.TemporaryDirectory() as folder:
    written = sorted(path.name for path in dyn.joint.export_plugin(cam, f"{folder}/cam").iterdir())
print("\n".join(written))

# %% [markdown]
# ## Check

# %%
assert np.allclose(by_hand, by_libdyn)
assert np.allclose(derivatives.dtau_dq, by_differences, atol=1e-6)
assert np.isclose(low, np.pi / 2, atol=1e-3)  # z = h at half of the energy of the top
assert high > 2 * np.pi
assert {"cam.cpp", "CMakeLists.txt"} <= set(written)
