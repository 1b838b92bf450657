# SPDX-License-Identifier: BSD-2-Clause
"""Visualizers. libdyn has no viewer: derive from BaseVisualizer, and draw what its data hold."""

from __future__ import annotations

import contextlib
import time
from typing import TYPE_CHECKING, Any, NoReturn, Optional

from .shortcuts import createDatas

if TYPE_CHECKING:
    from collections.abc import Callable
    from numpy.typing import ArrayLike

    from ._types import Path
    from .data import Data
    from .geometry import GeometryData, GeometryModel
    from .geometry_object import GeometryObject, GeometryType
    from .model import Model

__all__ = [
    "BaseVisualizer",
    "GepettoVisualizer",
    "MeshcatVisualizer",
    "NoViewer",
    "Panda3dVisualizer",
    "RVizVisualizer",
    "Visualizer",
]


class BaseVisualizer:
    """Models and their data for a viewer of your own. Define display(q), and what else you use of the methods that raise NotImplementedError."""

    def __init__(
        self,
        model: Optional[Model] = None,
        collision_model: Optional[GeometryModel] = None,
        visual_model: Optional[GeometryModel] = None,
        copy_models: bool = False,
        data: Optional[Data] = None,
        collision_data: Optional[GeometryData] = None,
        visual_data: Optional[GeometryData] = None,
    ) -> None:
        models = (model, collision_model, visual_model)
        if copy_models:
            models = tuple(None if x is None else x.copy() for x in models)
        self.model, self.collision_model, self.visual_model = models
        made = createDatas(*models)
        given = (data, collision_data, visual_data)
        self.data, self.collision_data, self.visual_data = (new if old is None else old for new, old in zip(made, given))

    def rebuildData(self) -> None:
        """Makes the data anew, as needed after a change of the models."""
        self.data, self.collision_data, self.visual_data = createDatas(self.model, self.collision_model, self.visual_model)

    def getViewerNodeName(self, geometry_object: GeometryObject, geometry_type: GeometryType) -> None:
        """Returns the name of a volume in the viewer."""

    def initViewer(self, *args: Any, **named: Any) -> None:
        """Opens the viewer."""

    def loadViewerModel(self, *args: Any, **named: Any) -> None:
        """Gives the volumes to the viewer."""

    def reload(self, new_geometry_object: GeometryObject, geometry_type: Optional[GeometryType] = None) -> None:
        """Gives a changed volume to the viewer."""

    def clean(self) -> None:
        """Removes everything from the viewer."""

    def _missing(self, name):
        raise NotImplementedError(f"{type(self).__name__} has no {name}; libdyn has no viewer, so define it in a class of your own")

    def display(self, q: Optional[ArrayLike] = None) -> None:
        self._missing("display")

    def displayCollisions(self, visibility: bool) -> None:
        self._missing("displayCollisions")

    def displayVisuals(self, visibility: bool) -> None:
        self._missing("displayVisuals")

    def setBackgroundColor(self) -> None:
        self._missing("setBackgroundColor")

    def setCameraTarget(self, target: ArrayLike) -> None:
        self._missing("setCameraTarget")

    def setCameraPosition(self, position: ArrayLike) -> None:
        self._missing("setCameraPosition")

    def setCameraZoom(self, zoom: float) -> None:
        self._missing("setCameraZoom")

    def setCameraPose(self, pose: ArrayLike) -> None:
        self._missing("setCameraPose")

    def captureImage(self, w: Optional[int] = None, h: Optional[int] = None) -> Any:
        self._missing("captureImage")

    def disableCameraControl(self) -> None:
        self._missing("disableCameraControl")

    def enableCameraControl(self) -> None:
        self._missing("enableCameraControl")

    def drawFrameVelocities(self, *args: Any, **named: Any) -> None:
        self._missing("drawFrameVelocities")

    def sleep(self, dt: float) -> None:
        time.sleep(dt)

    def has_video_writer(self) -> bool:
        return False

    def play(
        self,
        q_trajectory: ArrayLike,
        dt: Optional[float] = None,
        callback: Optional[Callable[..., Any]] = None,
        capture: bool = False,
        **named: Any,
    ) -> Any:
        """Displays configurations one after the other, every dt [s]. With capture, returns the images."""
        images = []
        for i, q in enumerate(q_trajectory):
            begin = time.monotonic()
            self.display(q)
            if callback is not None:
                callback(i, **named)
            if capture:
                images.append(self.captureImage())
            rest = 0.0 if dt is None else dt - (time.monotonic() - begin)
            if rest > 0:
                self.sleep(rest)
        return images if capture else None

    def create_video_ctx(self, filename: Optional[Path] = None, fps: int = 30, directory: Optional[Path] = None, **named: Any) -> Any:
        """Returns a context that does nothing: videos are not written."""
        return contextlib.nullcontext()


class NoViewer(NotImplementedError, ImportError):
    """libdyn has no viewer. Scripts that go on without one where it is not installed catch ImportError, and so this."""


class _Absent(BaseVisualizer):
    def initViewer(self, *args: Any, **named: Any) -> NoReturn:
        """Raises NoViewer."""
        raise NoViewer(
            f"libdyn has no {type(self).__name__}: derive from libdyn.pinocchio.visualize.BaseVisualizer, place the volumes by "
            "updateGeometryPlacements, and give geometry_data.oMg to your viewer"
        )

    loadViewerModel = display = initViewer


class MeshcatVisualizer(_Absent):
    """Not there; initViewer() raises NoViewer."""


class GepettoVisualizer(_Absent):
    """Not there; initViewer() raises NoViewer."""


class Panda3dVisualizer(_Absent):
    """Not there; initViewer() raises NoViewer."""


class RVizVisualizer(_Absent):
    """Not there; initViewer() raises NoViewer."""


class Visualizer(_Absent):
    """Not there; initViewer() raises NoViewer."""
