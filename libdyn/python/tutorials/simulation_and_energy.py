# SPDX-License-Identifier: BSD-2-Clause
# %% [markdown]
# # Simulation and energy
#
# This tutorial simulates an arm that swings and a mechanism with a closed loop. Energy shows how good an integrator is.
#
#     tools/python libdyn/python/tutorials/simulation_and_energy.py

# %%
import numpy as np

import libdyn as dyn
from support import draw_robot, models, picture

np.set_printoptions(precision=3, suppress=True)

# %% [markdown]
# ## Swinging
#
# The arm hangs from the ceiling, which is the same as gravity that points up. It has no friction in its joints and no motor acts, so it swings from
# a bent pose, in a chaotic way, for ten seconds. `advance` calls an observer at the times that you name. The steps do not depend on these times.

# %%
robot = dyn.load(models / "arm.urdf")
robot.gravity = [0, 0, 9.81]
model = dyn.compile(robot)
data = dyn.Data(model)
q_start = np.array([0.0, 0.8, 0.2, 0.5, 0.0, 0.3, 0.0])
still = np.zeros(model.nv)
times = np.linspace(0.02, 10.0, 500)


def energies_of(integrator, dt):
    """Returns kinetic and potential energy [J] at the times, (2, 500)."""
    simulator = dyn.Simulator(model, integrator=integrator, dt=dt)
    simulator.reset(q_start, still)
    energies = []

    def observe(t, q, v):
        kinetic = dyn.compute_kinetic_energy(model, data, q, v)
        energies.append((kinetic, dyn.compute_potential_energy(model, data, q)))

    simulator.advance(times[-1], times, observe)
    return np.array(energies).T


kinetic, potential = energies_of("gauss6", 2e-3)
print(f"Up to {kinetic.max():.1f} J go back and forth between height and speed.")
print(f"The sum stays the same to {np.ptp(kinetic + potential):.1e} J.")


# %%
@picture("energies [J]")
def _(axes):
    axes.plot(times, kinetic, label="kinetic")
    axes.plot(times, potential - potential.min(), label="potential, above its least")
    axes.set(xlabel="t [s]", ylim=(0, None))
    axes.legend(fontsize="small", loc="lower left")


# %% [markdown]
# ## How well is energy kept?
#
# Nothing takes energy away, so each change is an error of the integrator. All methods take the same steps of 2 ms.

# %%
methods = "semi_implicit_euler", "implicit_midpoint", "variational", "rk4", "gauss6"
at_start = dyn.compute_potential_energy(model, data, q_start)
drifts = {name: energies_of(name, 2e-3).sum(axis=0) - at_start for name in methods}
for name, drift in drifts.items():
    print(f"{name:<20} largest change of energy: {np.abs(drift).max():.1e} J")


# %%
@picture("change of energy [J]")
def _(axes):
    for name, drift in drifts.items():
        axes.semilogy(times, np.abs(drift) + 1e-16, label=name, linewidth=1)
    axes.set(xlabel="t [s]", ylim=(1e-20, 1e3))
    axes.legend(fontsize="small", ncol=2, loc="lower center")


# %% [markdown]
# The error of `rk4` is small, but it grows with time. `implicit_midpoint`, `variational` and `gauss6` are symmetric in time: their errors come and
# go. `semi_implicit_euler`, which many simulators use, gains energy without end here. It needs much shorter steps, or friction.
#
# ## The order of a method
#
# `rk4` is of order four: half the step, a sixteenth of the error. We check it against a very exact solution at 0.5 s.


# %%
def state_after(integrator, dt, until=0.5):
    simulator = dyn.Simulator(model, integrator=integrator, dt=dt)
    simulator.reset(q_start, still)
    simulator.advance(until)
    return simulator.q


exact = state_after("gauss6", 1e-3)
steps = np.array([0.02, 0.01, 0.005, 0.0025])
errors = np.array([np.abs(state_after("rk4", dt) - exact).max() for dt in steps])
for dt, error in zip(steps, errors):
    print(f"steps of {1000 * dt:4.1f} ms: error {error:.1e} rad")
order = np.log2(errors[:-1] / errors[1:])
print("observed orders:", order)

# %% [markdown]
# ## Energy that motors and dampers exchange
#
# Power at the joints is tau . v. A damper tau = -D v takes energy and gives none. Its work, summed over time, is the energy that the arm has lost.

# %%
damping = 0.3  # N m s/rad
simulator = dyn.Simulator(model, dt=1e-3)
simulator.set_controller(lambda t, q, v: -damping * v)
simulator.reset(q_start, still)
before = simulator.energy
fine = np.linspace(0.001, 2.0, 2000)
power = [0.0]
simulator.advance(fine[-1], fine, lambda t, q, v: power.append(-damping * v @ v))
power = np.array(power)
work = 1e-3 * (power[1:] + power[:-1]).sum() / 2
lost = simulator.energy - before
print(f"change of energy {lost:.4f} J, work of the dampers {work:.4f} J")

# %% [markdown]
# ## A closed loop
#
# A four-bar linkage: crank A-B, coupler B-C, rocker D-C. Its URDF is a tree, and a loop ties coupler and rocker together at C. The loop is a
# constraint: its error must be zero. We put the crank up and find the other angles by Newton's method on the constraint's Jacobian.

# %%
description = dyn.load(models / "four_bar.urdf", continuous="angle")
description.add_frame("end_of_coupler", "coupler", dyn.SE3.translation(0.35, 0, 0))
description.add_frame("end_of_rocker", "rocker", dyn.SE3.translation(0, 0, 0.3))
linkage = dyn.compile(description)
memory = dyn.Data(linkage)
loop = dyn.ConstraintSet(linkage)
loop_data = dyn.ConstraintData(loop)
free = np.r_[linkage.v_index["B"], linkage.v_index["D"]]

q = dyn.neutral(linkage)
for _ in range(10):
    error = dyn.compute_constraint_motion(linkage, memory, q, np.zeros(linkage.nv), loop_data)[2]
    J = dyn.compute_constraint_jacobian(linkage, memory, q, loop_data)
    q[free] -= np.linalg.lstsq(J[:, free], error, rcond=None)[0]
print("angles [rad]:", dict(zip(linkage.q_index, q.round(3))))
print(f"error of the loop {np.abs(error).max():.1e} m")

# %% [markdown]
# The simulator of the model keeps the loop, with any integrator. Each step is projected onto it. The crank starts with 12 rad/s, and events tell
# when it has turned once.

# %%
J = dyn.compute_constraint_jacobian(linkage, memory, q, loop_data)
v = np.zeros(linkage.nv)
v[linkage.v_index["A"]] = 12.0
v[free] = -np.linalg.lstsq(J[:, free], J @ v, rcond=None)[0]  # so that J v = 0

crank = linkage.q_index["A"].start
simulator = dyn.Simulator(linkage, integrator="gauss6", dt=2e-3)
simulator.reset(q, v)
start = simulator.energy
turn = 2 * np.pi
simulator.set_events([("one turn", lambda t, q, v: q[crank] - turn, "rising")])
event = simulator.advance(5.0)
period = simulator.time
print(f"event {event}: the crank has turned once after {period:.4f} s")
print(f"error of the loop {simulator.constraint_error:.1e} m")
print(f"change of energy {simulator.energy - start:.1e} J")
speed_error = np.abs(simulator.v - v).max()
print(f"Without friction it is as fast as before: {speed_error:.1e} rad/s")


# %%
@picture("one turn, every twelfth", "angle of the rocker")
def _(motion, angle):
    simulator.set_events([])
    simulator.reset(q, v)

    def draw(t, q, v):
        dyn.forward_kinematics(linkage, memory, q)
        draw_robot(motion, linkage, memory, color="C0", alpha=0.3 + 0.7 * t / period)

    simulator.advance(period, np.linspace(0, period, 13)[1:], draw)
    times, path = np.linspace(0, period, 200)[1:], []
    simulator.reset(q, v)
    simulator.advance(period, times, lambda t, q, v: path.append(q))
    angle.plot(times, np.degrees(np.array(path)[:, linkage.q_index["D"]]))
    angle.set(xlabel="t [s]", ylabel="[degrees]")


# %% [markdown]
# ## Saved states
#
# `save` returns time, state and step as text, without loss. A simulation that resumes from it gives the same bytes as one that never stopped.

# %%
simulator = dyn.Simulator(model, dt=1e-3)
simulator.reset(q_start, still)
simulator.advance(0.5)
saved = simulator.save()
simulator.advance(1.0)
other = dyn.Simulator(model, dt=1e-3)
other.resume(saved)
other.advance(1.0)
same = simulator.q.tobytes() == other.q.tobytes()
print(f"saved in {len(saved)} letters; same bytes half a second later: {same}")

# %% [markdown]
# ## Check

# %%
largest = {name: np.abs(drift).max() for name, drift in drifts.items()}
assert largest["gauss6"] < 1e-7 and largest["rk4"] < 1e-3 < 1 < largest["semi_implicit_euler"]
assert largest["implicit_midpoint"] < 0.1 and largest["variational"] < 0.1
assert np.all((3.5 < order) & (order < 4.5))
assert np.isclose(work, lost, rtol=1e-4) and work < 0
assert abs(speed_error) < 1e-6
assert same
