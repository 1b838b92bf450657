# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Contacts
#
# This tutorial puts a humanoid on its feet: forces of standing, an impact, and a simulation with friction.
#
#     tools/python libdyn/python/tutorials/contacts.py

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=2, suppress=True)

# %% [markdown]
# ## Feet with soles
#
# The robot's feet have their frames at the ankles. We add the corners of the soles, 20 cm long, 10 cm wide, 5 cm below. Geared motors add the
# inertia of their rotors, the armature, to each joint. The knees are a bit bent, and the base is at the height at which the soles touch the ground,
# z = 0.

# %%
corners = {
    "heel_out": (-0.07, 0.05),
    "heel_in": (-0.07, -0.05),
    "toe_out": (0.13, 0.05),
    "toe_in": (0.13, -0.05),
}
sole = -0.05  # m


def load_robot():
    """Returns the robot's description, with the corners of its soles and rotors in its joints."""
    robot = dyn.load(models / "biped.urdf", root="free_flyer")
    for body in robot.bodies:
        if body.joint.type == "revolute":
            body.joint.armature = 0.1  # kg m^2
    for foot in ("left_foot", "right_foot"):
        for corner, (x, y) in corners.items():
            robot.add_frame(f"{foot}_{corner}", foot, dyn.SE3.translation(x, y, sole))
    return robot


model = dyn.compile(load_robot())
data = dyn.Data(model)
soles = [frame.name for frame in model.frames if "heel" in frame.name or "toe" in frame.name]

q = dyn.neutral(model)
for side in ("left", "right"):
    for joint, angle in (("hip_pitch", -0.3), ("knee", 0.6), ("ankle_pitch", -0.3)):
        q[model.q_index[f"{side}_{joint}"]] = angle
dyn.forward_kinematics(model, data, q)
q[2] = -dyn.frame_placement(model, data, soles[0]).p[2]
still = np.zeros(model.nv)

dyn.forward_kinematics(model, data, q)
print("left ankle:    ", dyn.frame_placement(model, data, "left_foot").p, "m")
com = dyn.center_of_mass(model, data, q).position
print("centre of mass:", com, "m")


# %%
@picture("from the front", "from the left")
def _(front, side):
    draw_robot(front, model, data, "yz")
    front.invert_xaxis()
    draw_robot(side, model, data, "xz")
    side.plot(com[0], com[2], "x", color="C1", label="centre of mass")
    side.legend(loc="upper right")


# %% [markdown]
# ## Feet that do not move
#
# A `frame_contact` holds a frame: three forces and three moments. A set of contacts is a `ConstraintSet`, and `constraint_dynamics` computes the
# accelerations and the contact forces together:
#
#     M a + C v + g = tau + J^T lambda      and      J a + (dJ/dt) v = 0
#
# Without torques, the knees give in. The feet carry less than the weight, because the robot falls.

# %%
feet = dyn.ConstraintSet(model, [dyn.frame_contact("left_foot"), dyn.frame_contact("right_foot")])
contacts = dyn.ConstraintData(feet)
falling = dyn.constraint_dynamics(model, data, q, still, still, contacts)
left, right = feet.rows_of(0), feet.rows_of(1)
weight = model.mass * 9.81
print(f"the base accelerates by {falling.ddq[2]:.2f} m/s^2")
print(f"the left knee accelerates by {falling.ddq[model.joint('left_knee').idx_v]:.2f} rad/s^2")
print(f"the feet carry {falling.forces[left][2] + falling.forces[right][2]:.0f} N of {weight:.0f} N")

# %% [markdown]
# ## Torques for standing
#
# Standing still means g = tau + J^T lambda. No motor drives the base, so its six rows fix what the contact forces must do together. Two feet have
# twelve numbers, so there is a choice; we take the forces of least norm. The other rows are then the torques.

# %%
J = dyn.compute_constraint_jacobian(model, data, q, contacts)
g = dyn.generalized_gravity(model, data, q)
chosen = np.linalg.lstsq(J[:, :6].T, g[:6], rcond=None)[0]
tau = g - J.T @ chosen
print("torques of the left leg:", tau[model.joint("left_hip_yaw").idx_v :][:6].round(3) + 0.0, "N m")
print("force and moment of the left foot:", chosen[left].round(3) + 0.0, "N, N m")

standing = dyn.constraint_dynamics(model, data, q, still, tau, contacts)
print(f"largest acceleration: {np.abs(standing.ddq).max():.1e}")

# %% [markdown]
# A real foot cannot pull, slide or tilt. So the force must be inside the friction cone, and it must act inside the sole. The point where it acts is
# the centre of pressure: force and moment at the ankle give it.


# %%
def center_of_pressure(wrench):
    """Returns where a foot's force acts in the sole (x, y) [m], from force and moment at the ankle."""
    fx, fy, fz, mx, my, _ = wrench
    return np.array([(sole * fx - my) / fz, (sole * fy + mx) / fz])


pressure = {}
for name, rows in (("left", left), ("right", right)):
    force = standing.forces[rows]
    pressure[name] = center_of_pressure(force)
    friction = np.hypot(*force[:2]) / force[2]
    print(f"{name} foot: {force[2]:.0f} N at {100 * pressure[name]} cm, needs friction {friction:.3f}")

# %% [markdown]
# ## Landing
#
# The robot comes down with 0.8 m/s. `impulse_dynamics` computes the velocities after the impact and the impulses of the feet. It conserves
# momentum: the impulses change the momentum of the whole robot, and nothing else does. Legs that are stiff in their joints do not exist: the hips
# go on.

# %%
v_before = still.copy()
v_before[2] = -0.8
landing = dyn.impulse_dynamics(model, data, q, v_before, 0.0, contacts)


def momentum(v):
    """Returns the momentum about the centre of mass [N s, N m s]."""
    return dyn.ccrba(model, data, q, v).hg


impulse = landing.impulses[left][2] + landing.impulses[right][2]
before, after = momentum(v_before)[2], momentum(landing.v_after)[2]
print(f"vertical momentum before {before:.2f} N s, after {after:.2f} N s")
print(f"impulses of the feet {impulse:.2f} N s")
energy_before = dyn.compute_kinetic_energy(model, data, q, v_before)
energy_after = dyn.compute_kinetic_energy(model, data, q, landing.v_after)
print(f"kinetic energy before {energy_before:.2f} J, after {energy_after:.2f} J")
foot_speed = np.abs(J @ landing.v_after).max()

# %% [markdown]
# ## Contacts that come and go
#
# A simulator finds contacts by itself. Here the corners of the soles touch a plane. They push and never pull, and friction stays inside Coulomb's
# cone. The robot falls from 3 cm, and springs and dampers at the joints keep its pose.

# %%
stiffness, damping = 2000.0, 60.0  # N m/rad, N m s/rad
joints = slice(6, model.nv)
q_wanted = q.copy()


def posture(t, q, v):
    torque = tau.copy()
    torque[joints] += stiffness * (q_wanted[7:] - q[7:]) - damping * v[joints]
    return torque


def simulate(model, friction, height, until, times=None, observer=None):
    """Returns the simulator after dropping the robot from a height."""
    simulator = dyn.Simulator(model, dt=1e-3)
    simulator.set_contacts(dyn.points_on_plane(model, soles, friction=friction))
    simulator.set_controller(posture)
    start = q.copy()
    start[2] += height
    simulator.reset(start, still)
    simulator.advance(until, times, observer)
    return simulator


times, heights = np.linspace(0.01, 1.5, 150), []


def observe(t, q, v):
    heights.append(dyn.center_of_mass(model, data, q).position[2])


rest = simulate(model, 0.8, 0.03, 1.5, times, observe)
dyn.forward_kinematics(model, data, rest.q)
depths = [dyn.frame_placement(model, data, name).p[2] for name in soles]
print(f"centre of mass at the end {heights[-1]:.3f} m, speed {np.abs(rest.v).max():.1e}")
print(f"largest distance of a corner from the ground: {np.abs(depths).max():.1e} m")
print(f"{rest.statistics['steps']} steps, of which {rest.statistics['contact_steps']} with contacts")


# %%
@picture("height of the centre of mass [m]")
def _(axes):
    axes.plot(times, heights)
    axes.set_xlabel("t [s]")


# %% [markdown]
# ## Ice on a slope
#
# A slope of 3 degrees is a plane with tilted gravity. Coulomb's law says: a body slides if the friction coefficient mu is below tan(3 degrees) =
# 0.052. Then it accelerates by a = g (sin - mu cos), and slides by a t^2 / 2. Our robot, stiff in its joints, does the same.

# %%
angle = np.radians(3)
description = load_robot()
description.gravity = [9.81 * np.sin(angle), 0, -9.81 * np.cos(angle)]
slope = dyn.compile(description)
dyn.forward_kinematics(model, data, q)
start = dyn.frame_placement(model, data, "left_foot").p
slides = []
for friction in (0.01, 0.03, 0.1):
    end = simulate(slope, friction, 0.0, 0.5)
    dyn.forward_kinematics(model, data, end.q)
    slid = (dyn.frame_placement(model, data, "left_foot").p - start)[0]
    law = max(0.0, 9.81 * (np.sin(angle) - friction * np.cos(angle))) * 0.5**2 / 2
    print(f"friction {friction:.2f}: slid {100 * slid:5.2f} cm, by the law {100 * law:5.2f} cm")
    slides.append((slid, law))

# %% [markdown]
# ## Check

# %%
com_falling = dyn.center_of_mass(model, data, q, still, falling.ddq).acceleration[2]
assert np.isclose(falling.forces[left][2] + falling.forces[right][2], weight + model.mass * com_falling)
assert np.abs(standing.ddq).max() < 1e-9 and np.allclose(standing.forces, chosen)
assert all(-0.07 < x < 0.13 and abs(y) < 0.05 for x, y in pressure.values())
assert np.isclose(after - before, impulse)
assert foot_speed < 1e-9 and energy_after < energy_before
assert np.abs(rest.v).max() < 1e-2 and np.abs(depths).max() < 1e-5 and rest.touches
assert all(abs(slid - law) < 0.002 for slid, law in slides)
