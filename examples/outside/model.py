"""An oven, as a model for `lss gap diagnose examples/outside --model "python3 examples/outside/model.py"`.

    C dT/dt = P - L (T - 20),  C heat capacity J/K, L loss W/K, P heater W, T temperature in degrees Celsius

What the campaign's oven does besides is for the diagnosis to find. Plain Python, no packages.
"""
import csv, json, sys

DESCRIPTION = {
    "nuisances": [
        {"name": "capacity", "unit": "J/K", "nominal": 9000, "low": 4000, "high": 20000},
        {"name": "loss", "unit": "W/K", "nominal": 5, "low": 1, "high": 15},
    ],
    "effects": [
        {"name": "radiation", "strengths": [{"name": "area", "unit": "m2", "trial": 0.02, "low": 0, "high": 0.5}]},
        {"name": "door_leak", "strengths": [{"name": "loss", "unit": "W/K", "trial": 0.3, "low": 0, "high": 10}]},
        {"name": "heater_fade", "strengths": [{"name": "fade", "unit": "1/h", "trial": 0.01, "low": -0.5, "high": 0.5}]},
        {"name": "sensor_offset", "sensor": True,
         "strengths": [{"name": "offset", "unit": "K", "trial": 0.5, "low": -20, "high": 20}]},
        {"name": "sensor_lag", "sensor": True,
         "strengths": [{"name": "time", "unit": "s", "trial": 5, "low": 0, "high": 120}]},
    ],
}

runs = {}  # inputs by file, read once


def inputs(file):
    if file not in runs:
        with open(file, newline="") as opened:
            rows = list(csv.DictReader(opened))
        runs[file] = [[float(row[c]) for row in rows] for c in ("time", "power", "door")]
    return runs[file]


def simulate(run, nuisances, effects):
    time, power, door = inputs(run["file"])
    strength = {(e["name"], s): x for e in effects for s, x in e["strengths"].items()}.get
    area = strength(("radiation", "area"), 0)
    leak = strength(("door_leak", "loss"), 0)
    fade = strength(("heater_fade", "fade"), 0) / 3600
    offset = strength(("sensor_offset", "offset"), 0)
    lag = strength(("sensor_lag", "time"), 0)
    true = sensed = run["settings"]["start"]
    said = []
    for i, now in enumerate(time):
        said.append(sensed + offset)
        step = (time[i + 1] - now if i + 1 < len(time) else 0) / 4
        for _ in range(4):
            heat = power[i] * (1 - fade * now) - (nuisances["loss"] + leak * door[i]) * (true - 20)
            heat -= 5.67e-8 * area * ((true + 273.15) ** 4 - 293.15**4)
            true += step * heat / nuisances["capacity"]
            sensed = true if lag == 0 else sensed + (true - sensed) * step / (lag + step)
    return {"time": time, "channels": {"temperature": said}}


for line in sys.stdin:
    asked = json.loads(line)
    if asked["request"] == "describe":
        answer = DESCRIPTION
    else:
        try:
            answer = simulate(asked["run"], asked["nuisances"], asked["effects"])
        except (OSError, KeyError, OverflowError) as why:
            answer = {"error": f"{type(why).__name__}: {why}"}
    print(json.dumps(answer), flush=True)
