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
from ._sweep_ranks import own_environment, run_in_ranks


def sweep(
    study: "Union[Mapping[str, Any], str, os.PathLike[str]]",
    out: "str | os.PathLike[str]",
    *,
    threads: int = 0,
    resume: bool = False,
    comm: Any = None,
) -> "dict[str, np.ndarray[Any, Any]]":
    """Runs a sweep by the command `dyn sweep`; returns its results as arrays by name, samples along the first axis.

    study: a file, whose paths are relative to it, or a mapping, whose paths are relative to the working directory. out: the folder of the results.
    threads: 0 takes one for each processor. resume: goes on with the sweep that is in the folder, or begins it. Raises Error with the message of
    the command. The results are read by h5py; without it, from parts of them that the command then keeps.

    comm: a communicator of mpi4py, whose ranks then compute the sweep together. All of them call sweep with the same study and folder; rank 0
    returns the results and the others an empty dictionary. An Error is raised on all ranks. threads: of each rank, 1 without it.
    """
    reader, shared = _h5py(), comm is not None and comm.size > 1
    words: "list[str]" = []
    try:
        text = json.dumps(study) if isinstance(study, Mapping) else ""
        words = _words("-" if isinstance(study, Mapping) else os.fspath(study), out, threads, resume, reader is None)
    finally:  # the others must not wait for a rank that cannot begin
        ready = not shared or all(comm.allgather(bool(words)))
    if not ready:
        raise error("argument", "another rank cannot begin the sweep; its own error says why")
    # A study whose task is a function of a Python file then runs in this Python.
    environment = {**own_environment(), "PATH": os.pathsep.join([os.path.dirname(sys.executable), os.environ.get("PATH", os.defpath)])}
    if shared:
        code, told = run_in_ranks(words, text, environment, comm)
    else:
        answer = subprocess.run(words, input=text, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, encoding="utf-8", check=False,
                                env=environment)
        code, told = answer.returncode, answer.stderr
    if code:
        raise error("argument", "\n".join(line.partition("error: ")[2] for line in told.splitlines() if "error: " in line) or told)
    if shared and comm.rank != 0:
        return {}
    return _read_results(reader, pathlib.Path(out)) if reader else _read_chunks(pathlib.Path(out))


def _words(study: str, out: "str | os.PathLike[str]", threads: int, resume: bool, keep_chunks: bool) -> "list[str]":
    """Returns the command line of the sweep."""
    words = [_command(), "sweep", study, "--out", os.fspath(out), "--json", "--color", "never"]
    words += ["--threads", str(threads)] if threads else []
    return words + (["--resume"] if resume else []) + (["--keep-chunks"] if keep_chunks else [])


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
