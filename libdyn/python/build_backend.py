# SPDX-License-Identifier: BSD-2-Clause
"""Builds a wheel of libdyn (PEP 517). The wheel carries the module, its type stubs, the libraries, their kernels, the standard plugins
and the SDK's headers.

It is built in the folder build/ of the source tree, as by tools/python, for this machine's processor and for the Python that runs pip.
`--config-settings instruction_sets=all` builds kernels for every processor, `--config-settings build=FOLDER` builds elsewhere.
"""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
VERSION = re.search(r"^project\(libdyn VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
# The only source of these fields: pyproject.toml has no table [project], because Python reads TOML only from 3.11 on.
METADATA = f"""Metadata-Version: 2.1
Name: libdyn
Version: {VERSION}
Summary: Kinematics, dynamics and their derivatives of robots that are described at run time
License: BSD-2-Clause
Requires-Python: >=3.9
Requires-Dist: numpy
"""
INFO = f"libdyn-{VERSION}.dist-info"


def environment():
    """Returns the environment of programs that shall find what is installed for this Python. pip hides that by a folder in PYTHONPATH."""
    paths = [path for path in os.environ.get("PYTHONPATH", "").split(os.pathsep) if path and "pip-build-env-" not in path]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths)}


def has(module):
    return subprocess.run([sys.executable, "-c", f"import {module}"], env=environment(), capture_output=True).returncode == 0


def get_requires_for_build_wheel(config_settings=None):
    """Asks for numpy only where it is missing, so that a build needs no network where it is installed."""
    if sys.version_info < (3, 9):
        raise SystemExit(f"libdyn needs Python 3.9 or later; {sys.executable} is Python {sys.version.split()[0]}")
    return [] if has("numpy") else ["numpy"]


def tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{python}-{python}-{platform}"


def build(settings):
    """Builds the module; returns the build folder."""
    folder = pathlib.Path(settings.get("build", ROOT / "build"))
    options = {
        "CMAKE_BUILD_TYPE": "Release",
        "DYN_BUILD_TESTS": "OFF",
        "DYN_BUILD_PYTHON": "ON",
        "DYN_INSTRUCTION_SETS": settings.get("instruction_sets", "native"),
        "Python_EXECUTABLE": sys.executable,
    }
    for command in (
        ["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *(f"-D{name}={value}" for name, value in options.items())],
        ["cmake", "--build", folder, "--target", "libdyn_python", "dyn_standard"],
    ):
        try:
            subprocess.run(command, check=True, env=environment())
        except FileNotFoundError:
            raise SystemExit("libdyn: cmake is missing; tools/python installs everything that a build needs on Debian") from None
        except subprocess.CalledProcessError:
            raise SystemExit("libdyn: the build failed, see above; tools/python installs everything that a build needs on Debian") from None
    return folder


def files_of(folder):
    """Returns the files of the wheel, by their names there."""
    files = {}
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    package = folder / "python" / "libdyn"
    for name in sorted(os.path.join(parent, name) for parent, _, names in os.walk(package, followlinks=True) for name in names):
        path = pathlib.Path(name)
        if path.suffix in (".py", ".pyi") or path.name in ("py.typed", f"_core{suffix}"):
            files[f"libdyn/{path.relative_to(package)}"] = path
    if f"libdyn/_core{suffix}" not in files:
        raise SystemExit(f"libdyn: {package} has no module for this Python (_core{suffix})")
    # Programs ask for libraries by the name with the interface's number. Wheels have no links.
    for path in sorted((folder / "lib").glob("libdyn*.so.?")):
        files[f"libdyn/lib/{path.name}"] = path
    # Joint types written in Python are compiled with the headers of the SDK.
    for sources in (ROOT / "libdyn" / "include", ROOT / "libdyn" / "sdk"):
        for path in [*sources.rglob("*.h"), *sources.rglob("*.hpp")]:
            files[f"libdyn/include/{path.relative_to(sources)}"] = path
    for path in (folder / "lib" / "libdyn").rglob("*.so"):
        files[f"libdyn/lib/libdyn/{path.relative_to(folder / 'lib' / 'libdyn')}"] = path
    return files


def metadata():
    """Returns the files that describe the wheel, by their names there."""
    return {
        f"{INFO}/METADATA": METADATA.encode(),
        f"{INFO}/WHEEL": f"Wheel-Version: 1.0\nGenerator: libdyn\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode(),
        f"{INFO}/LICENSE": (ROOT / "LICENSE").read_bytes(),
    }


def pack(folder, wheel_directory):
    """Writes the wheel of a build folder; returns its name."""
    contents = {name: path.read_bytes() for name, path in sorted(files_of(folder).items())}
    contents.update(metadata())
    record = []
    for name, data in contents.items():
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        record.append(f"{name},sha256={digest},{len(data)}")
    contents[f"{INFO}/RECORD"] = "\n".join([*record, f"{INFO}/RECORD,,", ""]).encode()
    name = f"libdyn-{VERSION}-{tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in contents.items():
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if path.endswith(".so") or ".so." in path else 0o644) << 16
            wheel.writestr(entry, data)
    return name


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    """Writes the metadata without building, so that pip refuses an old Python at once."""
    for name, data in metadata().items():
        path = pathlib.Path(metadata_directory) / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(data)
    return INFO


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return pack(build(config_settings or {}), wheel_directory)


def build_editable(wheel_directory, config_settings=None, metadata_directory=None):
    raise SystemExit(
        "libdyn: there is no editable installation. tools/python runs Python with the module of the build tree, whose Python sources are links into "
        "the source tree; set PYTHONPATH=build/python for other programs"
    )


def build_sdist(sdist_directory, config_settings=None):
    raise SystemExit(
        "libdyn: libdyn/python has no source distribution, because its sources are the whole repository; build a wheel: `pip wheel ./libdyn/python`"
    )
