# SPDX-License-Identifier: BSD-2-Clause
"""Builds a wheel of libdyn (PEP 517). The wheel carries the module, the libraries, their kernels and the standard plugins.

It is built in the folder build/ of the source tree, as by tools/python, for this machine's processor and for the Python that runs pip.
`--config-settings instruction_sets=all` builds kernels for every processor, `--config-settings build=FOLDER` builds elsewhere.
"""
import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
VERSION = re.search(r"^project\(libdyn VERSION ([0-9.]+)", (ROOT / "CMakeLists.txt").read_text(), re.MULTILINE)[1]
METADATA = f"""Metadata-Version: 2.1
Name: libdyn
Version: {VERSION}
Summary: Kinematics, dynamics and their derivatives of robots that are described at run time
License: BSD-2-Clause
Requires-Python: >=3.9
Requires-Dist: numpy
"""


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
    subprocess.run(["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", *(f"-D{name}={value}" for name, value in options.items())], check=True)
    subprocess.run(["cmake", "--build", folder, "--target", "libdyn_python", "dyn_standard"], check=True)
    return folder


def files_of(folder):
    """Returns the files of the wheel, by their names there."""
    files = {}
    suffix = sysconfig.get_config_var("EXT_SUFFIX")
    package = folder / "python" / "libdyn"
    for path in package.rglob("*"):
        if path.suffix in (".py", ".pyi", ".typed") or path.name == f"_core{suffix}":
            files[f"libdyn/{path.relative_to(package)}"] = path
    # Programs ask for libraries by the name with the interface's number. Wheels have no links.
    for name in ("libdyn", "libdyn_geometry", "libdyn_parsers"):
        (path,) = (folder / "lib").glob(f"{name}.so.?")
        files[f"libdyn/lib/{path.name}"] = path
    for path in (folder / "lib" / "libdyn").rglob("*.so"):
        files[f"libdyn/lib/libdyn/{path.relative_to(folder / 'lib' / 'libdyn')}"] = path
    return files


def pack(folder, wheel_directory):
    """Writes the wheel of a build folder; returns its name."""
    files = files_of(folder)
    info = f"libdyn-{VERSION}.dist-info"
    contents = {name: path.read_bytes() for name, path in sorted(files.items())}
    contents[f"{info}/METADATA"] = METADATA.encode()
    contents[f"{info}/WHEEL"] = f"Wheel-Version: 1.0\nGenerator: libdyn\nRoot-Is-Purelib: false\nTag: {tag()}\n".encode()
    contents[f"{info}/LICENSE"] = (ROOT / "LICENSE").read_bytes()
    record = [f"{name},sha256={base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b'=').decode()},{len(data)}" for name, data in contents.items()]
    contents[f"{info}/RECORD"] = "\n".join([*record, f"{info}/RECORD,,", ""]).encode()
    name = f"libdyn-{VERSION}-{tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(wheel_directory) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in contents.items():
            entry = zipfile.ZipInfo(path, (1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if path.endswith(".so") or ".so." in path else 0o644) << 16
            wheel.writestr(entry, data)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    return pack(build(config_settings or {}), wheel_directory)


def build_sdist(sdist_directory, config_settings=None):
    raise RuntimeError("libdyn/python has no source distribution of its own: its sources are the whole repository")
