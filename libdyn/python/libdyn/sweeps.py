# SPDX-License-Identifier: BSD-2-Clause
"""Sweeps: many simulations or evaluations of one model, by the command `dyn`."""

import importlib
import json
import os
import pathlib
import shutil
import subprocess
import sys
from typing import Any, Mapping, Union

import numpy as np

from ._errors import error


def sweep(
    study: "Union[Mapping[str, Any], str, os.PathLike[str]]",
    out: "str | os.PathLike[str]",
    *,
    threads: int = 0,
    resume: bool = False,
) -> "dict[str, np.ndarray[Any, Any]]":
    """Runs a sweep by the command `dyn sweep`; returns its results as arrays by name, samples along the first axis.

    study: a file, whose paths are relative to it, or a mapping, whose paths are relative to the working directory. out: the folder of the results.
    threads: 0 takes one for each processor. resume: goes on with the sweep that is in the folder, or begins it. Raises Error with the message of
    the command. The results are read by h5py; without it, from parts of them that the command then keeps.
    """
    reader = _h5py()
    name = "-" if isinstance(study, Mapping) else os.fspath(study)
    words = [_command(), "sweep", name, "--out", os.fspath(out), "--json", "--color", "never"]
    words += ["--threads", str(threads)] if threads else []
    words += ["--resume"] if resume else []
    words += [] if reader else ["--keep-chunks"]
    text = json.dumps(study) if isinstance(study, Mapping) else ""
    # A study whose task is a function of a Python file then runs in this Python.
    programs = os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", os.defpath)])
    answer = subprocess.run(words, input=text, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, encoding="utf-8", check=False,
                            env={**os.environ, "PATH": programs})
    if answer.returncode:
        raise error("argument", "\n".join(line.partition("error: ")[2] for line in answer.stderr.splitlines() if "error: " in line) or answer.stderr)
    return _read_results(reader, pathlib.Path(out)) if reader else _read_chunks(pathlib.Path(out))


def _h5py() -> Any:
    try:
        return importlib.import_module("h5py")
    except ImportError:
        return None


def _command() -> str:
    """Returns the path of `dyn`: of the tree in which this package lies, or of PATH."""
    for folder in pathlib.Path(__file__).absolute().parents:
        if os.access(folder / "bin" / "dyn", os.X_OK):
            return str(folder / "bin" / "dyn")
    found = shutil.which("dyn")
    if not found:
        raise error("file", "the command `dyn` is not there; install libdyn-tools, or put its folder into PATH")
    return found


def _read_results(h5py: Any, out: pathlib.Path) -> "dict[str, np.ndarray[Any, Any]]":
    results: "dict[str, np.ndarray[Any, Any]]" = {}

    def add(name: str, thing: Any) -> None:
        if isinstance(thing, h5py.Dataset):
            results[name] = thing[()]

    with h5py.File(out / "results.h5", "r") as file:
        file.visititems(add)
    return results


def _read_chunks(out: pathlib.Path) -> "dict[str, np.ndarray[Any, Any]]":
    """Reads the parts of the results: a line of JSON, the numbers of field after field, and 64 letters of digest."""
    manifest = json.loads((out / "manifest.json").read_text(encoding="utf-8"))
    fields = manifest["fields"]
    results = {
        field["name"]: np.empty([manifest["samples"], *field["shape"]], dtype=np.uint8 if field["type"] == "u8" else np.float64) for field in fields
    }
    for number in range(-(-manifest["samples"] // manifest["chunk"])):
        path = out / "chunks" / str(number)
        if not path.exists():
            raise error("file", "the parts of the results are not kept; install h5py (Debian: python3-h5py) to read results.h5", str(out))
        head, _, rest = path.read_bytes().partition(b"\n")
        first, count = (json.loads(head)[key] for key in ("first", "count"))
        numbers = np.frombuffer(rest[:-64], dtype="<f8")
        for field in fields:
            size = int(np.prod(field["shape"], dtype=np.int64)) * count
            results[field["name"]][first:first + count] = numbers[:size].reshape([count, *field["shape"]])
            numbers = numbers[size:]
    return results
