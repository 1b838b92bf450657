# SPDX-License-Identifier: BSD-2-Clause
"""The model: joints, inertias and frames that may be changed at any time. Algorithms compile it when they first need it, and after changes."""

from __future__ import annotations

import copy
import sys
import weakref
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from .compiled import Compiled
from .containers import StdMap_String_VectorXd
from .convert import index, vector
from .elements import Watched
from .enums import ALL_FRAMES, FrameType
from .frames import Frame
from .inertia import Inertia
from .joints import JointModel, JointModelMimic
from .serialization import Serializable
from .spatial import SE3, Motion

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array
    from .data import Data

_PER_JOINT = ("names", "parents", "children", "joints", "inertias", "jointPlacements", "idx_qs", "nqs", "idx_vs", "nvs")
_PER_Q = ("lowerPositionLimit", "upperPositionLimit")
_PER_V = ("velocityLimit", "effortLimit", "rotorInertia", "rotorGearRatio", "friction", "damping")
_NONE = np.finfo(float).max
# A part is held by the model and by its entry among the lent ones; the loop and the call that count hold it, too.
_OWN_REFERENCES = 4


class Model(Serializable):
    """A robot, as Pinocchio's Model. Joint 0 is the universe.

    Lists have one entry for each joint: names, parents, children, joints, inertias (in the joint's frame), jointPlacements (in the parent's frame),
    idx_qs, nqs, idx_vs, nvs, supports, subtrees. Arrays: lowerPositionLimit and upperPositionLimit (nq,); velocityLimit, effortLimit, armature,
    rotorInertia, rotorGearRatio, friction and damping (nv,). Friction and damping have no influence, as in Pinocchio.
    """

    gravity981 = np.array([0.0, 0.0, -9.81])

    if TYPE_CHECKING:
        name: str
        names: list[str]
        parents: list[int]
        children: list[list[int]]
        joints: list[JointModel]
        inertias: list[Inertia]
        jointPlacements: list[SE3]
        frames: list[Frame]
        supports: list[list[int]]
        subtrees: list[list[int]]
        idx_qs: list[int]
        nqs: list[int]
        idx_vs: list[int]
        nvs: list[int]
        nq: int
        nv: int
        nbodies: int
        njoints: int
        nframes: int
        gravity: Motion
        lowerPositionLimit: Array
        upperPositionLimit: Array
        velocityLimit: Array
        effortLimit: Array
        armature: Array
        rotorInertia: Array
        rotorGearRatio: Array
        friction: Array
        damping: Array
        referenceConfigurations: StdMap_String_VectorXd

    def __init__(self, other: Optional[Model] = None) -> None:
        self._compiled, self._lent = None, {}
        if other is not None:
            self.__setstate__(copy.deepcopy(other.__getstate__()))
            return
        self.name = ""
        self.nq = self.nv = self.nvExtended = 0
        self.nbodies = 1
        root = JointModel.__new__(JointModel)
        root.id, root.idx_q, root.idx_v, root.idx_vExtended = 0, 0, 0, 0
        first = ("universe", 0, [], root, Inertia.Zero(), SE3.Identity(), 0, 0, 0, 0)
        for name, item in zip(_PER_JOINT, first):
            setattr(self, name, [item])
        self.idx_vExtendeds, self.nvExtendeds = [0], [0]
        for name in (*_PER_Q, *_PER_V):
            setattr(self, name, np.zeros(0))
        self.armature = np.zeros(0)
        self.frames = [Frame("universe", 0, 0, SE3.Identity(), FrameType.FIXED_JOINT)]
        self.supports, self.subtrees = [[0]], [[0]]
        self.mimicking_joints, self.mimicked_joints = [], []
        self.referenceConfigurations = StdMap_String_VectorXd()
        self.gravity = Motion(self.gravity981, np.zeros(3))

    # Inputs of algorithms are watched: parts that a program may hold are compared before each use.

    def _watched(name):  # noqa: N805
        def get(self):
            items = self.__dict__["_" + name]
            items.owner = weakref.ref(self)
            return items

        def put(self, items):
            items = self.__dict__["_" + name] = Watched(items)
            # Joints are asked for their indices all the time; their axes do not change after addJoint. Parents are numbers.
            items.lends = "" if name in ("joints", "parents") else name
            self.changed()

        return property(get, put)

    def _lendable(name):  # noqa: N805
        def get(self):
            item = self.__dict__["_" + name]
            self.lend(name, item)
            return item

        def put(self, item):
            self.__dict__["_" + name] = np.asarray(item, dtype=float) if name == "armature" else item
            self.changed()

        return property(get, put)

    parents, joints, inertias, jointPlacements = map(_watched, ("parents", "joints", "inertias", "jointPlacements"))
    armature, gravity = map(_lendable, ("armature", "gravity"))

    def changed(self) -> None:
        """Notes that the compiled model is out of date."""
        self._compiled = None
        self._lent.clear()

    def lend(self, key: Any, item: Any) -> None:
        """Notes that a program may hold a part of the model, and so change it later."""
        if key not in self._lent:
            self._lent[key] = (item, _fingerprint(item))

    def compiled(self) -> Compiled:
        """Returns the Compiled of the model as it is now."""
        for key, (item, before) in list(self._lent.items()) if self._lent else ():
            if _fingerprint(item) != before:
                self.changed()
                break
            if sys.getrefcount(item) == _OWN_REFERENCES:
                del self._lent[key]  # nobody can change it any more; views of its numbers would hold it
        if self._compiled is None:
            self._compiled = Compiled(self)
        return self._compiled

    def physics(self) -> tuple[Motion, Array]:
        """Returns gravity and armature, for a reader that changes neither."""
        return self.__dict__["_gravity"], self.__dict__["_armature"]

    njoints = property(lambda self: len(self.names), doc="The number of joints, the universe included.")
    nframes = property(lambda self: len(self.frames), doc="The number of frames, the universe included.")

    def addJoint(
        self,
        parent_id: int,
        joint_model: JointModel,
        joint_placement: SE3,
        joint_name: str,
        max_effort: Optional[ArrayLike] = None,
        max_velocity: Optional[ArrayLike] = None,
        min_config: Optional[ArrayLike] = None,
        max_config: Optional[ArrayLike] = None,
        friction: Optional[ArrayLike] = None,
        damping: Optional[ArrayLike] = None,
    ) -> int:
        """Adds a joint at joint_placement in the frame of the joint parent_id; returns its index. By default limits are the largest numbers."""
        parent_id = index(parent_id, self.njoints, "addJoint", "parent_id")
        if not isinstance(joint_model, JointModel):
            raise TypeError(f"addJoint: joint_model must be a JointModel, not {type(joint_model).__name__}")
        joint, nq, nv = joint_model.copy(), joint_model.nq, joint_model.nv
        given = {
            "effortLimit": (max_effort, nv, _NONE),
            "velocityLimit": (max_velocity, nv, _NONE),
            "lowerPositionLimit": (min_config, nq, -_NONE),
            "upperPositionLimit": (max_config, nq, _NONE),
            "friction": (friction, nv, 0.0),
            "damping": (damping, nv, 0.0),
            "armature": (None, nv, 0.0),
            "rotorInertia": (None, nv, 0.0),
            "rotorGearRatio": (None, nv, 1.0),
        }
        more = {n: np.full(size, default) if x is None else vector(np.atleast_1d(x), size, "addJoint", n) for n, (x, size, default) in given.items()}
        i = self.njoints
        place = (self.nq, self.nv)
        if isinstance(joint, JointModelMimic):
            followed = index(joint.followed, self.njoints, "addJoint", "the joint that a JointModelMimic follows")
            place = (self.idx_qs[followed], self.idx_vs[followed])
            self.mimicking_joints.append(i)
            self.mimicked_joints.append(followed)
        joint.setIndexes(i, *place, self.nvExtended)
        self.children[parent_id].append(i)
        items = (str(joint_name), parent_id, [], joint, Inertia.Zero(), joint_placement.copy(), place[0], nq, place[1], nv)
        for name, item in zip(_PER_JOINT, items):
            getattr(self, name).append(item)
        self.idx_vExtendeds.append(self.nvExtended)
        self.nvExtendeds.append(joint.nvExtended)
        self.nq, self.nv, self.nvExtended = self.nq + nq, self.nv + nv, self.nvExtended + joint.nvExtended
        for name, x in more.items():
            setattr(self, name, np.concatenate([getattr(self, name), x]))
        self.supports.append([*self.supports[parent_id], i])
        self.subtrees.append([])
        for ancestor in self.supports[i]:
            self.subtrees[ancestor].append(i)
        return i

    def addJointFrame(self, joint_id: int, frame_id: int = 0) -> int:
        """Adds the frame of a joint; returns its index. frame_id is the frame before it; 0: that of the parent joint."""
        joint_id = index(joint_id, self.njoints, "addJointFrame", "joint_id")
        if frame_id <= 0:
            parent = self.parents[joint_id]
            frame_id = self.getFrameId(self.names[parent], FrameType.JOINT | FrameType.FIXED_JOINT) if parent else 0
        return self.addFrame(Frame(self.names[joint_id], joint_id, int(frame_id), SE3.Identity(), FrameType.JOINT))

    def appendBodyToJoint(self, joint_id: int, body_inertia: Inertia, body_placement: Optional[SE3] = None) -> None:
        """Adds the inertia of a body at body_placement in the joint's frame."""
        joint_id = index(joint_id, self.njoints, "appendBodyToJoint", "joint_id")
        moved = body_inertia if body_placement is None else body_placement.act(body_inertia)
        self.inertias[joint_id] = self.inertias[joint_id] + moved
        self.nbodies += 1

    def addBodyFrame(self, body_name: str, parentJoint: int, body_placement: Optional[SE3] = None, previous_frame: int = -1) -> int:
        """Adds the frame of a body; returns its index."""
        parentJoint = index(parentJoint, self.njoints, "addBodyFrame", "parentJoint")
        if previous_frame < 0:
            previous_frame = self.getFrameId(self.names[parentJoint], FrameType.JOINT | FrameType.FIXED_JOINT)
        placement = SE3.Identity() if body_placement is None else body_placement
        return self.addFrame(Frame(body_name, parentJoint, int(previous_frame), placement, FrameType.BODY))

    def addFrame(self, frame: Frame, append_inertia: bool = True) -> int:
        """Adds a frame; returns its index. Its inertia is added to that of its joint. Raises ValueError if a frame of that name and type exists."""
        if not isinstance(frame, Frame):
            raise TypeError(f"addFrame: frame must be a Frame, not {type(frame).__name__}")
        index(frame.parentJoint, self.njoints, "addFrame", "frame.parentJoint")
        if self.existFrame(frame.name, frame.type):
            raise ValueError(f"addFrame: the model has a frame '{frame.name}' of this type already")
        self.frames.append(frame.copy())
        if append_inertia and frame.inertia.mass + np.abs(np.asarray(frame.inertia.inertia)).max() > 0:
            self.inertias[frame.parentJoint] = self.inertias[frame.parentJoint] + frame.placement.act(frame.inertia)
        return self.nframes - 1

    def getJointId(self, name: str) -> int:
        """Returns the index of a joint by name; njoints if there is none."""
        return self.names.index(name) if name in self.names else self.njoints

    def existJointName(self, name: str) -> bool:
        """Returns whether a joint has this name."""
        return name in self.names

    def getFrameId(self, name: str, type: FrameType = ALL_FRAMES) -> int:  # noqa: A002
        """Returns the index of the first frame with this name and one of the types; nframes if there is none."""
        for k, frame in enumerate(self.frames):
            if frame.name == name and frame.type & type:
                return k
        return self.nframes

    def existFrame(self, name: str, type: FrameType = ALL_FRAMES) -> bool:  # noqa: A002
        """Returns whether a frame has this name and one of the types."""
        return self.getFrameId(name, type) < self.nframes

    def getBodyId(self, name: str) -> int:
        """Returns the index of the frame of a body by name; nframes if there is none."""
        return self.getFrameId(name, FrameType.BODY)

    def existBodyName(self, name: str) -> bool:
        """Returns whether a body has this name."""
        return self.existFrame(name, FrameType.BODY)

    def hasConfigurationLimit(self) -> list[bool]:
        """Returns a list of nq booleans: whether a coordinate has limits."""
        return [x for joint in self.joints[1:] for x in joint.hasConfigurationLimit()]

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        """Returns a list of nv booleans: whether a degree of freedom has limits."""
        return [x for joint in self.joints[1:] for x in joint.hasConfigurationLimitInTangent()]

    def createData(self) -> Data:
        """Returns memory for the results of algorithms."""
        from .data import Data

        return Data(self)

    def check(self, data: Data) -> bool:
        """Returns whether `data` has the sizes of this model."""
        return data.sizes == (self.nq, self.nv, self.njoints)

    def copy(self) -> Model:
        """Returns a copy."""
        return Model(self)

    def __getstate__(self) -> Any:
        return {key: x for key, x in self.__dict__.items() if key not in ("_compiled", "_lent")}

    def __setstate__(self, state: Any) -> None:
        self._compiled, self._lent = None, {}
        for key, x in state.items():
            setattr(self, key[1:] if key.startswith("_") else key, x)

    def __copy__(self) -> Self:
        return self.copy()

    def __deepcopy__(self, memo: Any) -> Self:
        return self.copy()

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Model):
            return NotImplemented
        mine, theirs = self.__getstate__(), other.__getstate__()
        return mine.keys() == theirs.keys() and all(_equal(mine[key], theirs[key]) for key in mine)

    def __repr__(self) -> str:
        lines = [f"Nb joints = {self.njoints} (nq={self.nq},nv={self.nv})"]
        lines += [f"  Joint {i} {name}: parent={self.parents[i]}" for i, name in enumerate(self.names)]
        return "\n".join(lines) + "\n"

    __hash__ = object.__hash__


def _fingerprint(x):
    """Returns the numbers of a part of a model, to find out whether it has changed."""
    if isinstance(x, np.ndarray):
        return x.tobytes()
    if isinstance(x, Inertia):
        return x.mass, x.com.tobytes(), x.rotational.tobytes()
    if isinstance(x, SE3):
        return x.R.tobytes(), x.p.tobytes()
    return x.vector.tobytes()


def _equal(a, b):
    """Returns whether two members of models are equal."""
    if isinstance(a, dict):
        return a.keys() == b.keys() and all(np.array_equal(a[k], b[k]) for k in a)
    if isinstance(a, (list, tuple)):
        return len(a) == len(b) and all(_equal(x, y) for x, y in zip(a, b))
    return np.array_equal(a, b) if isinstance(a, np.ndarray) else a == b
