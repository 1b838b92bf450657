# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Dynamics and control
#
# This tutorial takes the equations of motion apart, builds two controllers of them, and tries both in simulation, with a wrong model too.
#
#     tools/python libdyn/python/tutorials/dynamics_and_control.py

# %%
import numpy as np

import libdyn as dyn
from support import models, picture

np.set_printoptions(precision=3, suppress=True)
robot = dyn.load(models / "arm.urdf")
model = dyn.compile(robot)
data = dyn.Data(model)

# %% [markdown]
# ## The parts of the equation
#
#     M(q) a + C(q, v) v + g(q) = tau
#
# Each part has a function. `non_linear_effects` is C v + g in one pass.

# %%
q = np.array([0.3, 0.8, 0.0, 1.1, 0.0, -0.4, 0.2])
v = np.array([0.5, -1.0, 0.3, 1.5, 0.0, 0.8, -2.0])
a = np.array([1.0, 0.5, 0.0, -2.0, 1.0, 0.0, 0.5])

M = dyn.crba(model, data, q)
C = dyn.compute_coriolis_matrix(model, data, q, v)
g = dyn.generalized_gravity(model, data, q)
tau = dyn.rnea(model, data, q, v, a)
print("M a:   ", M @ a, "N m")
print("C v:   ", C @ v, "N m")
print("g:     ", g, "N m")
print("tau:   ", tau, "N m")
parts_error = np.abs(M @ a + C @ v + g - tau).max()
print(f"sum of the parts - tau: {parts_error:.1e} N m")

# %% [markdown]
# C is not unique, but libdyn's makes dM/dt - 2 C skew-symmetric. So Coriolis forces exchange energy and never make any: v^T (dM/dt - 2 C) v = 0. We
# take dM/dt by differences along v.

# %%
step = 1e-5
M_ahead = dyn.crba(model, data, dyn.integrate(model, q, step * v))
M_behind = dyn.crba(model, data, dyn.integrate(model, q, -step * v))
N = (M_ahead - M_behind) / (2 * step) - 2 * C
skewness = np.abs(N + N.T).max()
print(f"N = dM/dt - 2 C: largest entry {np.abs(N).max():.2f}, of N + N^T {skewness:.1e}")

# %% [markdown]
# ## A motion to follow
#
# The arm shall swing between two configurations with a period of two seconds. We need the wanted position, velocity and acceleration.

# %%
middle = np.array([0.0, 0.6, 0.0, 1.2, 0.0, 0.5, 0.0])
swing = np.array([0.8, 0.4, 0.3, -0.5, 0.4, 0.4, 0.8])
omega = np.pi  # rad/s


def wanted(t):
    """Returns the wanted q, v, a at time t."""
    return (
        middle - swing * np.cos(omega * t),
        swing * omega * np.sin(omega * t),
        swing * omega**2 * np.cos(omega * t),
    )


# %% [markdown]
# ## Two controllers
#
# The first is the usual one: springs and dampers at the joints, plus the torque that holds the arm against gravity.
#
#     tau = g(q) + K (q_d - q) + D (v_d - v)
#
# The second knows the dynamics. It chooses an acceleration and asks `rnea` for the torque ("computed torque"):
#
#     tau = rnea(q, v, a_d + k (q_d - q) + d (v_d - v))
#
# Then the error e = q_d - q obeys e'' + d e' + k e = 0: every joint is a damped spring, whatever the arm does.

# %%
k, d = 900.0, 60.0  # 1/s^2, 1/s: errors decay with a time constant of 1/30 s
inertia = np.diag(dyn.crba(model, data, middle))


def springs_and_gravity(t, q, v):
    q_d, v_d, _ = wanted(t)
    return dyn.generalized_gravity(model, data, q) + inertia * (k * (q_d - q) + d * (v_d - v))


def computed_torque(t, q, v):
    q_d, v_d, a_d = wanted(t)
    return dyn.rnea(model, data, q, v, a_d + k * (q_d - q) + d * (v_d - v))


# %% [markdown]
# ## Simulation
#
# A `Simulator` takes a controller as a function of time and state. We start 0.1 rad beside the wanted motion and look at the largest error of a
# joint.


# %%
def errors_of(controller, simulated):
    """Returns the largest error of a joint [rad] at times [s] of a simulation of four seconds."""
    simulator = dyn.Simulator(simulated, integrator="rk4", dt=2e-3)
    simulator.set_controller(controller)
    q_d, v_d, _ = wanted(0.0)
    simulator.reset(q_d + 0.1, v_d)
    errors = []
    simulator.advance(4.0, times, lambda t, q, v: errors.append(np.abs(wanted(t)[0] - q).max()))
    return np.array(errors)


times = np.linspace(0.01, 4.0, 400)
error_springs = errors_of(springs_and_gravity, model)
error_computed = errors_of(computed_torque, model)
for name, error in (("springs and gravity", error_springs), ("computed torque", error_computed)):
    print(f"{name:<20} largest error in the last second: {error[times > 3].max():.1e} rad")

# %% [markdown]
# ## When the model is wrong
#
# The hand now holds 0.5 kg of which the controllers know nothing. A description can be changed and compiled again; the model of the controllers
# stays as it is.

# %%
loaded = dyn.load(models / "arm.urdf")
flange = loaded.bodies[-1]
load = dyn.Inertia(0.5, [0, 0, 0.1], 0.0005 * np.eye(3))
flange.inertia = flange.inertia + load
loaded_model = dyn.compile(loaded)
believed = robot.bodies[-1].inertia.mass
print(f"the flange weighs {flange.inertia.mass} kg, the controllers believe {believed} kg")

error_loaded = errors_of(computed_torque, loaded_model)
print(f"computed torque, wrong model: {error_loaded[times > 3].max():.1e} rad")


# %%
@picture("largest error of a joint")
def _(axes):
    for label, error in (
        ("springs and gravity", error_springs),
        ("computed torque", error_computed),
        ("computed torque, 0.5 kg more", error_loaded),
    ):
        axes.semilogy(times, error, label=label)
    axes.set(xlabel="t [s]", ylabel="[rad]")
    axes.legend(fontsize="small")


# %% [markdown]
# ## How heavy is it?
#
# `rnea` is linear in masses, so the torque that the arm lacks tells the load. The regressor Y has ten columns for each body (mass, first moments,
# second moments), and `Y @ pi` is `rnea`. From torques "measured" at some states, least squares find how the parameters of the flange differ.

# %%
generator = np.random.default_rng(1)
rows, lacking = [], []
for _ in range(50):
    q, v, a = generator.normal(size=(3, model.nv))
    measured = dyn.rnea(loaded_model, dyn.Data(loaded_model), q, v, a)
    rows.append(dyn.compute_joint_torque_regressor(model, data, q, v, a)[:, -10:])
    lacking.append(measured - dyn.rnea(model, data, q, v, a))
parameters = np.linalg.lstsq(np.vstack(rows), np.concatenate(lacking), rcond=None)[0]
print(f"mass of the load {parameters[0]:.3f} kg, its centre at {parameters[1:4] / parameters[0]} m")

# %% [markdown]
# ## A push
#
# External forces act on joints' bodies, each in the joint's own frame: `fext` has one row for each joint, and row 0 belongs to the world. Here
# somebody pushes the flange with 10 N to the left (y of the world). `rnea` says what torque resists.

# %%
dyn.forward_kinematics(model, data, middle)
push = dyn.Force([0, 10, 0], [0, 0, 0])  # in world axes, at the flange
oMflange = dyn.joint_placement(model, data, "wrist3")
fext = np.zeros((model.njoints, 6))
fext[-1] = dyn.SE3(oMflange.R.T, np.zeros(3)).act(push).vector  # in the axes of the flange

still = np.zeros(model.nv)
resisting = dyn.rnea(model, data, middle, still, still, fext=fext) - dyn.rnea(
    model, data, middle, still, still
)
J = dyn.compute_joint_jacobian(model, data, middle, "wrist3", dyn.LOCAL_WORLD_ALIGNED)
print("torque against the push:", resisting, "N m")
print("-J^T f:                 ", -J.T @ push.vector, "N m")

# %% [markdown]
# ## Check

# %%
assert parts_error < 1e-10
assert np.allclose(dyn.non_linear_effects(model, data, q, v), dyn.rnea(model, data, q, v, still))
assert skewness < 1e-6
assert error_computed[times > 3].max() < 1e-6
assert error_springs[times > 3].max() > 0.01 and error_loaded[times > 3].max() > 0.01
added = (dyn.dynamic_parameters(loaded_model) - dyn.dynamic_parameters(model))[-10:]
assert np.allclose(parameters, added, atol=1e-6)
assert np.isclose(parameters[0], 0.5)
assert np.allclose(resisting, -J.T @ push.vector)
