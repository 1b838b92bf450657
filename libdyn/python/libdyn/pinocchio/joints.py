# SPDX-License-Identifier: BSD-2-Clause
"""Joint models: the sizes and axes that Pinocchio's classes have, and the libdyn joint types that they stand for."""

from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from .spatial import SE3

if TYPE_CHECKING:
    from numpy.typing import ArrayLike
    from typing_extensions import Self

    from ._types import Array
    from .joint_data import JointData

AXES = {"X": np.array([1.0, 0.0, 0.0]), "Y": np.array([0.0, 1.0, 0.0]), "Z": np.array([0.0, 0.0, 1.0])}


class _Copies(type):
    """Makes JointModel(other) a copy of a joint of any type."""

    def __call__(cls, *arguments: Any, **named: Any) -> Any:
        if cls is JointModel and len(arguments) == 1 and isinstance(arguments[0], JointModel):
            return copy.deepcopy(arguments[0])
        return super().__call__(*arguments, **named)


class JointModel(metaclass=_Copies):
    """A joint of a model. JointModel(other) copies a joint; the classes of single types are derived from this one.

    Attributes: id, idx_q, idx_v and idx_vExtended, which addJoint sets; nq, nv and nvExtended.
    """

    nq = nv = 0

    def __init__(self) -> None:
        if type(self) is JointModel:
            raise TypeError("JointModel: give a joint of one type, such as JointModelRX()")
        self.id = self.idx_q = self.idx_v = self.idx_vExtended = -1

    @property
    def nvExtended(self) -> int:
        return self.nv

    def shortname(self) -> str:
        """Returns the name of the type, such as "JointModelRX"."""
        return type(self).__name__

    @classmethod
    def classname(cls) -> Any:
        """Returns the name of the type, such as "JointModelRX"."""
        return cls.__name__

    def setIndexes(self, id: int, idx_q: int, idx_v: int, idx_vExtended: Optional[int] = None) -> None:  # noqa: A002
        """Sets the place of the joint in a model."""
        self.id, self.idx_q, self.idx_v = id, idx_q, idx_v
        self.idx_vExtended = idx_v if idx_vExtended is None else idx_vExtended

    def hasSameIndexes(self, other: JointModel) -> bool:
        """Returns whether another joint has the same place."""
        return (self.id, self.idx_q, self.idx_v) == (other.id, other.idx_q, other.idx_v)

    def parts(self) -> Any:
        """Returns the libdyn joints in series that make this one: tuples (type, parameters, placement or None). The universe has none."""
        return []

    def quaternions(self) -> list[Any]:
        """Returns the places of quaternions among the joint's coordinates."""
        return []

    def hasConfigurationLimit(self) -> list[bool]:
        """Returns a list of nq booleans: whether a coordinate has limits."""
        return [True] * self.nq

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        """Returns a list of nv booleans: whether a degree of freedom has limits."""
        return [True] * self.nv

    def extract(self) -> Any:
        """Returns the joint of its own type."""
        return self

    def copy(self) -> Self:
        """Returns a copy."""
        return copy.deepcopy(self)

    def createData(self) -> JointData:
        """Returns memory for calc()."""
        from .joint_data import JointData

        return JointData(self)

    def calc(self, jdata: JointData, q: ArrayLike, v: Optional[ArrayLike] = None) -> None:
        """Computes the joint's own motion at its part of q and v, and stores it in jdata: M, S, v, c."""
        jdata.calc(np.asarray(q, dtype=float), None if v is None else np.asarray(v, dtype=float))

    def __eq__(self, other: JointModel) -> bool:
        return type(self) is type(other) and self.hasSameIndexes(other) and _same(self.parts(), other.parts())

    def __repr__(self) -> str:
        return f"{self.shortname()}\n  index: {self.id}\n  index q: {self.idx_q}\n  index v: {self.idx_v}\n  nq: {self.nq}\n  nv: {self.nv}\n"

    __hash__ = None


def _same(a, b):
    """Returns whether two lists of parts are equal."""
    return len(a) == len(b) and all(
        x[0] == y[0]
        and x[1].keys() == y[1].keys()
        and all(np.array_equal(x[1][k], y[1][k]) for k in x[1])
        and (x[2] is None) == (y[2] is None)
        and (x[2] is None or x[2] == y[2])
        for x, y in zip(a, b)
    )


class _Simple(JointModel):
    """A joint that is one libdyn joint without parameters."""

    kind = ""

    def parts(self) -> list[tuple[Any, ...]]:
        return [(self.kind, {}, None)]


class _Axis(JointModel):
    """A joint along one axis of its frame."""

    kind = ""
    nq = nv = 1
    axis = None

    def getMotionAxis(self) -> Array:
        """Returns the axis (3,)."""
        return self.axis.copy()

    def parts(self) -> list[tuple[Any, ...]]:
        return [(self.kind, {"axis": list(map(float, self.axis))}, None)]


class _Unaligned(_Axis):
    """A joint along any axis, given by one vector or three numbers; the axis is scaled to norm one."""

    def __init__(self, *axis: Any) -> None:
        super().__init__()
        given = np.array(axis[0] if len(axis) == 1 else axis or AXES["X"], dtype=float).ravel()
        if given.shape != (3,) or not np.linalg.norm(given) > 0:
            raise ValueError(f"{type(self).__name__}: axis must be three numbers that are not all zero")
        self.axis = given / np.linalg.norm(given)


class JointModelRevoluteUnaligned(_Unaligned):
    """A rotation [rad] about any axis."""

    kind = "revolute"


class JointModelRevoluteUnboundedUnaligned(_Unaligned):
    """A rotation about any axis, without end; q = (cos, sin)."""

    kind, nq = "continuous", 2

    def hasConfigurationLimit(self) -> list[bool]:
        return [False, False]

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        return [False]


class JointModelPrismaticUnaligned(_Unaligned):
    """A translation [m] along any axis."""

    kind = "prismatic"


class JointModelHelicalUnaligned(_Unaligned):
    """A rotation [rad] about any axis with a translation along it, by `pitch` [m/rad]. Arguments: axis, pitch, or x, y, z, pitch."""

    kind = "helical"

    def __init__(self, *arguments: Any) -> None:
        super().__init__(*arguments[:-1])
        self.pitch = float(arguments[-1]) if arguments else 0.0

    def parts(self) -> Any:
        return [(self.kind, {"axis": list(self.axis), "pitch": self.pitch}, None)]


class JointModelUniversal(JointModel):
    """Two rotations [rad], the first about axis1, the second about axis2, which turns with the first."""

    nq = nv = 2

    def __init__(self, *axes: Any) -> None:
        super().__init__()
        numbers = np.concatenate([np.ravel(x) for x in axes]).astype(float) if axes else np.r_[AXES["X"], AXES["Y"]]
        if numbers.shape != (6,):
            raise ValueError("JointModelUniversal: give two axes of three numbers")
        self.axis1, self.axis2 = numbers[:3].copy(), numbers[3:].copy()

    def parts(self) -> Any:
        return [("universal", {"axis": list(self.axis1), "axis2": list(self.axis2)}, None)]


class JointModelSpherical(_Simple):
    """A rotation; q = (x, y, z, w), a quaternion; v is the angular velocity in the moving frame [rad/s]."""

    kind, nq, nv = "spherical", 4, 3

    def quaternions(self) -> list[int]:
        return [0]

    def hasConfigurationLimit(self) -> list[bool]:
        return [False] * 4

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        return [False] * 3


class JointModelSphericalZYX(_Simple):
    """Rotations about z, y and x, in this order [rad]; v = dq/dt."""

    kind, nq, nv = "spherical_zyx", 3, 3


class JointModelTranslation(_Simple):
    """A translation along x, y and z [m]."""

    kind, nq, nv = "translation", 3, 3


class JointModelPlanar(_Simple):
    """A motion in the plane; q = (x, y, cos, sin), v = (vx, vy, w) in the moving frame."""

    kind, nq, nv = "planar", 4, 3

    def hasConfigurationLimit(self) -> list[bool]:
        return [True, True, False, False]

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        return [True, True, False]


class JointModelFreeFlyer(_Simple):
    """A free motion; q = position and quaternion (x, y, z, w), v = linear and angular velocity in the moving frame."""

    kind, nq, nv = "free_flyer", 7, 6

    def quaternions(self) -> list[int]:
        return [3]

    def hasConfigurationLimit(self) -> list[bool]:
        return [True] * 3 + [False] * 4

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        return [True] * 3 + [False] * 3


def _aligned(name, base, axis, doc):
    """Returns the class of joints of `base` along x, y or z."""

    def init(self):
        JointModel.__init__(self)
        self.axis = AXES[axis].copy()

    return type(f"JointModel{name}{axis}", (base,), {"__init__": init, "__doc__": doc, "__module__": __name__})


def _helical(axis):
    """Returns the class of helical joints along x, y or z."""

    def init(self, pitch=0.0):
        JointModelHelicalUnaligned.__init__(self, AXES[axis], pitch)

    doc = f"A helical joint along {axis.lower()}."
    return type(f"JointModelH{axis}", (JointModelHelicalUnaligned,), {"__init__": init, "__doc__": doc, "__module__": __name__})


for _axis in "XYZ":
    for _name, _base, _doc in (
        ("R", JointModelRevoluteUnaligned, "A rotation [rad] about {}."),
        ("RUB", JointModelRevoluteUnboundedUnaligned, "A rotation about {}, without end; q = (cos, sin)."),
        ("P", JointModelPrismaticUnaligned, "A translation [m] along {}."),
    ):
        globals()[f"JointModel{_name}{_axis}"] = _aligned(_name, _base, _axis, _doc.format(_axis.lower()))
    globals()[f"JointModelH{_axis}"] = _helical(_axis)


class JointModelComposite(JointModel):
    """Joints in series. Arguments: nothing, a number of joints to expect, or the first joint and its placement."""

    def __init__(self, joint_model: Optional[JointModel] = None, joint_placement: Optional[SE3] = None) -> None:
        super().__init__()
        self.joints, self.jointPlacements = [], []
        if isinstance(joint_model, JointModel):
            self.addJoint(joint_model, joint_placement)

    nq: int = property(lambda self: sum(x.nq for x in self.joints))
    nv: int = property(lambda self: sum(x.nv for x in self.joints))
    njoints = property(lambda self: len(self.joints))

    def addJoint(self, joint_model: JointModel, joint_placement: Optional[SE3] = None) -> JointModelComposite:
        """Adds a joint at a placement in the frame of the one before; returns self."""
        if not isinstance(joint_model, JointModel):
            raise TypeError(f"addJoint: joint_model must be a JointModel, not {type(joint_model).__name__}")
        self.joints.append(joint_model.copy())
        self.jointPlacements.append(SE3.Identity() if joint_placement is None else joint_placement.copy())
        return self

    def parts(self) -> list[tuple[str, Any, SE3]]:
        out = []
        for joint, placement in zip(self.joints, self.jointPlacements):
            first, *rest = joint.parts()
            out.append((first[0], first[1], placement if first[2] is None else placement * first[2]))
            out.extend(rest)
        return out

    def quaternions(self) -> list[Any]:
        starts = np.cumsum([0, *(joint.nq for joint in self.joints)])
        return [int(start) + at for start, joint in zip(starts, self.joints) for at in joint.quaternions()]

    def hasConfigurationLimit(self) -> list[bool]:
        return [x for joint in self.joints for x in joint.hasConfigurationLimit()]

    def hasConfigurationLimitInTangent(self) -> list[bool]:
        return [x for joint in self.joints for x in joint.hasConfigurationLimitInTangent()]


class JointModelMimic(JointModel):
    """A joint whose coordinate is scaling * q + offset, with q that of another joint of the model; it has no coordinate of its own.

    Arguments: the joint that it follows, scaling, offset; or its own joint, the joint that it follows, scaling, offset.
    """

    def __init__(self, joint_model: JointModel, *rest: Any) -> None:
        super().__init__()
        if len(rest) not in (2, 3):
            raise TypeError("JointModelMimic: give the joint that it follows, scaling and offset")
        followed = rest[0] if len(rest) == 3 else joint_model
        if followed.nv != 1 or followed.nq != 1 or joint_model.nq != 1:
            raise ValueError("JointModelMimic: both joints must have one coordinate")
        self._joint, self._followed = joint_model.copy(), followed.id
        self.scaling, self.offset = map(float, rest[-2:])

    @property
    def nvExtended(self) -> int:
        return self._joint.nvExtended

    @property
    def followed(self) -> int:
        """The index of the joint that it follows."""
        return self._followed

    @property
    def own(self) -> Any:
        """The joint itself, without what it follows."""
        return self._joint

    def parts(self) -> list[tuple[Any, ...]]:
        return self._joint.parts()

    def __eq__(self, other: JointModel) -> bool:
        return super().__eq__(other) and (self._followed, self.scaling, self.offset) == (other._followed, other.scaling, other.offset)

    __hash__ = None
