# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # First steps
#
# This tutorial loads a humanoid robot, moves it, and computes its dynamics. It takes five minutes.
#
# Run it as it is, or cell by cell in an editor that knows `# %%`:
#
#     tools/python libdyn/python/tutorials/first_steps.py
#
# `support` is a small module beside the tutorials. It knows where the models are, and it draws pictures if matplotlib is installed.

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## A description becomes a model
#
# `load` reads a file and returns a description: bodies, joints and frames, which you may change. A humanoid is not fixed to the world, so we ask
# for a floating base, which is a joint of type `free_flyer` between the world and the torso.
#
# `compile` turns the description into a model for computing. A model never changes. `Data` is memory for results; each thread needs its own.

# %%
robot = dyn.load(models / "biped.urdf", root="free_flyer")
model = dyn.compile(robot)
data = dyn.Data(model)

print(robot)
print(model)
print(f"{model.mass:.1f} kg, {model.nv} degrees of freedom, six of them of the base")

# %% [markdown]
# ## Configurations are not vectors
#
# q has nq numbers and v has nv numbers, and here nq = nv + 1: the orientation of the base is a quaternion of four numbers, but turning has three
# degrees of freedom. So `q + v` has no meaning. `integrate` moves a configuration, and `difference` is its inverse.
#
# `q_index` and `v_index` say which numbers belong to which joint.

# %%
q0 = dyn.neutral(model)
v = np.zeros(model.nv)
v[model.v_index["root_joint"]] = [0.2, 0, 0, 0, 0, 0.5]  # 0.2 m/s forward, turning left by 0.5 rad/s
v[model.v_index["left_knee"]] = 1.2  # rad/s
q = dyn.integrate(model, q0, v)  # after one second

print("base at      ", q[model.q_index["root_joint"]][:3], "m")
print("quaternion   ", q[model.q_index["root_joint"]][3:], "(x, y, z, w)")
print("left knee at ", q[model.q_index["left_knee"]], "rad")
print("the way back:", dyn.difference(model, q, q0)[model.v_index["root_joint"]], "for the base: -v")

# %% [markdown]
# ## Where is everything?
#
# `forward_kinematics` computes the pose of every joint and leaves the results in `data`. A pose is an `SE3` with a rotation `R` and a position `p`.

# %%
dyn.forward_kinematics(model, data, q)
for joint in model.joints[1:]:
    pose = dyn.joint_placement(model, data, joint.name)
    print("{:<18} x = {:6.3f}  y = {:6.3f}  z = {:6.3f} m".format(joint.name, *pose.p))


# %%
@picture("from the front", "from the left")
def _(front, side):
    draw_robot(front, model, data, "yz")
    front.invert_xaxis()  # y points to the left of the robot
    draw_robot(side, model, data, "xz")


# %% [markdown]
# ## Forces for a motion: inverse dynamics
#
# `rnea` computes the joint forces that a motion needs (recursive Newton-Euler algorithm):
#
#     tau = M(q) a + C(q, v) v + g(q)
#
# The robot stands still, so tau is what holds it against gravity. Nothing holds the base from below: its first three numbers are the force that a
# crane would need, and that is the robot's weight.

# %%
still = np.zeros(model.nv)
tau = dyn.rnea(model, data, q0, still, still)
force = tau[model.v_index["root_joint"]][:3]
print("force on the base:", force, "N")
print(f"weight:            {model.mass * 9.81:.3f} N")

# %% [markdown]
# ## Motion from forces: forward dynamics
#
# `aba` is the inverse of `rnea`: it computes accelerations from forces (articulated-body algorithm). Without any force, the robot falls freely: its
# base accelerates like a stone, and its joints do not accelerate at all.

# %%
a = dyn.aba(model, data, q0, still, np.zeros(model.nv))
print("acceleration of the base:", a[:3], "m/s^2")
print(f"largest acceleration of a joint: {np.abs(a[6:]).max():.1e} rad/s^2")

# %% [markdown]
# ## The mass matrix and the kinetic energy
#
# `crba` computes M(q) (composite-rigid-body algorithm). The kinetic energy is v^T M v / 2. Positions of zeros in M tell which joints do not feel
# each other: the left leg's motion needs no force at the right knee.

# %%
M = dyn.crba(model, data, q)
print("M has the shape", M.shape, "and is symmetric to", f"{np.abs(M - M.T).max():.1e}")
print(f"v^T M v / 2 =            {v @ M @ v / 2:.4f} J")
print(f"compute_kinetic_energy = {dyn.compute_kinetic_energy(model, data, q, v):.4f} J")
left, right = model.joint("left_knee").idx_v, model.joint("right_knee").idx_v
print(f"left knee: {M[left, left]:.3f} kg m^2, between left and right knee: {M[left, right]} kg m^2")


# %%
@picture("Nonzero entries of M")
def _(axes):
    axes.spy(M, precision=1e-9, markersize=4)
    axes.grid(False)


# %% [markdown]
# ## Derivatives
#
# The derivatives of `rnea` by q, v and a are exact; no differences are taken. Since q has no ordinary derivative, the one by q has a column for
# each degree of freedom: the change along `integrate`. Several results come as a tuple with names: `dtau_dq`, `dtau_dv`, and M, the derivative by
# a.

# %%
derivatives = dyn.compute_rnea_derivatives(model, data, q0, still, still)
step = 1e-6
left_knee = np.zeros(model.nv)
left_knee[left] = step
bent_a_bit = dyn.rnea(model, data, dyn.integrate(model, q0, left_knee), still, still)
by_difference = (bent_a_bit - dyn.rnea(model, data, q0, still, still)) / step
print(f"A bent knee changes its own torque by {derivatives.dtau_dq[left, left]:.3f} N m/rad,")
print(f"by a difference                       {by_difference[left]:.3f} N m/rad.")

# %% [markdown]
# ## Many states at once
#
# A `BatchData` computes many states in one call. Arrays have one state a row. The functions are the same.

# %%
count = 1000
batch = dyn.BatchData(model, count)
qs = np.stack([dyn.random_configuration(model, seed) for seed in range(count)])
torques = dyn.generalized_gravity(model, batch, qs)
knees = np.abs(torques[:, model.v_index["left_knee"]])
print("results have the shape", torques.shape)
print(f"holding the left knee takes up to {knees.max():.1f} N m")

# %% [markdown]
# ## Wrong input
#
# Errors say what is wrong and what to do.

# %%
try:
    dyn.frame_placement(model, data, "left_fot")
except dyn.Error as error:
    print("Error:", error)
try:
    dyn.rnea(model, data, q0[:7], still, still)
except dyn.Error as error:
    print("Error:", error)

# %% [markdown]
# ## Check
#
# Each tutorial ends with the claims it made.

# %%
assert np.allclose(dyn.difference(model, q0, q), v)
assert np.allclose(force, [0, 0, model.mass * 9.81])
assert np.allclose(a[:6], [0, 0, -9.81, 0, 0, 0]) and np.abs(a[6:]).max() < 1e-9
assert np.allclose(dyn.aba(model, data, q, v, dyn.rnea(model, data, q, v, still)), 0, atol=1e-8)
assert np.isclose(v @ M @ v / 2, dyn.compute_kinetic_energy(model, data, q, v))
assert M[left, right] == 0
assert np.allclose(derivatives.dtau_dq[:, left], by_difference, atol=1e-4)
assert np.allclose(torques[7], dyn.generalized_gravity(model, data, qs[7]))
