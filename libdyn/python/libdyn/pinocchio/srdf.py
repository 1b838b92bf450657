# SPDX-License-Identifier: BSD-2-Clause
"""SRDF files: pairs that are not checked, reference configurations, rotor parameters."""

from __future__ import annotations

import math
import os
import xml.etree.ElementTree as ElementTree
from typing import TYPE_CHECKING

from .geometry import StdVec_CollisionPair

if TYPE_CHECKING:
    from ._types import Path
    from .geometry import GeometryModel
    from .model import Model

__all__ = [
    "loadReferenceConfigurations",
    "loadReferenceConfigurationsFromXML",
    "loadRotorParameters",
    "removeCollisionPairs",
    "removeCollisionPairsFromXML",
]


def _root(text, source):
    """Returns the element <robot>. Raises ValueError that names the source if there is none, and for a document type, which may hide entities."""
    if "<!DOCTYPE" in text:
        raise ValueError(f"{source}: a document type is not allowed")
    try:
        root = ElementTree.fromstring(text)
    except ElementTree.ParseError as error:
        raise ValueError(f"{source} is no XML: {error}") from None
    if root.tag != "robot":
        raise ValueError(f"{source}: the root element is <{root.tag}>; it must be <robot>")
    return root


def _file(filename):
    path = os.fspath(filename)
    if not path.endswith(".srdf"):
        raise ValueError(f"{path} is no .srdf file")
    try:
        with open(path, encoding="utf-8") as file:
            return file.read()
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None


def removeCollisionPairs(model: Model, geom_model: GeometryModel, srdf_filename: Path, verbose: bool = False) -> None:
    """Removes the pairs of volumes whose links an SRDF file disables by <disable_collisions>."""
    _remove(model, geom_model, _root(_file(srdf_filename), os.fspath(srdf_filename)), verbose)


def removeCollisionPairsFromXML(model: Model, geom_model: GeometryModel, srdf_xml_stream: str, verbose: bool = False) -> None:
    """Removes the pairs of volumes whose links the text of an SRDF file disables."""
    _remove(model, geom_model, _root(srdf_xml_stream, "the text"), verbose)


def _remove(model, geom_model, root, verbose):
    disabled = {frozenset((e.get("link1"), e.get("link2"))) for e in root.iter("disable_collisions")}

    def link(k):
        frame = geom_model.geometryObjects[k].parentFrame
        return model.frames[frame].name if frame < len(model.frames) else None

    kept = []
    for pair in geom_model.collisionPairs:
        links = frozenset((link(pair.first), link(pair.second)))
        if links not in disabled:
            kept.append(pair)
        elif verbose:
            print(f"Remove collision pair ({', '.join(map(str, links))})")
    geom_model.collisionPairs = StdVec_CollisionPair(kept)


def loadReferenceConfigurations(model: Model, srdf_filename: Path, verbose: bool = False) -> None:
    """Adds each <group_state> of an SRDF file to model.referenceConfigurations by its name; other joints are at neutral."""
    _references(model, _root(_file(srdf_filename), os.fspath(srdf_filename)), verbose)


def loadReferenceConfigurationsFromXML(model: Model, srdf_xml_stream: str, verbose: bool = False) -> None:
    """Adds each <group_state> of the text of an SRDF file to model.referenceConfigurations."""
    _references(model, _root(srdf_xml_stream, "the text"), verbose)


def _numbers(element, attribute):
    text = element.get(attribute, "")
    try:
        return [float(x) for x in text.split()]
    except ValueError:
        raise ValueError(f"<{element.tag} name='{element.get('name')}'>: {attribute} is {text!r}; it must be numbers") from None


def _references(model, root, verbose):
    from .configuration import neutral

    for state in root.iter("group_state"):
        q = neutral(model)
        for element in state.iter("joint"):
            name, values = element.get("name"), _numbers(element, "value")
            if not model.existJointName(name):
                if verbose:
                    print(f"The joint {name} is not in the model.")
                continue
            joint = model.joints[model.getJointId(name)]
            if joint.nq == 2 and joint.nv == 1 and len(values) == 1:  # an angle of a joint without limits
                values = [math.cos(values[0]), math.sin(values[0])]
            if len(values) != joint.nq:
                raise ValueError(f"group_state '{state.get('name')}': joint '{name}' has {len(values)} numbers; it needs {joint.nq}")
            q[joint.idx_q : joint.idx_q + joint.nq] = values
        model.referenceConfigurations[state.get("name")] = q


def loadRotorParameters(model: Model, srdf_filename: Path, verbose: bool = False) -> bool:
    """Reads <rotor_params> into model.rotorInertia, model.rotorGearRatio and model.armature; returns whether there was such an element."""
    root = _root(_file(srdf_filename), os.fspath(srdf_filename))
    found = False
    for parameters in root.iter("rotor_params"):
        found = True
        for element in parameters.iter("joint"):
            name = element.get("name")
            if not model.existJointName(name):
                if verbose:
                    print(f"The joint {name} is not in the model.")
                continue
            index = model.joints[model.getJointId(name)].idx_v
            (inertia,), (ratio,) = _numbers(element, "mass"), _numbers(element, "gear_ratio")
            model.rotorInertia[index] = inertia
            model.rotorGearRatio[index] = ratio
            model.armature[index] += inertia * ratio**2
    return found


