"""Makes, diagnoses and judges the benchmark: `python3 run.py LSS FOLDER [CASE ...]`, with the program's path. Prints a
row a case: truth, verdict, its probability and the error of samples before and after."""
import json
import os
import subprocess
import sys

here = os.path.dirname(os.path.abspath(__file__))
program, folder, names = sys.argv[1], sys.argv[2], sys.argv[3:]
subprocess.run([sys.executable, os.path.join(here, "measure.py"), folder, *names], check=True)
right = wrong = 0
for name in names or sorted(os.listdir(folder)):
    at = os.path.join(folder, name)
    model = f'"{sys.executable}" "{os.path.join(here, "models.py")}" {name}'
    out = os.path.join(at, "out")
    ran = subprocess.run([program, "gap", "diagnose", at, "--model", model, "-o", out, "--no-sweep"], capture_output=True)
    with open(os.path.join(out, "gap.json")) as opened:
        found = json.load(opened)
    with open(os.path.join(at, "truth.json")) as opened:
        truth = json.load(opened)
    said = sorted(found["with"]) if found["verdict"] in ("effect", "pair", "sensor") else [found["verdict"]]
    sure = {"none": found["none_probability"], "unknown": found["unknown_probability"]}
    sure.update({e["name"]: e["probability"] for e in found["effects"]})
    least = min(sure[s] for s in said)
    good = said == sorted(truth)
    right, wrong = right + good, wrong + (not good and least > 0.8)
    errors = "; ".join(f"{c} {e['before']:.3g} to {e['after']:.3g} {e['unit']}" for c, e in found["outside"]["sample_error"].items())
    print(f"| {name} | {', '.join(truth)} | {', '.join(said)} {100 * least:.0f} % | {errors} |", flush=True)
print(f"{right} right; wrong at more than 80 %: {wrong}")
