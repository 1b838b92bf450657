# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Derivatives and optimal control
#
# This tutorial swings a weak arm up. Its elbow has no motor, so it must gather energy. Differential dynamic programming finds the motion in eighty
# lines, thanks to analytical derivatives of the dynamics.
#
#     tools/python libdyn/python/tutorials/optimal_control.py

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## A double pendulum from an arm
#
# `keep_only` holds all joints but the named ones. So the seven joints become two, which turn in one vertical plane: the shoulder and the elbow
# (`bend`). At zero the arm points upwards; at a shoulder of 180 degrees it hangs.

# %%
model = dyn.compile(dyn.keep_only(dyn.load(models / "arm.urdf"), ["shoulder2", "bend"]))
data = dyn.Data(model)
hanging, upright = np.array([np.pi, 0.0]), np.zeros(2)
print(model)
holding = dyn.generalized_gravity(model, data, [np.pi / 2, 0.0])
print("torques that hold it out horizontally:", holding, "N m")

# %% [markdown]
# ## Derivatives of the dynamics
#
# `compute_aba_derivatives` returns the derivatives of the accelerations ddq = aba(q, v, tau) by q, v and tau. They are exact and cost little more
# than `aba` itself. Differences confirm them, but are less exact and slower.

# %%
q, v, tau = np.array([2.0, -0.7]), np.array([1.0, 0.5]), np.array([3.0, 0.0])
derivatives = dyn.compute_aba_derivatives(model, data, q, v, tau)
step = 1e-6
columns = [
    dyn.aba(model, data, q + s, v, tau) - dyn.aba(model, data, q - s, v, tau) for s in step * np.eye(2)
]
by_differences = np.stack(columns, axis=1) / (2 * step)
print("d ddq / dq =\n", derivatives.ddq_dq)
print(f"difference to finite differences: {np.abs(derivatives.ddq_dq - by_differences).max():.1e}")
print("d ddq / dtau is the inverse of M:\n", derivatives.Minv @ dyn.crba(model, data, q), "= M^-1 M")

# %% [markdown]
# ## The problem
#
# The state is x = (q, v), the control u is the torque of the shoulder. A step of length h goes half the way with the old velocity, accelerates, and
# goes the other half with the new one:
#
#     m  = q + h/2 v
#     v' = v + h aba(m, v, (u, 0))
#     q' = m + h/2 v'
#
# We look for controls that minimise
#
#     sum over the steps of  h (r u^2 + c |v|^2) / 2   +   w |x_end - upright|^2 / 2
#
# Functions take rows of many states as well: a `BatchData` computes all their accelerations or derivatives in one call.

# %%
h, steps = 0.02, 150  # s
r, c, w = 0.05, 0.1, np.array([1000.0, 1000.0, 100.0, 100.0])
motor = np.array([[1.0], [0.0]])  # maps u to the torques of shoulder and elbow
target = np.concatenate([upright, np.zeros(2)])
batch = dyn.BatchData(model, steps)


def move(x, u):
    """Returns the next states, a row each."""
    v = x[:, 2:]
    middle = x[:, :2] + h / 2 * v
    v = v + h * dyn.aba(model, batch, middle, v, u[:, None] * motor.T)
    return np.hstack([middle + h / 2 * v, v])


def linearise(x, u):
    """Returns A and B of all steps, an entry each: a deviation dx becomes A dx + B du."""
    v = x[:, 2:]
    middle = x[:, :2] + h / 2 * v
    d = dyn.compute_aba_derivatives(model, batch, middle, v, u[:, None] * motor.T)
    v_dx, middle_dx = np.eye(4)[2:], np.eye(4)[:2] + h / 2 * np.eye(4)[2:]
    v_dx = v_dx + h * (d.ddq_dq @ middle_dx + d.ddq_dv @ v_dx)
    v_du = h * d.Minv @ motor
    A = np.concatenate([middle_dx + h / 2 * v_dx, v_dx], axis=1)
    return A, np.concatenate([h / 2 * v_du, v_du], axis=1)


def cost_of(xs, us):
    """Returns the cost of states (steps + 1, ..., 4) and controls (steps, ...)."""
    running = r * us**2 + c * (xs[:-1, ..., 2:] ** 2).sum(axis=-1)
    return h / 2 * running.sum(axis=0) + (w * (xs[-1] - target) ** 2).sum(axis=-1) / 2


# %% [markdown]
# ## Backwards: the value of a deviation
#
# Near a trajectory, the cost of the rest is V(dx) = V_x . dx + dx^T V_xx dx / 2. It is known at the end. Q is the cost of one step and the rest;
# each step back minimises it over du. The result is a change of the control and a feedback:
#
#     du = k + K dx
#
# `mu` makes changes of the state expensive, so that the motion stays where its linearisation holds.


# %%
def backward(xs, us, mu):
    """Returns k (steps,) and K (steps, 4)."""
    A, B = linearise(xs[:-1], us)
    V_x, V_xx = w * (xs[-1] - target), np.diag(w)
    k, K = np.zeros(steps), np.zeros((steps, 4))
    speeds = np.diag([0, 0, 1, 1])
    for t in reversed(range(steps)):
        a, b = A[t], B[t, :, 0]
        Q_x, Q_u = a.T @ V_x + h * c * speeds @ xs[t], b @ V_x + h * r * us[t]
        Q_xx, Q_ux, Q_uu = a.T @ V_xx @ a + h * c * speeds, b @ V_xx @ a, b @ V_xx @ b + h * r
        k[t] = -Q_u / (Q_uu + mu * b @ b)
        K[t] = -(Q_ux + mu * b @ a) / (Q_uu + mu * b @ b)
        V_x = Q_x + Q_ux * k[t] + K[t] * (Q_u + Q_uu * k[t])
        V_xx = Q_xx + np.outer(K[t], Q_ux) + np.outer(Q_ux, K[t]) + Q_uu * np.outer(K[t], K[t])
    return k, K


# %% [markdown]
# ## Forwards: try several step lengths at once
#
# The new controls are u + s k + K (x - x_old) with a step length s. We run eight lengths side by side in one batch and keep the best. If none is
# better than before, `mu` grows.

# %%
lengths = 0.5 ** np.arange(8)


def forward(xs, us, k, K):
    """Returns the states (steps + 1, 8, 4) and controls (steps, 8) of all step lengths."""
    states, controls = [np.tile(xs[0], (len(lengths), 1))], []
    for t in range(steps):
        controls.append(us[t] + lengths * k[t] + (states[t] - xs[t]) @ K[t])
        states.append(move(states[t], controls[t]))
    return np.array(states), np.array(controls)


xs = np.tile(np.concatenate([hanging, np.zeros(2)]), (steps + 1, 1))  # without torque it hangs still
us = np.zeros(steps)
cost, mu, improvement = cost_of(xs, us), 1.0, np.inf
costs = [cost]
while improvement > 0.01 * cost:
    with np.errstate(over="ignore", invalid="ignore"):  # a step that is too long may diverge
        states, controls = forward(xs, us, *backward(xs, us, mu))
        trials = cost_of(states, controls)
    best = np.nanargmin(trials)
    if trials[best] < cost:
        improvement = cost - trials[best]
        xs, us, cost, mu = states[:, best], controls[:, best], trials[best], mu / 3
        costs.append(cost)
        if len(costs) % 4 == 2:
            print(f"improvement {len(costs) - 1:2}: cost {cost:8.2f}")
    else:
        mu *= 10

strongest = np.abs(us).max()
print(f"end state {xs[-1]} rad, rad/s")
print(f"largest torque {strongest:.1f} N m; to hold the arm out takes {np.abs(holding[0]):.1f} N m")


# %%
@picture("motion, every 0.1 s", "torque of the shoulder")
def _(motion, torque):
    for t in range(0, steps + 1, 5):
        dyn.forward_kinematics(model, data, xs[t, :2])
        draw_robot(motion, model, data, "xz", color="C0", alpha=0.2 + 0.8 * t / steps)
    torque.plot(h * np.arange(steps), us)
    torque.set(xlabel="t [s]", ylabel="[N m]")


# %% [markdown]
# ## The feedback matters
#
# The steps of 20 ms are a rough picture of the arm. We let a simulator move it with steps of 2 ms, once with the controls alone and once with the
# feedback K (x - x_planned). Swinging up amplifies small errors: only the feedback brings the arm up.

# %%
K = backward(xs, us, 0.0)[1]


def play(gain):
    """Returns the state at the end of a simulation, with the feedback times `gain`."""

    def controller(t, q, v):
        k, part = min(int(t / h), steps - 1), t / h % 1
        planned = (1 - part) * xs[k] + part * xs[k + 1]
        return motor[:, 0] * (us[k] + gain * K[k] @ (np.concatenate([q, v]) - planned))

    simulator = dyn.Simulator(model, integrator="rk4", dt=2e-3)
    simulator.set_controller(controller)
    simulator.reset(hanging, np.zeros(2))
    simulator.advance(steps * h)
    return np.concatenate([simulator.q, simulator.v])


with_feedback, without = play(1.0), play(0.0)
print("end state with feedback:   ", with_feedback, "rad, rad/s")
print("end state without feedback:", without, "rad, rad/s")

# %% [markdown]
# ## Check

# %%
assert np.allclose(derivatives.ddq_dq, by_differences, atol=1e-6)
assert np.allclose(derivatives.Minv @ dyn.crba(model, data, q), np.eye(2))
assert np.all(np.diff(costs) < 0) and len(costs) < 60
assert np.abs(xs[-1] - target).max() < 0.1
assert strongest < 0.75 * np.abs(holding[0])
assert np.abs(with_feedback[:2] - upright).max() < 0.1 and np.abs(without[:2] - upright).max() > 0.5
