# SPDX-License-Identifier: BSD-2-Clause
"""Shared by the tutorials: where the models are, and pictures, which appear if matplotlib is installed."""
import atexit
import pathlib

import libdyn as dyn

try:
    from matplotlib import pyplot
except ImportError:
    pyplot = None

models = pathlib.Path(__file__).resolve().parents[3] / "models"


def picture(*titles):
    """Decorates a function that draws: it is called at once, with one axes of matplotlib for each title. Without matplotlib it is not called."""

    def decorate(draw):
        if pyplot:
            _, all_axes = pyplot.subplots(1, len(titles), figsize=(1.6 + 3.2 * len(titles), 3.4), squeeze=False, layout="constrained")
            for axes, title in zip(all_axes[0], titles):
                axes.set_title(title)
                axes.grid(alpha=0.3)
            draw(*all_axes[0])

    return decorate


def draw_robot(axes, model, data, view="xz", **style):
    """Draws the robot as lines between its joints and frames, as the last forward_kinematics found them. `view` names the axes of the picture."""
    shown = ["xyz".index(letter) for letter in view]
    lines = []
    for k, joint in enumerate(model.joints):
        if joint.parent > 0:
            lines.append((dyn.joint_placement(model, data, joint.parent).p, dyn.joint_placement(model, data, k).p))
    for k, frame in enumerate(model.frames):
        if frame.joint > 0:
            lines.append((dyn.joint_placement(model, data, frame.joint).p, dyn.frame_placement(model, data, k).p))
    label = style.pop("label", None)
    style = {"color": axes.plot([], [], label=label, **style)[0].get_color(), "linewidth": 2, "solid_capstyle": "round", **style}
    for begin, end in lines:
        axes.plot([begin[shown[0]], end[shown[0]]], [begin[shown[1]], end[shown[1]]], **style)
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel(f"{view[0]} [m]")
    axes.set_ylabel(f"{view[1]} [m]")


@atexit.register
def _show():
    """Keeps windows open until the reader closes them."""
    if pyplot and pyplot.get_fignums() and pyplot.get_backend().lower() != "agg":
        pyplot.show()
