# SPDX-License-Identifier: BSD-2-Clause
"""Models made from other models: joints locked, or one model carried by another."""

from __future__ import annotations

from typing import Any

from .configuration import neutral
from .convert import index, vector
from .enums import FrameType
from .frames import Frame
from .joints import JointModelMimic
from .model import Model
from .spatial import SE3

_JOINTS = FrameType.JOINT | FrameType.FIXED_JOINT
_PER_V = ("rotorInertia", "rotorGearRatio", "armature")


def findCommonAncestor(model: Model, joint1_id: int, joint2_id: int) -> tuple[int, int, int]:
    """Returns the last joint that carries both joints, and its places in supports of the first and of the second."""
    first = model.supports[index(joint1_id, model.njoints, "findCommonAncestor", "joint1_id")]
    second = model.supports[index(joint2_id, model.njoints, "findCommonAncestor", "joint2_id")]
    k = 0
    while k + 1 < min(len(first), len(second)) and first[k + 1] == second[k + 1]:
        k += 1
    return first[k], k, k


def _copy_joint(source, i, target, parent, placement, name):
    """Adds a copy of joint i to another model, with its limits; returns its index."""
    joint = source.joints[i].copy()
    if isinstance(joint, JointModelMimic):
        followed = target.joints[target.getJointId(source.names[joint.followed])]
        joint = JointModelMimic(joint.own, followed, joint.scaling, joint.offset)
        return target.addJoint(parent, joint, placement, name)
    q = slice(source.idx_qs[i], source.idx_qs[i] + source.nqs[i])
    v = slice(source.idx_vs[i], source.idx_vs[i] + source.nvs[i])
    limits = (source.effortLimit[v], source.velocityLimit[v], source.lowerPositionLimit[q], source.upperPositionLimit[q])
    out = target.addJoint(parent, joint, placement, name, *limits, source.friction[v], source.damping[v])
    for key in _PER_V:
        getattr(target, key)[target.idx_vs[out] : target.idx_vs[out] + target.nvs[out]] = getattr(source, key)[v]
    return out


def _copy_configurations(source, target):
    """Adds the reference configurations of a model to another, for the joints of the same names."""
    for name, q in source.referenceConfigurations.items():
        moved = target.referenceConfigurations.get(name, neutral(target)).copy()
        for i in range(1, source.njoints):
            k = target.getJointId(source.names[i])
            if k < target.njoints and source.nqs[i]:
                moved[target.idx_qs[k] : target.idx_qs[k] + target.nqs[k]] = q[source.idx_qs[i] : source.idx_qs[i] + source.nqs[i]]
        target.referenceConfigurations[name] = moved


def buildReducedModel(model: Model, *arguments: Any, **named: Any) -> Any:
    """Returns the model with joints locked; with geometry, the tuple (model, geometry models).

    Arguments: [geom_model or list_of_geom_models,] list_of_joints_to_lock (indices), reference_configuration (nq,), at which they are locked.
    """
    keys = ["list_of_joints_to_lock", "reference_configuration"]
    several = "list_of_geom_models" in named
    if len(arguments) == 3 or several or "geom_model" in named:
        several = several or len(arguments) == 3 and isinstance(arguments[0], (list, tuple))
        keys.insert(0, "list_of_geom_models" if several else "geom_model")
    given = {**dict(zip(keys, arguments)), **named}
    q = vector(given["reference_configuration"], model.nq, "buildReducedModel", "reference_configuration")
    locked = {index(i, model.njoints, "buildReducedModel", "an entry of list_of_joints_to_lock") for i in given["list_of_joints_to_lock"]}
    if 0 in locked:
        raise ValueError("buildReducedModel: joint 0 is the universe, which cannot be locked")
    reduced, places = _reduce(model, locked, q)
    geometries = given.get("list_of_geom_models", given.get("geom_model"))
    if geometries is None:
        return reduced
    moved = [_move_geometry(model, g, reduced, places) for g in (geometries if several else [geometries])]
    return reduced, moved if several else moved[0]


def _reduce(model, locked, q):
    """Returns the reduced model, and for each joint the joint there that carries it with the pose in it."""
    from .kinematics import forwardKinematics

    data = model.createData()
    forwardKinematics(model, data, q)
    reduced = Model()
    reduced.name, reduced.gravity = model.name, model.gravity.copy()
    reduced.inertias[0] = model.inertias[0].copy()
    places = [(0, SE3.Identity())]
    for i in range(1, model.njoints):
        parent, offset = places[model.parents[i]]
        if i not in locked:
            k = _copy_joint(model, i, reduced, parent, offset * model.jointPlacements[i], model.names[i])
            before = reduced.getFrameId(model.names[model.parents[i]], _JOINTS) if model.parents[i] else 0
            reduced.addJointFrame(k, before)
            reduced.appendBodyToJoint(k, model.inertias[i], SE3.Identity())
            places.append((k, SE3.Identity()))
        else:
            at = offset * data.liMi[i]
            before = reduced.getFrameId(model.names[model.parents[i]], _JOINTS) if model.parents[i] else 0
            reduced.addFrame(Frame(model.names[i], parent, before, at, FrameType.FIXED_JOINT, model.inertias[i]))
            places.append((parent, at))
    for frame in model.frames[1:]:
        if frame.type == FrameType.JOINT and reduced.existFrame(frame.name, _JOINTS):
            continue
        joint, offset = places[frame.parentJoint]
        before = reduced.getFrameId(model.frames[frame.parentFrame].name, model.frames[frame.parentFrame].type | FrameType.FIXED_JOINT)
        before = before if before < reduced.nframes else 0
        reduced.addFrame(Frame(frame.name, joint, before, offset * frame.placement, frame.type, frame.inertia), False)
    _copy_configurations(model, reduced)
    return reduced, places


def _move_geometry(model, geometry, reduced, places):
    """Returns a geometry model for the reduced model."""
    out = type(geometry)()
    for each in geometry.geometryObjects:
        item = each.copy()
        joint, offset = places[each.parentJoint]
        item.parentJoint, item.placement = joint, offset * each.placement
        if 0 < each.parentFrame < model.nframes:
            item.parentFrame = reduced.getFrameId(model.frames[each.parentFrame].name)
        out.addGeometryObject(item)
    for pair in geometry.collisionPairs:
        out.addCollisionPair(pair)
    return out


def appendModel(modelA: Model, modelB: Model, *arguments: Any) -> Any:
    """Returns modelA with modelB carried by one of its frames; with geometry, the tuple (model, geometry).

    Arguments: [geomModelA, geomModelB,] frame_in_modelA (an index), aMb (the pose of modelB's universe in the frame). Names must differ.
    """
    if len(arguments) not in (2, 4):
        raise TypeError("appendModel: arguments are modelA, modelB, [geomModelA, geomModelB,] frame_in_modelA, aMb")
    *geometries, frame_id, aMb = arguments
    frame = modelA.frames[index(frame_id, modelA.nframes, "appendModel", "frame_in_modelA")]
    model = Model()
    model.name, model.gravity = modelA.name, modelA.gravity.copy()
    geometry = type(geometries[0])() if geometries else None
    carried = [modelA.supports[i] for i in range(modelA.njoints)]
    first = [i for i in range(1, modelA.njoints) if i <= frame.parentJoint or frame.parentJoint in carried[i]]
    last = [i for i in range(1, modelA.njoints) if i not in first]
    of_A, of_B = geometries or (None, None)
    _append(modelA, of_A, [0, *first], model, geometry, 0, 0, SE3.Identity())
    at = model.getFrameId(frame.name, frame.type)
    _append(modelB, of_B, range(modelB.njoints), model, geometry, model.frames[at].parentJoint, at, frame.placement * aMb)
    _append(modelA, of_A, last, model, geometry, 0, 0, SE3.Identity())
    for source in (modelA, modelB):
        _copy_configurations(source, model)
    if geometry is None:
        return model
    _copy_pairs(of_A, of_B, geometry)
    return model, geometry


def _append(source, source_geometry, joints, model, geometry, root, root_frame, placement):
    """Adds joints of `source` to `model`; its universe becomes `placement` in the joint `root`."""
    for i in joints:
        offset = SE3.Identity() if i else placement
        if i == 0:
            k = root
            if source.inertias[0].mass:
                model.inertias[k] = model.inertias[k] + placement.act(source.inertias[0])
        else:
            if model.existJointName(source.names[i]):
                raise ValueError(f"appendModel: both models have a joint '{source.names[i]}'")
            parent = model.getJointId(source.names[source.parents[i]]) if source.parents[i] else root
            where = source.jointPlacements[i] if source.parents[i] else placement * source.jointPlacements[i]
            k = _copy_joint(source, i, model, parent, where, source.names[i])
            model.appendBodyToJoint(k, source.inertias[i], SE3.Identity())
        for frame in source.frames[1:]:
            if frame.parentJoint == i:
                before = source.frames[frame.parentFrame]
                previous = model.getFrameId(before.name, before.type) if frame.parentFrame else root_frame
                if model.existFrame(frame.name, frame.type):
                    raise ValueError(f"appendModel: both models have a frame '{frame.name}'")
                model.addFrame(Frame(frame.name, k, previous, offset * frame.placement, frame.type, frame.inertia), False)
        for each in source_geometry.geometryObjects if source_geometry is not None else ():
            if each.parentJoint == i:
                item = each.copy()
                item.parentJoint, item.placement = k, offset * each.placement
                name = source.frames[each.parentFrame] if each.parentFrame < source.nframes else None
                item.parentFrame = model.getFrameId(name.name, name.type) if name is not None and each.parentFrame else root_frame
                geometry.addGeometryObject(item)


def _copy_pairs(of_A, of_B, geometry):
    """Adds the pairs of both geometry models, and those of one with the other where the two are on different joints."""
    for source in (of_A, of_B):
        for pair in source.collisionPairs:
            names = [source.geometryObjects[k].name for k in (pair.first, pair.second)]
            geometry.addCollisionPair(type(pair)(*map(geometry.getGeometryId, names)))
    if not (len(of_A.collisionPairs) or len(of_B.collisionPairs)):
        return
    kind = type((of_A.collisionPairs or of_B.collisionPairs)[0])
    for a in of_A.geometryObjects:
        for b in of_B.geometryObjects:
            first, second = geometry.getGeometryId(a.name), geometry.getGeometryId(b.name)
            if geometry.geometryObjects[first].parentJoint != geometry.geometryObjects[second].parentJoint:
                geometry.addCollisionPair(kind(first, second))


def transformJointIntoMimic(input_model: Model, index_mimicked: int, index_mimicking: int, scaling: float, offset: float) -> Model:
    """Returns the model in which one joint follows another: its coordinate becomes scaling * q + offset."""
    model = Model()
    model.name, model.gravity = input_model.name, input_model.gravity.copy()
    model.inertias[0] = input_model.inertias[0].copy()
    for i in range(1, input_model.njoints):
        parent, placement, name = input_model.parents[i], input_model.jointPlacements[i], input_model.names[i]
        if i == index(index_mimicking, input_model.njoints, "transformJointIntoMimic", "index_mimicking"):
            mimic = JointModelMimic(input_model.joints[i], model.joints[index_mimicked], scaling, offset)
            k = model.addJoint(parent, mimic, placement, name)
        else:
            k = _copy_joint(input_model, i, model, parent, placement, name)
        model.appendBodyToJoint(k, input_model.inertias[i], SE3.Identity())
    model.frames = [frame.copy() for frame in input_model.frames]
    _copy_configurations(input_model, model)
    return model
