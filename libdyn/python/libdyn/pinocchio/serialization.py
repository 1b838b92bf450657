# SPDX-License-Identifier: BSD-2-Clause
"""Objects as text, XML or bytes. The forms are libdyn's own: files written by Pinocchio are not read, and a file never runs code.

Text is JSON. XML has the same tree. Bytes are the compressed text. Floating-point numbers keep all digits.
"""

from __future__ import annotations

import enum
import json
import os
import sys
import xml.etree.ElementTree as ElementTree
import zlib
from typing import TYPE_CHECKING, Union

import numpy as np

if TYPE_CHECKING:
    from ._types import Path

__all__ = [
    "Serializable",
    "StaticBuffer",
    "StreamBuffer",
    "buffer_copy",
    "loadFromBinary",
    "loadFromString",
    "loadFromText",
    "loadFromXML",
    "saveToBinary",
    "saveToString",
    "saveToText",
    "saveToXML",
]


class StreamBuffer(bytearray):
    """Bytes in memory, which grow as needed."""

    def view(self) -> memoryview:
        return memoryview(self)

    def size(self) -> int:
        return len(self)


class StaticBuffer(StreamBuffer):
    """Bytes in memory that were sized in advance; the size follows what is written."""

    def reserve(self, new_size: int) -> None:
        """Does nothing: the buffer grows as needed."""


def buffer_copy(dest: StreamBuffer, source: StreamBuffer) -> None:
    """Copies the bytes of one buffer into another."""
    dest[:] = source


def _tree(x):
    """Returns an object as a tree of dicts, lists, numbers, strings and None."""
    if x is None or isinstance(x, (bool, str)):
        return x
    if isinstance(x, enum.Enum):
        return {"class": _name(type(x)), "arguments": [_tree(x.value)]}
    if isinstance(x, (int, float)):
        return x
    if isinstance(x, np.generic):
        return x.item()
    if isinstance(x, np.ndarray):
        return {"array": x.ravel().tolist(), "shape": list(x.shape), "type": x.dtype.kind}
    if type(x) is dict:
        return {"dict": [[_tree(key), _tree(value)] for key, value in x.items()]}
    if type(x) in (list, tuple):
        return {type(x).__name__: [_tree(item) for item in x]}
    cls = type(x)
    name = _name(cls)
    if cls.__reduce__ is not object.__reduce__:
        made_by, arguments, *rest = x.__reduce__()
        if made_by is not cls or rest:
            raise TypeError(f"an object of type {name} cannot be written")
        return {"class": name, "arguments": [_tree(item) for item in arguments]}
    state = x.__getstate__() if hasattr(cls, "__setstate__") else vars(x)
    return {"class": name, "state": _tree(state)}


def _is_ours(module):
    return module == "libdyn" or module.startswith("libdyn.pinocchio.")


def _name(cls):
    if not _is_ours(cls.__module__):
        raise TypeError(f"an object of type {cls.__module__}.{cls.__qualname__} cannot be written")
    return f"{cls.__module__}.{cls.__qualname__}"


def _class(name):
    module, _, own = str(name).rpartition(".")
    cls = getattr(sys.modules.get(module), own, None) if _is_ours(module) else None
    if not isinstance(cls, type):
        raise ValueError(f"there is no class {name!r} in libdyn")
    return cls


def _object(tree):
    """Returns the object of a tree; raises ValueError, TypeError or KeyError for trees that _tree does not make."""
    if not isinstance(tree, dict):
        if isinstance(tree, list):
            raise ValueError("a bare list")
        return tree
    if "array" in tree:
        return np.array(tree["array"], dtype={"f": float, "i": int, "u": int, "b": bool}[tree["type"]]).reshape(tree["shape"])
    if "dict" in tree:
        return {_object(key): _object(value) for key, value in tree["dict"]}
    if "list" in tree:
        return [_object(item) for item in tree["list"]]
    if "tuple" in tree:
        return tuple(_object(item) for item in tree["tuple"])
    cls = _class(tree["class"])
    if "arguments" in tree:
        return cls(*(_object(item) for item in tree["arguments"]))
    out = cls.__new__(cls)
    state = _object(tree["state"])
    out.__setstate__(state) if hasattr(cls, "__setstate__") else out.__dict__.update(state)
    return out


def _element(tag, tree):
    """Returns a tree as an XML element."""
    element = ElementTree.Element(tag)
    if isinstance(tree, dict):
        element.set("kind", "dict")
        element.extend(_element(key, value) for key, value in tree.items())
    elif isinstance(tree, list) and tree and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in tree):
        element.set("kind", "numbers")
        element.text = " ".join(map(repr, tree))
    elif isinstance(tree, list):
        element.set("kind", "list")
        element.extend(_element("item", item) for item in tree)
    else:
        element.set("kind", "value")
        element.text = json.dumps(tree)
    return element


def _element_tree(element):
    kind = element.get("kind")
    if kind == "dict":
        return {child.tag: _element_tree(child) for child in element}
    if kind == "list":
        return [_element_tree(child) for child in element]
    if kind == "numbers":
        return [json.loads(x.replace("inf", "Infinity").replace("nan", "NaN")) for x in element.text.split()]
    return json.loads(element.text)


def _decoded(read, source):
    """Returns the object that read() gives as a tree. Raises ValueError that names the source if it is malformed."""
    try:
        return _object(read())
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError, zlib.error, ElementTree.ParseError) as error:
        raise ValueError(f"{source} holds no object that libdyn.pinocchio has written: {error}") from None


def _dumped(x):
    return json.dumps(_tree(x))


def _take(x, other):
    """Gives x the value of `other`, which must be of the same class."""
    if type(other) is not type(x):
        raise ValueError(f"the object is a {type(other).__name__}, not a {type(x).__name__}")
    if isinstance(x, list):
        x[:] = other
    else:
        x.__dict__.clear()
        x.__dict__.update(other.__dict__)


def saveToString(object: Serializable) -> str:
    """Returns an object as text."""
    return _dumped(object)


def loadFromString(object: Serializable, string: str) -> None:
    """Gives an object the value that saveToString wrote."""
    _take(object, _decoded(lambda: json.loads(string), "the string"))


def saveToText(object: Serializable, filename: Path) -> None:
    """Writes an object into a text file."""
    with open(filename, "w", encoding="utf-8") as file:
        file.write(_dumped(object))


def loadFromText(object: Serializable, filename: Path) -> None:
    """Gives an object the value of a text file. Raises ValueError for another content, OSError if the file cannot be read."""
    with open(filename, encoding="utf-8") as file:
        _take(object, _decoded(lambda: json.load(file), filename))


def saveToXML(object: Serializable, filename: Path, tag_name: str) -> None:
    """Writes an object into an XML file, as the element `tag_name`."""
    ElementTree.ElementTree(_element(tag_name, _tree(object))).write(filename, encoding="utf-8", xml_declaration=True)


def loadFromXML(object: Serializable, filename: Path, tag_name: str) -> None:
    """Gives an object the value of the element `tag_name` in an XML file."""

    def read():
        root = ElementTree.parse(filename).getroot()
        if root.tag != tag_name:
            raise ValueError(f"the element is <{root.tag}>, not <{tag_name}>")
        return _element_tree(root)

    _take(object, _decoded(read, filename))


def saveToBinary(object: Serializable, target: Union[Path, StreamBuffer]) -> None:
    """Writes an object as bytes into a file or a StreamBuffer."""
    data = zlib.compress(_dumped(object).encode())
    if isinstance(target, bytearray):
        target[:] = data
    else:
        with open(target, "wb") as file:
            file.write(data)


def loadFromBinary(object: Serializable, source: Union[Path, StreamBuffer, bytes]) -> None:
    """Gives an object the value of a file or a StreamBuffer that saveToBinary wrote."""
    if isinstance(source, (bytes, bytearray)):
        data, name = bytes(source), "the buffer"
    else:
        name = os.fspath(source)
        with open(source, "rb") as file:
            data = file.read()
    _take(object, _decoded(lambda: json.loads(zlib.decompress(data)), name))


class Serializable:
    """Adds methods that write an object and read it back."""

    saveToString = saveToString
    loadFromString = loadFromString
    saveToText = saveToText
    loadFromText = loadFromText
    saveToXML = saveToXML
    loadFromXML = loadFromXML
    saveToBinary = saveToBinary
    loadFromBinary = loadFromBinary
