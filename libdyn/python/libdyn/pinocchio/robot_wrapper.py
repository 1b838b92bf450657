# SPDX-License-Identifier: BSD-2-Clause
"""RobotWrapper: a model, its volumes and their data in one object, with shorter calls."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NoReturn, Optional, Union

import numpy as np

from . import centroidal, collision, com, configuration, dynamics, edit, jacobians, kinematics, shortcuts
from .enums import LOCAL
from .model import Model

if TYPE_CHECKING:
    from collections.abc import Sequence
    from numpy.typing import ArrayLike

    from .. import ReferenceFrame
    from ._types import Array, Path
    from .data import Data
    from .geometry import GeometryModel
    from .geometry_object import GeometryObject, GeometryType
    from .spatial import Force, Motion, SE3


class RobotWrapper:
    """A robot: model, collision_model, visual_model; data, collision_data, visual_data; q0 (neutral) and v0 (zero)."""

    if TYPE_CHECKING:
        data: Data
        collision_data: Any
        visual_data: Any

    def __init__(
        self,
        model: Optional[Model] = None,
        collision_model: Optional[GeometryModel] = None,
        visual_model: Optional[GeometryModel] = None,
        verbose: bool = False,
    ) -> None:
        self.model = Model() if model is None else model
        self.collision_model, self.visual_model = collision_model, visual_model
        self.viz: Any = None
        self.rebuildData()
        self.q0, self.v0 = configuration.neutral(self.model), np.zeros(self.model.nv)

    @staticmethod
    def BuildFromURDF(filename: Path, *arguments: Any, **named: Any) -> RobotWrapper:
        """Returns the robot of a URDF file. Arguments are those of buildModelsFromUrdf."""
        robot = RobotWrapper()
        robot.initFromURDF(filename, *arguments, **named)
        return robot

    def initFromURDF(self, filename: Path, *arguments: Any, **named: Any) -> None:
        """Reads a URDF file. Arguments are those of buildModelsFromUrdf."""
        model, collision_model, visual_model = shortcuts.buildModelsFromUrdf(filename, *arguments, **named)
        RobotWrapper.__init__(self, model, collision_model, visual_model)

    @staticmethod
    def BuildFromSDF(filename: Path, *arguments: Any, **named: Any) -> NoReturn:
        """Raises NotImplementedError: libdyn reads URDF files only."""
        shortcuts.buildModelsFromSdf(filename, *arguments, **named)

    @staticmethod
    def BuildFromMJCF(filename: Path, *arguments: Any, **named: Any) -> NoReturn:
        """Raises NotImplementedError: libdyn reads URDF files only."""
        shortcuts.buildModelsFromMJCF(filename, *arguments, **named)

    nq: int = property(lambda self: self.model.nq, doc="The number of coordinates.")
    nv: int = property(lambda self: self.model.nv, doc="The number of degrees of freedom.")

    def rebuildData(self) -> None:
        """Makes the data anew, after a change of the models."""
        made = shortcuts.createDatas(self.model, self.collision_model, self.visual_model)
        self.data, self.collision_data, self.visual_data = made
        if self.viz is not None:
            self.viz.data, self.viz.collision_data, self.viz.visual_data = made

    def index(self, name: str) -> int:
        """Returns the index of a joint by name."""
        return self.model.getJointId(name)

    # Dynamics

    def mass(self, q: ArrayLike) -> Array:
        """Returns M (nv, nv)."""
        return dynamics.crba(self.model, self.data, q)

    def nle(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns C v + g (nv,)."""
        return dynamics.nonLinearEffects(self.model, self.data, q, v)

    def gravity(self, q: ArrayLike) -> Array:
        """Returns g (nv,)."""
        return dynamics.computeGeneralizedGravity(self.model, self.data, q)

    # Centre of mass and momentum

    def com(self, q: Optional[ArrayLike] = None, v: Optional[ArrayLike] = None, a: Optional[ArrayLike] = None) -> Any:
        """Returns the centre of mass (3,); with v, a tuple with its velocity; with a, also its acceleration."""
        given = [x for x in (q, v, a) if x is not None]
        com.centerOfMass(self.model, self.data, *given)
        out = (self.data.com[0], *((self.data.vcom[0],) if len(given) > 1 else ()), *((self.data.acom[0],) if len(given) > 2 else ()))
        return out if len(out) > 1 else out[0]

    def vcom(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns the velocity of the centre of mass (3,)."""
        return self.com(q, v)[1]

    def acom(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Array:
        """Returns the acceleration of the centre of mass (3,)."""
        return self.com(q, v, a)[2]

    def Jcom(self, q: ArrayLike) -> Array:
        """Returns the Jacobian of the centre of mass (3, nv)."""
        return com.jacobianCenterOfMass(self.model, self.data, q)

    def centroidalMomentum(self, q: ArrayLike, v: ArrayLike) -> Force:
        """Returns the momentum about the centre of mass, a Force."""
        return centroidal.computeCentroidalMomentum(self.model, self.data, q, v)

    def centroidalMap(self, q: ArrayLike) -> Array:
        """Returns Ag (6, nv)."""
        return centroidal.computeCentroidalMap(self.model, self.data, q)

    def centroidal(self, q: ArrayLike, v: ArrayLike) -> Any:
        """Returns the momentum, Ag and the composite inertia about the centre of mass."""
        centroidal.ccrba(self.model, self.data, q, v)
        return self.data.hg, self.data.Ag, self.data.Ig

    def centroidalMomentumVariation(self, q: ArrayLike, v: ArrayLike, a: ArrayLike) -> Force:
        """Returns the rate of the momentum, a Force."""
        return centroidal.computeCentroidalMomentumTimeVariation(self.model, self.data, q, v, a)

    # Kinematics. With update_kinematics=False, functions use the last forwardKinematics.

    def forwardKinematics(self, q: ArrayLike, v: Optional[ArrayLike] = None, a: Optional[ArrayLike] = None) -> None:
        """Computes poses of joints; with v velocities, with a accelerations."""
        kinematics.forwardKinematics(self.model, self.data, q, v, a)

    def framesForwardKinematics(self, q: ArrayLike) -> None:
        """Computes poses of joints and frames."""
        kinematics.framesForwardKinematics(self.model, self.data, q)

    def _updated(self, update, *state):
        if update:
            self.forwardKinematics(*state)
        return self.model, self.data

    def placement(self, q: ArrayLike, index: int, update_kinematics: bool = True) -> SE3:
        """Returns the pose of a joint."""
        return self._updated(update_kinematics, q)[1].oMi[index]

    def velocity(self, q: ArrayLike, v: ArrayLike, index: int, update_kinematics: bool = True, reference_frame: ReferenceFrame = LOCAL) -> Motion:
        """Returns the velocity of a joint."""
        return kinematics.getVelocity(*self._updated(update_kinematics, q, v), index, reference_frame)

    def acceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        index: int,
        update_kinematics: bool = True,
        reference_frame: ReferenceFrame = LOCAL,
    ) -> Motion:
        """Returns the spatial acceleration of a joint."""
        return kinematics.getAcceleration(*self._updated(update_kinematics, q, v, a), index, reference_frame)

    def classicalAcceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        index: int,
        update_kinematics: bool = True,
        reference_frame: ReferenceFrame = LOCAL,
    ) -> Motion:
        """Returns the classical acceleration of a joint."""
        return kinematics.getClassicalAcceleration(*self._updated(update_kinematics, q, v, a), index, reference_frame)

    def framePlacement(self, q: ArrayLike, index: int, update_kinematics: bool = True) -> SE3:
        """Returns the pose of a frame."""
        return kinematics.updateFramePlacement(*self._updated(update_kinematics, q), index)

    def frameVelocity(
        self,
        q: ArrayLike,
        v: ArrayLike,
        index: int,
        update_kinematics: bool = True,
        reference_frame: ReferenceFrame = LOCAL,
    ) -> Motion:
        """Returns the velocity of a frame."""
        return kinematics.getFrameVelocity(*self._updated(update_kinematics, q, v), index, reference_frame)

    def frameAcceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        index: int,
        update_kinematics: bool = True,
        reference_frame: ReferenceFrame = LOCAL,
    ) -> Motion:
        """Returns the spatial acceleration of a frame."""
        return kinematics.getFrameAcceleration(*self._updated(update_kinematics, q, v, a), index, reference_frame)

    def frameClassicalAcceleration(
        self,
        q: ArrayLike,
        v: ArrayLike,
        a: ArrayLike,
        index: int,
        update_kinematics: bool = True,
        reference_frame: ReferenceFrame = LOCAL,
    ) -> Motion:
        """Returns the classical acceleration of a frame."""
        return kinematics.getFrameClassicalAcceleration(*self._updated(update_kinematics, q, v, a), index, reference_frame)

    def computeJointJacobian(self, q: ArrayLike, index: int) -> Array:
        """Returns the LOCAL Jacobian of a joint (6, nv)."""
        return jacobians.computeJointJacobian(self.model, self.data, q, index)

    def computeJointJacobians(self, q: ArrayLike) -> Array:
        """Returns the columns of all joints' Jacobians in WORLD (6, nv)."""
        return jacobians.computeJointJacobians(self.model, self.data, q)

    def getJointJacobian(self, index: int, rf_frame: ReferenceFrame = LOCAL) -> Array:
        """Returns the Jacobian of a joint at the last computeJointJacobians (6, nv)."""
        return jacobians.getJointJacobian(self.model, self.data, index, rf_frame)

    def computeFrameJacobian(self, q: ArrayLike, frame_id: int) -> Array:
        """Returns the LOCAL Jacobian of a frame (6, nv)."""
        return jacobians.computeFrameJacobian(self.model, self.data, q, frame_id)

    def getFrameJacobian(self, frame_id: int, rf_frame: ReferenceFrame = LOCAL) -> Array:
        """Returns the Jacobian of a frame at the last computeJointJacobians (6, nv)."""
        return jacobians.getFrameJacobian(self.model, self.data, frame_id, rf_frame)

    # Models and volumes

    def updateGeometryPlacements(self, q: Optional[ArrayLike] = None, visual: bool = False) -> None:
        """Places the collision volumes, or the visual ones, at q or at the last forwardKinematics."""
        volumes = (self.visual_model, self.visual_data) if visual else (self.collision_model, self.collision_data)
        collision.updateGeometryPlacements(self.model, self.data, *volumes, *(() if q is None else (q,)))

    def buildReducedRobot(
        self,
        list_of_joints_to_lock: Sequence[Union[int, str]],
        reference_configuration: Optional[ArrayLike] = None,
    ) -> RobotWrapper:
        """Returns the robot with joints locked, given by index or name, at a configuration (by default neutral)."""
        locked = [self.model.getJointId(x) if isinstance(x, str) else x for x in list_of_joints_to_lock]
        q = configuration.neutral(self.model) if reference_configuration is None else reference_configuration
        volumes = [self.visual_model, self.collision_model]
        present = [x for x in volumes if x is not None]
        model, moved = edit.buildReducedModel(self.model, present, locked, q)
        visual_model, collision_model = (None if x is None else moved.pop(0) for x in volumes)
        return RobotWrapper(model, collision_model, visual_model)

    # Viewers are objects with the methods of BaseVisualizer.

    def setVisualizer(self, visualizer: Any, init: bool = True, copy_models: bool = False) -> None:
        """Sets the viewer; with init, gives it this robot's models first."""
        if init:
            visualizer.__init__(self.model, self.collision_model, self.visual_model, copy_models)
        self.viz = visualizer

    def _viewer(self):
        if self.viz is None:
            raise NotImplementedError("RobotWrapper has no viewer; give one to setVisualizer")
        return self.viz

    viewer = property(lambda self: self._viewer().viewer, doc="The viewer's own object.")

    def getViewerNodeName(self, geometry_object: GeometryObject, geometry_type: GeometryType) -> str:
        """Returns the viewer's name of a volume."""
        return self._viewer().getViewerNodeName(geometry_object, geometry_type)

    def initViewer(self, *arguments: Any, **named: Any) -> None:
        """Starts the viewer."""
        named.pop("share_data", None)
        self._viewer().initViewer(*arguments, **named)

    def loadViewerModel(self, *arguments: Any, **named: Any) -> None:
        """Gives the volumes to the viewer."""
        self._viewer().loadViewerModel(*arguments, **named)

    def display(self, q: ArrayLike) -> None:
        """Shows the robot at q."""
        self._viewer().display(q)

    def displayCollisions(self, visibility: bool) -> None:
        """Shows or hides collision volumes."""
        self._viewer().displayCollisions(visibility)

    def displayVisuals(self, visibility: bool) -> None:
        """Shows or hides visual volumes."""
        self._viewer().displayVisuals(visibility)

    def play(self, q_trajectory: ArrayLike, dt: float) -> None:
        """Shows configurations one after the other, dt [s] apart."""
        self._viewer().play(q_trajectory, dt)
