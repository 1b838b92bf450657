// SPDX-License-Identifier: BSD-2-Clause
#include "tasks/python_server.hpp"

namespace dyn::tool::sweep {

const char* const python_server = R"python(
import ctypes, importlib.machinery, importlib.util, json, os, random, signal, sys, traceback, warnings

sys.dont_write_bytecode = True
signal.signal(signal.SIGINT, signal.SIG_IGN)  # dyn ends this process
ctypes.CDLL(None).prctl(1, signal.SIGKILL)  # so does the kernel if dyn is killed
channel = os.dup(0)
nothing = os.open(os.devnull, os.O_RDONLY)
os.dup2(nothing, 0)
os.close(nothing)
os.dup2(2, 1)
source, answers = os.fdopen(channel, "rb"), os.fdopen(os.dup(channel), "wb")
setup = json.loads(source.readline())
path = setup["file"]


def answer(head, numbers=b""):
    answers.write(json.dumps(head).encode() + b"\n" + numbers)
    answers.flush()


def refuse(kind, text):
    answer({kind: text})
    sys.exit()


def reason(problem):
    """What an exception says, and the line of the file where it came from."""
    lines = [place.lineno for place in traceback.extract_tb(problem.__traceback__) if place.filename == path]
    where = f" ({os.path.basename(path)}, line {lines[-1]})" if lines else ""
    return f"{type(problem).__name__}: {problem}{where}"[:4000].encode("utf-8", "replace").decode()


sys.path.append(sys.argv[1])
try:
    import libdyn
    import numpy
except ImportError as problem:
    print(problem, file=sys.stderr)
    refuse("missing", True)
if libdyn.__version__ != setup["version"]:
    refuse("error", f"python3 has the module libdyn {libdyn.__version__}, and this dyn is {setup['version']}")


def load():
    sys.path.insert(0, os.path.dirname(path))
    loader = importlib.machinery.SourceFileLoader("libdyn_task", path)
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("libdyn_task", loader))
    sys.modules["libdyn_task"] = module
    loader.exec_module(module)
    found = getattr(module, setup["function"], None)
    if callable(found):
        return found
    names = [name for name, value in vars(module).items() if callable(value) and getattr(value, "__module__", None) == "libdyn_task"]
    refuse("error", f"has no function '{setup['function']}'" + ("; there are " + ", ".join(names) if names else ""))


def compiled_with(limits):
    """Compiles the model with other limits of some joints."""
    description = libdyn.Model.from_json(setup["model"])
    for body in description.bodies if limits else []:
        for name, numbers in limits.get(body.joint.name, {}).items():
            setattr(body.joint, name, numpy.array(numbers))
    return libdyn.compile(description, lock={joint: None for joint in setup["lock"]}, dissipation=setup["dissipation"], registry=registry)


try:
    evaluate = load()
    registry = libdyn.JointRegistry()
    for plugin in setup["plugins"]:
        registry.load(plugin, trust=setup["trust"])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # dyn has said them
        compiled = compiled_with({})
except Exception as problem:
    refuse("error", reason(problem))


def named(name):
    if not isinstance(name, str) or not name or len(name) > 200 or "/" in name or name in (".", "..") or not name.isprintable():
        raise ValueError(f"{name!r} is no name of a result: a text without / that can be printed")
    if name in setup["reserved"]:
        raise ValueError(f"'{name}' is no name of a result, because the sweep uses it")
    return name


def array(name, value):
    given = numpy.asarray(value)
    if given.dtype.kind not in "biuf" or given.ndim > 16:
        raise TypeError(f"the result '{name}' is no number and no array of numbers")
    return numpy.asarray(given, dtype="<f8", order="C")


def packed(results):
    """What the results are, and their numbers one after another."""
    if not isinstance(results, dict) or not results:
        what = "an empty one" if isinstance(results, dict) else type(results).__name__
        raise TypeError(f"{setup['function']} must return a dict of numbers and arrays, not {what}")
    arrays = {named(name): array(name, value) for name, value in results.items()}
    shapes = {name: list(arrays[name].shape) for name in sorted(arrays)}
    wanted = setup["fields"]
    if wanted is None:
        return {"fields": shapes}, b""  # dyn asks what there is
    for name in sorted({*shapes, *wanted}):
        if name not in shapes:
            raise ValueError(f"there is no result '{name}', which the first sample has")
        if name not in wanted:
            raise ValueError(f"the first sample has no result '{name}'")
        if shapes[name] != wanted[name]:
            raise ValueError(f"the result '{name}' has the shape {shapes[name]}, and that of the first sample {wanted[name]}")
    return {}, b"".join(arrays[name].tobytes() for name in shapes)


def numbers_of(given):
    if "inertias" in given:
        given["inertias"] = {body: libdyn.Inertia(mass, numpy.array(com), numpy.array(rotational).reshape(3, 3))
                             for body, (mass, com, rotational) in given["inertias"].items()}
    return given


def serve(request, numbers):
    inputs, first = {}, 0
    for name, size in setup["inputs"]:
        inputs[name] = numbers[first:first + size].copy()
        first += size
    model = compiled_with(request["limits"]) if request["limits"] else compiled
    if request["numbers"]:
        model = model.with_numbers(**numbers_of(request["numbers"]))
    # A function that uses the common generators has the same numbers for the same sample.
    seed, sample = setup["seed"], request["sample"]
    random.seed(f"{seed} {sample}")
    numpy.random.seed([part for x in (seed, sample) for part in (x & 0xffffffff, x >> 32)])
    return packed(evaluate(model, inputs))


answer({})
count = 8 * sum(size for _, size in setup["inputs"])
for line in source:
    numbers = numpy.frombuffer(source.read(count), dtype="<f8")
    try:
        reply = serve(json.loads(line), numbers)
    except BaseException as problem:
        reply = ({"error": reason(problem)},)
    answer(*reply)
)python";

}  // namespace dyn::tool::sweep
