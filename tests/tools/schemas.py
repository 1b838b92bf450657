#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-2-Clause
"""schemas.py BUILD SOURCE: checks what dyn reads and writes as JSON against the schemas in libdyn/schemas.

Exits with 100 (skipped) without the Python package jsonschema (Debian: python3-jsonschema)."""
import glob
import json
import os
import subprocess
import sys
import tempfile

try:
    import jsonschema
except ImportError:
    print("skipped: needs python3-jsonschema")
    sys.exit(100)

build, source = sys.argv[1:3]
biped = source + "/models/biped.urdf"
validators = {}
for path in glob.glob(source + "/libdyn/schemas/*.schema.json"):
    with open(path, encoding="utf-8") as file:
        schema = json.load(file)
    jsonschema.Draft202012Validator.check_schema(schema)
    validators[os.path.basename(path).split(".")[0]] = jsonschema.Draft202012Validator(schema)
checked = set()


def read(path):
    with open(path, encoding="utf-8") as file:
        return json.load(file)


def run(*words):
    return subprocess.run([build + "/bin/dyn", *words], check=True, stdout=subprocess.PIPE, encoding="utf-8").stdout


def valid(name, document, what):
    checked.add(name)
    for error in validators[name].iter_errors(document):
        sys.exit(f"{what} is not what libdyn/schemas/{name}.schema.json says: at {error.json_path}: {error.message[:500]}")


def refused(name, document):
    if validators[name].is_valid(document):
        sys.exit(f"libdyn/schemas/{name}.schema.json accepts {json.dumps(document)}")


with tempfile.TemporaryDirectory() as folder:
    os.environ["LIBDYN_CACHE"] = folder + "/cache"
    sample = {"q": [0, 0, 0, 0, 0, 0, 1] + 16 * [0.1], "v": 22 * [0.1], "a": None}
    states, truth = folder + "/states.json", folder + "/truth.json"
    with open(states, "w", encoding="utf-8") as file:
        json.dump({"samples": [sample]}, file)
    valid("states", read(states), "an input of dyn compute")
    refused("states", {"samples": [{"v": [0]}]})
    refused("states", {"samples": [{"q": ["0"]}]})

    floating = [biped, "--root", "free_flyer"]
    everything = ["--frames", "left_foot,right_foot", "--contacts", "left_foot:6d,right_foot:3d"]
    valid("dynamics", json.loads(run("compute", *floating, "--states", states, *everything)), "the output of dyn compute")
    with open(folder + "/still.json", "w", encoding="utf-8") as file:
        json.dump({"samples": [{"q": []}]}, file)
    with open(folder + "/still.urdf", "w", encoding="utf-8") as file:
        file.write('<robot name="still"><link name="a"/></robot>')
    valid("dynamics", json.loads(run("compute", folder + "/still.urdf", "--states", folder + "/still.json")), "dyn compute for a model without mass")
    refused("dynamics", {"robot": "r"})

    for path in [biped, *sorted(glob.glob(os.path.dirname(source) + "/shared/models/*.urdf"))]:
        run("convert", path, folder + "/model.dyn.json", "--inertia", "any", "--quiet")
        valid("model", read(folder + "/model.dyn.json"), "the output of dyn convert")
    four_bar = source + "/models/four_bar.urdf"
    for words in ([biped, biped], [biped, four_bar]):
        answer = subprocess.run([build + "/bin/dyn", "diff", *words, "--json"], stdout=subprocess.PIPE, encoding="utf-8")
        valid("differences", json.loads(answer.stdout), "the output of dyn diff --json")
        if answer.returncode != (words[0] != words[1]):
            sys.exit(f"dyn diff {' '.join(words)} ended with {answer.returncode}")
    refused("model", dict(read(folder + "/model.dyn.json"), version=2))

    for words in ([], ["--distances"], ["--states", states]):
        valid("collisions", json.loads(run("collide", *floating, *words)), "the output of dyn collide")

    torques = json.loads(run("compute", *floating, "--states", states, "--only", "rnea"))["samples"][0]["rnea"]
    with open(truth, "w", encoding="utf-8") as file:
        json.dump({"samples": [dict(sample, truth={"rnea": [str(x) for x in torques], "rnea_scale": 22 * [1]})]}, file)
    valid("truth", read(truth), "an input of dyn bench --truth")
    run("truth", source + "/models/four_bar.urdf", "--count", "1", "--out", folder + "/references.json")
    valid("truth", read(folder + "/references.json"), "the output of dyn truth")
    for path in sorted(glob.glob(source + "/tests/truth/references/*.json")):
        valid("truth", read(path), path)
    refused("truth", {"samples": [{"q": [0], "truth": {"rnea": ["many"]}}]})
    for line in run("bench", *floating, "--json", "--only", "rnea,crba", "--truth", truth, "--codegen", "rnea").splitlines():
        valid("bench", json.loads(line), "a line of dyn bench --json")
    for line in run("profile", biped, "--json").splitlines():
        valid("profile", json.loads(line), "a line of dyn profile --json")

    study = folder + "/study.json"
    with open(study, "w", encoding="utf-8") as file:
        json.dump({"model": biped, "root": "free_flyer", "task": "simulate", "time": 0.002, "samples": 2, "keep": ["final", "inputs"],
                   "success": {"v_final": [-9, 9]}, "histograms": {"v_final": [-1, 1, 4]},
                   "vary": {"q": {"joints": {"left_knee": {"uniform": [0, 1]}}}, "v": {"normal": [0, 1]},
                            "gravity": {"list": [[0, 0, -9.81], 0]}, "dt": {"grid": [0.001, 0.002, 2]}}}, file)
    valid("study", read(study), "an input of dyn sweep")
    refused("study", dict(read(study), vary={"q": {"unform": [0, 1]}}))
    valid("study", {"model": "arm.urdf", "task": "simulate", "effort_limits": True, "samples": 2,
                    "vary": {"pd": {"kp": 5, "target": {"joints": {"elbow": {"uniform": "limits"}}}}, "joints": {"elbow": {"upper": {"list": [1, 2]}}}}},
          "a study with a controller")
    refused("study", dict(read(study), vary={"pd": {"ki": 1}}))
    valid("study", {"model": "arm.urdf", "task": "python", "file": "task.py", "function": "evaluate", "samples": 2,
                    "vary": {"values": {"gain": {"list": [[1, 2], 3]}}}}, "a study of a function of Python")
    # dyn accepts what the schema does.
    answer = subprocess.run([build + "/bin/dyn", "sweep", study, "--out", folder + "/sweep", "--quiet"], stderr=subprocess.PIPE, encoding="utf-8",
                            stdout=subprocess.DEVNULL)
    if answer.returncode and "without HDF5" not in answer.stderr:
        sys.exit(f"dyn sweep refuses what the schema accepts: {answer.stderr}")

    run("simulate", *floating, "--time", "0.01", "--out", folder + "/out.json")
    valid("trajectory", read(folder + "/out.json"), "the output of dyn simulate")
    # A trajectory's first state can be where another simulation begins.
    valid("states", {"samples": read(folder + "/out.json")["states"]}, "states of a trajectory")

    peers = folder + "/peers.json"
    row = {"robot": "r", "library": "l", "version": "1"}
    with open(peers, "w", encoding="utf-8") as file:
        json.dump({"algorithms": [dict(row, task="rnea", ns=1, ns_low=1, ns_high=2, error_u=3)],
                   "motions": [dict(row, integrator="rk4", steps=64, seconds=1e-3, error=1e-9)]}, file)
    valid("peers", read(peers), "an input of dyn accuracy --peers")
    run("accuracy", "--quick", "--out", folder + "/accuracy", "--peers", peers, "--quiet")
    valid("accuracy", read(folder + "/accuracy/report.json"), "the report of dyn accuracy")

    shared = os.path.dirname(source) + "/shared"
    for path in sorted(glob.glob(shared + "/golden/*.json") + glob.glob(shared + "/truth/data/*.json")):
        document = read(path)
        if isinstance(document, dict) and "samples" in document and all("q" in s and "truth" in s for s in document["samples"]):
            valid("truth", dict(document, samples=document["samples"][:1]), path)

if checked != set(validators):
    sys.exit(f"not checked: {', '.join(sorted(set(validators) - checked))}")
print(f"{len(checked)} schemas hold for what dyn reads and writes")
