# SPDX-License-Identifier: BSD-2-Clause
"""Volumes of URDF files."""

from __future__ import annotations

import os
import warnings
import xml.etree.ElementTree as ElementTree
from typing import TYPE_CHECKING, Any, Optional

import numpy as np

from . import hppfcl
from .geometry import GeometryModel, GeometryObject, GeometryType
from .rpy import rpyToMatrix
from .spatial import SE3

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ._types import Path
    from .hppfcl import MeshLoader
    from .model import Model

__all__ = ["buildGeomFromUrdf", "buildGeomFromUrdfString"]

_GREY = (0.9, 0.9, 0.9, 1.0)


def buildGeomFromUrdf(
    model: Model,
    urdf_filename: Path,
    geom_type: GeometryType,
    geometry_model: Any = None,
    package_dirs: Any = None,
    mesh_loader: Optional[MeshLoader] = None,
) -> GeometryModel:
    """Reads the volumes of a URDF file, those for collision or those for viewers, and returns a GeometryModel.

    geometry_model: the model to which they are added; None: a new one. package_dirs: folders for package://, a path or a list of them.
    Raises ValueError if the file or a mesh is not found, or the model has no such link.
    """
    path = os.fspath(urdf_filename)
    try:
        with open(path, encoding="utf-8") as file:
            text = file.read()
    except OSError as error:
        raise ValueError(f"{path} cannot be read: {error.strerror}") from None
    return _build(model, text, path, geom_type, geometry_model, package_dirs, mesh_loader)


def buildGeomFromUrdfString(
    model: Model,
    urdf_string: str,
    geom_type: GeometryType,
    geometry_model: Any = None,
    package_dirs: Any = None,
    mesh_loader: Optional[MeshLoader] = None,
) -> GeometryModel:
    """Reads the volumes in the text of a URDF file, as buildGeomFromUrdf does."""
    return _build(model, urdf_string, "the text", geom_type, geometry_model, package_dirs, mesh_loader)


def _build(model, text, source, geom_type, geometry_model, package_dirs, mesh_loader):
    if geometry_model is not None and not isinstance(geometry_model, GeometryModel):
        warnings.warn("package folders were given as geometry_model; give them as package_dirs", UserWarning, stacklevel=3)
        geometry_model, package_dirs, mesh_loader = None, geometry_model, mesh_loader or package_dirs
    out = GeometryModel() if geometry_model is None else geometry_model
    robot = _Robot(text, source, _folders(package_dirs), mesh_loader or hppfcl.MeshLoader())
    tag = "visual" if geom_type == GeometryType.VISUAL else "collision"
    for link in robot.links_in_order():
        for volume in robot.volumes(model, link, tag):
            out.addGeometryObject(volume)
    return out


def _folders(package_dirs):
    if package_dirs is None:
        package_dirs = []
    elif isinstance(package_dirs, (str, os.PathLike)):
        package_dirs = [package_dirs]
    environment = os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep)
    return [os.fspath(x) for x in package_dirs] + [x for x in environment if x]


def _numbers(element, attribute, count, default=None):
    text = element.get(attribute)
    if text is None and default is not None:
        return np.array(default, dtype=float)
    try:
        values = [float(x) for x in (text or "").split()]
    except ValueError:
        values = []
    if len(values) != count:
        raise ValueError(f"<{element.tag}>: {attribute} is {text!r}; it must have {count} numbers")
    return np.array(values)


class _Robot:
    """The links and joints of a URDF file."""

    def __init__(self, text: str, source: str, folders: Any, mesh_loader: MeshLoader) -> None:
        if "<!DOCTYPE" in text:
            raise ValueError(f"{source}: a document type is not allowed")
        try:
            self._root = ElementTree.fromstring(text)
        except ElementTree.ParseError as error:
            raise ValueError(f"{source} is no XML: {error}") from None
        self._source, self._folders, self._mesh_loader = source, folders, mesh_loader
        self._links = {link.get("name"): link for link in self._root.findall("link")}
        self._materials = {m.get("name"): m for m in self._root.findall("material")}

    def links_in_order(self) -> Iterator[Any]:
        """Yields links depth first, children in the order of their joints' names."""
        joints = sorted(self._root.findall("joint"), key=lambda joint: joint.get("name", ""))
        children, carried = {}, set()
        for joint in joints:
            parent, child = joint.find("parent"), joint.find("child")
            if parent is not None and child is not None:
                children.setdefault(parent.get("link"), []).append(child.get("link"))
                carried.add(child.get("link"))
        waiting = [name for name in self._links if name not in carried][::-1]
        while waiting:
            name = waiting.pop()
            if name in self._links:
                yield self._links[name]
            waiting.extend(reversed(children.pop(name, [])))

    def volumes(self, model: Model, link: Any, tag: str) -> Iterator[Any]:
        """Yields the volumes of a link."""
        elements = [e for e in link.findall(tag) if e.find("geometry") is not None]
        if not elements:
            return
        name = link.get("name")
        frame = model.getBodyId(name)
        if frame >= len(model.frames):
            raise ValueError(f"{self._source}: the model has no body '{name}'")
        record = model.frames[frame]
        for number, element in enumerate(elements):
            shape, path, scale = self._shape(link, element)
            options = self._look(element) if tag == "visual" else {}
            yield GeometryObject(
                f"{name}_{number}", record.parentJoint, frame, record.placement * _pose(element.find("origin")), shape, path, scale, **options
            )

    def _shape(self, link, element):
        """Returns a shape, the path of its mesh or the name of its kind, and its scale."""
        shapes = list(element.find("geometry"))
        if len(shapes) != 1:
            raise ValueError(f"{self._source}: a <geometry> of link '{link.get('name')}' has {len(shapes)} shapes; it must have one")
        shape, one = shapes[0], np.ones(3)
        asked = {e.tag for block in link.findall("collision_checking") for e in block if e.get("name") == element.get("name")}
        if shape.tag == "mesh":
            path, scale = self._path(shape.get("filename", "")), _numbers(shape, "scale", 3, one)
            mesh = self._mesh_loader.load(path, scale)
            return (mesh.convex if "convex" in asked else mesh), path, scale
        if shape.tag == "sphere":
            return hppfcl.Sphere(_numbers(shape, "radius", 1)[0]), "SPHERE", one
        if shape.tag == "box":
            return hppfcl.Box(_numbers(shape, "size", 3)), "BOX", one
        if shape.tag in ("cylinder", "capsule"):
            sizes = _numbers(shape, "radius", 1)[0], _numbers(shape, "length", 1)[0]
            if shape.tag == "capsule" or "capsule" in asked:
                return hppfcl.Capsule(*sizes), "CAPSULE", one
            return hppfcl.Cylinder(*sizes), "CYLINDER", one
        raise ValueError(f"{self._source}: link '{link.get('name')}' has an unknown shape <{shape.tag}>")

    def _path(self, uri):
        """Returns the path of a file. Raises ValueError if it is in none of the folders."""
        for scheme in ("package://", "model://"):
            if uri.startswith(scheme):
                for folder in self._folders:
                    path = os.path.join(folder, uri[len(scheme) :])
                    if os.path.exists(path):
                        return path
                raise ValueError(f"{uri} is in none of the folders {self._folders}; give its folder in package_dirs")
        path = uri[len("file://") :] if uri.startswith("file://") else uri
        beside = os.path.join(os.path.dirname(self._source), path)
        for candidate in (path, beside, *(os.path.join(folder, path) for folder in self._folders)):
            if os.path.exists(candidate):
                return candidate
        raise ValueError(f"the file {uri} is not found")

    def _look(self, element):
        """Returns the material of a <visual>, as arguments of GeometryObject."""
        material = element.find("material")
        if material is None:
            return {"mesh_color": _GREY}
        shared = self._materials.get(material.get("name"))
        both = [m for m in (material, shared) if m is not None]
        color, texture = (next((m.find(tag) for m in both if m.find(tag) is not None), None) for tag in ("color", "texture"))
        options = {"override_material": True, "mesh_color": _GREY if color is None else _numbers(color, "rgba", 4)}
        if texture is not None and texture.get("filename"):
            options["mesh_texture_path"] = self._path(texture.get("filename"))
        return options


def _pose(origin):
    if origin is None:
        return SE3()
    return SE3(rpyToMatrix(_numbers(origin, "rpy", 3, np.zeros(3))), _numbers(origin, "xyz", 3, np.zeros(3)))
