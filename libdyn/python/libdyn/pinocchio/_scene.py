# SPDX-License-Identifier: BSD-2-Clause
"""Volumes that are placed one by one, compiled by libdyn. Each volume lies on a floating body of its own, whose pose is the volume's."""

from __future__ import annotations

from typing import Any

import numpy as np

import libdyn


class Scene:
    """Volumes and the pairs of them that are compared. Immutable; SceneState has what changes.

    shapes: libdyn's shapes. pairs: pairs of their indices.
    """

    def __init__(self, shapes: Any, pairs: Any) -> None:
        robot = libdyn.Model()
        unit = libdyn.Inertia(1.0, np.zeros(3), np.eye(3))
        for k, shape in enumerate(shapes):
            robot.add_body(f"body {k}", 0, libdyn.JointDescription(f"joint {k}", "free_flyer"), unit)
            robot.add_geometry(f"volume {k}", f"body {k}", shape)
        self.model = libdyn.compile(robot)
        named = [(f"volume {a}", f"volume {b}") for a, b in pairs]
        self.geometry = libdyn.compile_geometry(self.model, robot, all_pairs=False, add=named)
        slices = self.model.q_index
        self.slices = [slices[f"joint {k}"] for k in range(len(shapes))]
        numbers = {name: int(name.split()[1]) for name in self.geometry.names}
        compiled = {(numbers[self.geometry.names[a]], numbers[self.geometry.names[b]]): k for k, (a, b) in enumerate(self.geometry.pairs)}
        # For each pair its index in the compiled geometry, and whether that has the two in the other order.
        self.pairs = [(compiled[p], False) if p in compiled else (compiled[p[::-1]], True) for p in map(tuple, pairs)]


class SceneState:
    """Placements of a Scene's volumes, and results."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._data = libdyn.Data(scene.model)
        self._geometry_data = libdyn.GeometryData(scene.geometry)
        self._q = libdyn.neutral(scene.model)

    def place(self, poses: Any) -> None:
        """Places volumes. `poses` yields pairs of a volume's index and its pose in the world."""
        for k, pose in poses:
            q = self._q[self.scene.slices[k]]
            q[:3] = pose.p
            q[3:] = libdyn.quaternion_of(pose.R, check=False)
        libdyn.update_geometry_placements(self.scene.model, self._data, self.scene.geometry, self._geometry_data, self._q)

    def collides(self, pair: int) -> bool:
        """Returns whether the two volumes of a pair share a point."""
        return libdyn.compute_collision(self.scene.geometry, self._geometry_data, self.scene.pairs[pair][0])

    def distance(self, pair: int) -> Any:
        """Returns (distance, point on the first, point on the second, normal from the first to the second), in the world."""
        index, swapped = self.scene.pairs[pair]
        d = libdyn.compute_distance(self.scene.geometry, self._geometry_data, index)
        return (d.distance, d.nearest_b, d.nearest_a, -d.normal) if swapped else (d.distance, d.nearest_a, d.nearest_b, d.normal)

    def contacts(self, pair: int) -> Any:
        """Returns the contacts of a pair, each (position, normal from the first to the second, depth)."""
        index, swapped = self.scene.pairs[pair]
        found = libdyn.compute_contacts(self.scene.geometry, self._geometry_data)
        return [(c.position, -c.normal if swapped else c.normal, c.depth) for c in found if c.pair == index]
