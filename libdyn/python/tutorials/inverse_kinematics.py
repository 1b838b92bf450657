# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Inverse kinematics
#
# This tutorial finds configurations for wanted poses: first of an arm's hand, then of a whole humanoid. You write the solver yourself, in ten lines
# on Jacobians. (libdyn will bring a solver of its own later.)
#
#     tools/python libdyn/python/tutorials/inverse_kinematics.py

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## The task
#
# The flange shall look straight down, 45 cm in front of the base and 20 cm to the left. Its z axis leaves the arm, so "down" is a turn by 180
# degrees about y.

# %%
model = dyn.compile(dyn.load(models / "arm.urdf"))
data = dyn.Data(model)
oMwanted = dyn.SE3.translation(0.45, 0.2, 0.3) @ dyn.SE3.rotation([0, np.pi, 0])


def error_of(q):
    """Returns the motion from the flange to its wanted pose (6,), in the axes of the flange."""
    dyn.forward_kinematics(model, data, q)
    oMflange = dyn.frame_placement(model, data, "flange")
    return (oMflange.inverse() @ oMwanted).log().vector


q_start = np.array([0.0, 0.5, 0.0, -1.0, 0.0, 0.5, 0.0])
print("error at the start [m, rad]:", error_of(q_start))

# %% [markdown]
# ## Newton's method on the group
#
# A small step dq moves the flange by J dq, in its own axes. So we look for the dq that removes the error e:
#
#     J(q) dq = e
#
# Seven joints have six equations, and near singular poses an exact solution needs enormous steps. A little damping cures both: we minimise
# |J dq - e|^2 + d |dq|^2, whose solution is
#
#     dq = J^T (J J^T + d I)^-1 e
#
# The damping d shrinks with the error, so the last steps are Newton's. At the limits of a joint we clip.


# %%
def solve(q, tolerance=1e-12, steps=50):
    """Returns a configuration whose flange is at the wanted pose, and the error of each step."""
    errors = []
    while len(errors) < steps:
        e = error_of(q)
        errors.append(np.linalg.norm(e))
        if errors[-1] < tolerance:
            break
        J = dyn.compute_frame_jacobian(model, data, q, "flange", dyn.LOCAL)
        damping = 1e-2 * errors[-1] ** 2
        dq = J.T @ np.linalg.solve(J @ J.T + damping * np.eye(6), e)
        q = np.clip(dyn.integrate(model, q, dq), model.lower, model.upper)
    return q, errors


q_solved, errors = solve(q_start)
for step, error in enumerate(errors):
    print(f"step {step:2}: error {error:.1e}")
print("q =", q_solved, "rad")


# %%
@picture("start and solution", "error")
def _(axes, convergence):
    for q, label in ((q_start, "start"), (q_solved, "solution")):
        dyn.forward_kinematics(model, data, q)
        draw_robot(axes, model, data, "xz", label=label)
    axes.legend()
    convergence.semilogy(errors, "o-")
    convergence.set_xlabel("step")


# %% [markdown]
# The number of correct digits doubles with each of the last steps. `log` makes this possible: it measures rotations without a singular choice of
# angles.
#
# ## The seventh joint
#
# One degree of freedom is left over: the elbow can turn while the hand stays. Motions in the null space of J do not move the flange:
#
#     dq = J^+ e + (I - J^+ J) z        J^+: pseudoinverse, z: any wish
#
# We wish for another elbow: `roll` shall turn to 0.8 rad.


# %%
def follow_wish(q, joint, angle, steps=60):
    """Returns a configuration with the flange where it is wanted, and the joint near the angle."""
    index = model.v_index[joint]
    for _ in range(steps):
        J = dyn.compute_frame_jacobian(model, data, q, "flange", dyn.LOCAL)
        pseudoinverse = np.linalg.pinv(J)
        null_space = np.eye(model.nv) - pseudoinverse @ J
        direction = null_space[:, index].ravel()  # the motion that moves this joint most
        wish = direction / direction[index] * (angle - q[index])
        dq = pseudoinverse @ error_of(q) + np.clip(wish, -0.1, 0.1)
        q = np.clip(dyn.integrate(model, q, dq), model.lower, model.upper)
    return q


q_elbow = follow_wish(q_solved, "roll", 0.8)
roll = model.joint("roll").idx_q
print(f"roll before {q_solved[roll]:.3f} rad, after {q_elbow[roll]:.3f} rad")
print(f"error of the flange: {np.linalg.norm(error_of(q_elbow)):.1e}")


# %%
@picture("from the right", "from behind")
def _(right, behind):
    for q, label in ((q_solved, "before"), (q_elbow, "after")):
        dyn.forward_kinematics(model, data, q)
        draw_robot(right, model, data, "xz", label=label)
        draw_robot(behind, model, data, "yz", label=label)
    behind.invert_xaxis()
    behind.legend()


# %% [markdown]
# ## A humanoid crouches on one leg
#
# Several tasks at once are no harder: stack their Jacobians. The humanoid keeps its right foot on the ground, brings its centre of mass over it and
# 8 cm down, and lifts the left foot by 10 cm. Nothing holds the base; the solver finds its pose. `integrate` keeps the quaternion on its sphere.

# %%
biped = dyn.compile(dyn.load(models / "biped.urdf", root="free_flyer"))
memory = dyn.Data(biped)
bend = {"hip_pitch": -0.3, "knee": 0.6, "ankle_pitch": -0.3}
q0 = dyn.neutral(biped)
for side in ("left", "right"):
    for joint, angle in bend.items():
        q0[biped.q_index[f"{side}_{joint}"]] = angle

dyn.forward_kinematics(biped, memory, q0)
wanted_feet = {side: dyn.frame_placement(biped, memory, f"{side}_foot") for side in ("left", "right")}
wanted_feet["left"].p[2] += 0.10
com = dyn.center_of_mass(biped, memory, q0).position
wanted_com = np.array([*wanted_feet["right"].p[:2] + [0.02, 0], com[2] - 0.08])


def tasks(q):
    """Returns the errors of all tasks and their Jacobian."""
    errors = [wanted_com - dyn.center_of_mass(biped, memory, q).position]
    jacobians = [dyn.jacobian_center_of_mass(biped, memory, q)]
    for side, wanted in wanted_feet.items():
        jacobians.append(dyn.compute_frame_jacobian(biped, memory, q, f"{side}_foot", dyn.LOCAL))
        placement = dyn.frame_placement(biped, memory, f"{side}_foot")
        errors.append((placement.inverse() @ wanted).log().vector)
    return np.concatenate(errors), np.vstack(jacobians)


q_crouch = q0
for step in range(30):
    e, J = tasks(q_crouch)
    print(f"step {step}: error {np.linalg.norm(e):.1e}")
    if np.linalg.norm(e) < 1e-10:
        break
    damping = 1e-2 * (e @ e)
    dq = J.T @ np.linalg.solve(J @ J.T + damping * np.eye(len(e)), e)
    q_crouch = dyn.integrate(biped, q_crouch, dq)

print("base moved to", q_crouch[:3], "m")
for side in wanted_feet:
    print(f"{side} knee bent by {np.degrees(q_crouch[biped.joint(side + '_knee').idx_q]):.0f} degrees")


# %%
@picture("from the front", "from the left")
def _(front, left):
    for q, label in ((q0, "before"), (q_crouch, "after")):
        center = dyn.center_of_mass(biped, memory, q).position
        dyn.forward_kinematics(biped, memory, q)
        draw_robot(front, biped, memory, "yz", label=label)
        front.plot(center[1], center[2], "x", color=front.lines[-1].get_color())
        draw_robot(left, biped, memory, "xz")
    front.invert_xaxis()
    front.legend()


# %% [markdown]
# ## Check

# %%
assert errors[-1] < 1e-12 and len(errors) < 20
assert errors[-2] < 1e-5 and errors[-3] > errors[-2] > errors[-1]
assert np.all((model.lower <= q_solved) & (q_solved <= model.upper))
assert np.linalg.norm(error_of(q_elbow)) < 1e-9 and abs(q_elbow[roll] - 0.8) < 1e-6
assert np.linalg.norm(tasks(q_crouch)[0]) < 1e-10
assert dyn.is_normalized(biped, q_crouch)
