# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Frames and Jacobians
#
# This tutorial reads poses and velocities of an arm's tool, and relates them to the joints by Jacobians.
#
#     tools/python libdyn/python/tutorials/frames_and_jacobians.py

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## A tool in the hand
#
# The arm has seven joints and ends in a flange. We add a frame for the tip of a tool, 15 cm in front of the flange. Every body has a frame of its
# own name; further frames cost nothing.

# %%
robot = dyn.load(models / "arm.urdf")
robot.add_frame("tool", "flange", dyn.SE3.translation(0, 0, 0.15))
model = dyn.compile(robot)
data = dyn.Data(model)
print("frames:", ", ".join(frame.name for frame in model.frames))

# %% [markdown]
# ## Poses
#
# We write `aMb` for the pose of frame b in frame a. It maps coordinates of a point from b to a, and inner letters cancel: `aMc = aMb @ bMc`. The
# world is o.

# %%
q = np.array([0.4, 0.5, 0.0, 1.2, 0.0, 0.6, 0.0])
dyn.forward_kinematics(model, data, q)
oMtool = dyn.frame_placement(model, data, "tool")
oMelbow = dyn.frame_placement(model, data, "elbow")
elbowMtool = oMelbow.inverse() @ oMtool

print("the tool in the world:    ", oMtool.p, "m")
print("the tool, from the elbow: ", elbowMtool.p, "m")
print("10 cm in front of the tool:", oMtool @ np.array([0, 0, 0.1]), "m, in the world")


# %% [markdown]
# `SE3.log` is the constant motion that leads to a pose in unit time, and `SE3.exp` the pose after a motion. Between two poses lies a screw: a turn
# about an axis together with a shift along it.

# %%
screw = elbowMtool.log()
print(screw)
print(f"turned by {np.degrees(np.linalg.norm(screw.angular)):.1f} degrees against the elbow")

# %% [markdown]
# ## One velocity, three ways to write it
#
# With v, `forward_kinematics` computes velocities, too. A `Motion` has a linear and an angular part. Its numbers depend on a reference:
#
# - `LOCAL`: in the axes of the tool, at the tool;
# - `LOCAL_WORLD_ALIGNED`: in the axes of the world, at the tool. An observer sees this one.
# - `WORLD`: in the axes of the world, at the body's point that passes the world's origin. It is the natural one for algebra with poses.

# %%
v = np.array([0.0, 0.5, 0.0, -0.8, 0.0, 0.3, 0.0])  # rad/s
dyn.forward_kinematics(model, data, q, v)
for reference in (dyn.LOCAL, dyn.LOCAL_WORLD_ALIGNED, dyn.WORLD):
    motion = dyn.frame_velocity(model, data, "tool", reference)
    print(f"{reference.name:<20} linear {motion.linear} m/s   angular {motion.angular} rad/s")

# %% [markdown]
# A pose maps motions, too: `oMtool @ motion` turns `LOCAL` into `WORLD`.

# %%
local = dyn.frame_velocity(model, data, "tool", dyn.LOCAL)
in_world = dyn.frame_velocity(model, data, "tool", dyn.WORLD)
print("difference:", np.abs((oMtool @ local - in_world).vector).max())

# %% [markdown]
# ## Jacobians
#
# The velocity of a frame is linear in v. The matrix is the Jacobian, with six rows (linear, then angular) and a column for each degree of freedom:
#
#     velocity of the tool = J(q) v

# %%
J = dyn.compute_frame_jacobian(model, data, q, "tool", dyn.LOCAL_WORLD_ALIGNED)
seen = dyn.frame_velocity(model, data, "tool", dyn.LOCAL_WORLD_ALIGNED)
print("J v:     ", J @ v)
print("velocity:", seen.vector)
for name in ("shoulder1", "bend", "wrist3"):
    speed = np.linalg.norm(J[:3, model.v_index[name]])
    print(f"1 rad/s of {name:<9} moves the tool by {speed:.3f} m/s")

# %% [markdown]
# Column k is the change of the pose along one degree of freedom. Finite differences confirm it: we step to both sides, and compare the two poses by
# `log`.


# %%
def tool_at(q):
    dyn.forward_kinematics(model, data, q)
    return dyn.frame_placement(model, data, "tool")


step = 1e-6
columns = []
for direction in np.eye(model.nv):
    ahead = tool_at(dyn.integrate(model, q, step * direction))
    behind = tool_at(dyn.integrate(model, q, -step * direction))
    columns.append((behind.inverse() @ ahead).log().vector / (2 * step))
J_local = dyn.compute_frame_jacobian(model, data, q, "tool", dyn.LOCAL)
J_error = np.abs(J_local - np.stack(columns, axis=1)).max()
print(f"largest difference: {J_error:.1e}")

# %% [markdown]
# ## Where can the tool go quickly?
#
# Joint velocities of norm 1 move the tool with velocities in an ellipsoid: the lengths of its axes are the singular values of J. If the arm is
# stretched, it becomes flat, and a direction is lost: the arm is singular.


# %%
def velocities_of(q):
    """Returns the singular values of J, and the tool's velocities (2, 100) in x, z for joint speeds of norm 1."""
    J = dyn.compute_frame_jacobian(model, data, q, "tool", dyn.LOCAL_WORLD_ALIGNED)
    axes, lengths, _ = np.linalg.svd(J[[0, 2]])
    angle = np.linspace(0, 2 * np.pi, 100)
    return np.linalg.svd(J)[1], axes @ np.diag(lengths) @ [np.cos(angle), np.sin(angle)]


bent = np.array([0.0, 0.3, 0.0, -1.6, 0.0, -0.4, 0.0])
stretched = np.array([0.0, 0.9, 0.0, -0.02, 0.0, 0.0, 0.0])
for name, configuration in (("bent", bent), ("stretched", stretched)):
    print(f"{name:<10} singular values of J:", velocities_of(configuration)[0])


# %%
@picture("what the tool reaches in 0.2 s")
def _(axes):
    for configuration in (bent, stretched):
        x, z = tool_at(configuration).p[[0, 2], None] + 0.2 * velocities_of(configuration)[1]
        tool_at(configuration)
        draw_robot(axes, model, data, "xz")
        axes.plot(x, z, color=axes.lines[-1].get_color(), linewidth=1)


# %% [markdown]
# ## Accelerations
#
# The acceleration of a frame has a part that comes from v alone, because J changes along the motion:
#
#     acceleration of the tool = J a + (dJ/dt) v

# %%
a = np.array([0.0, 1.0, 0.0, 0.0, 0.0, -1.0, 0.0])  # rad/s^2
dyn.forward_kinematics(model, data, q, v, a)
acceleration = dyn.frame_classical_acceleration(model, data, "tool", dyn.LOCAL_WORLD_ALIGNED).vector
dJ = dyn.compute_frame_jacobian_time_variation(model, data, q, v, "tool", dyn.LOCAL_WORLD_ALIGNED)
print("acceleration [m/s^2, rad/s^2]:", acceleration)
print("J a:                          ", J @ a)
print("(dJ/dt) v:                    ", dJ @ v)

# %% [markdown]
# ## Forces go the other way
#
# The transposed Jacobian maps a force on the tool to joint torques, because power is the same on both sides: `tau . v = f . (J v)`. To press with
# 20 N on a table, each joint adds this torque to those that hold the arm:

# %%
force_on_table = np.array([0, 0, -20.0, 0, 0, 0])  # N, N m
tau = J.T @ force_on_table
print("torques:", tau, "N m")
print(f"power at the joints {tau @ v:.4f} W, at the tool {force_on_table @ seen.vector:.4f} W")

# %% [markdown]
# ## Check

# %%
assert np.allclose((oMelbow @ elbowMtool).homogeneous, oMtool.homogeneous)
assert np.allclose(dyn.SE3.exp(screw).homogeneous, elbowMtool.homogeneous)
assert np.allclose((oMtool @ local).vector, in_world.vector)
assert np.allclose(J @ v, seen.vector)
assert J_error < 1e-8
assert velocities_of(bent)[0][-1] > 10 * velocities_of(stretched)[0][-1]
assert np.allclose(J @ a + dJ @ v, acceleration)
assert np.isclose(tau @ v, force_on_table @ seen.vector)
