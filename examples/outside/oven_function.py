"""The oven of model.py as a Python function: `lss gap diagnose examples/outside --model "python3 -m lss_model
examples/outside/oven_function.py"`, with lss_model installed (`pip install ./python`)."""
from lss_model import effect, nuisance

NUISANCES = [nuisance("capacity", 9000, 4000, 20000, "J/K"), nuisance("loss", 5, 1, 15, "W/K", shared=True)]
EFFECTS = [
    effect("radiation", area=(0.02, 0, 0.5, "m2")),
    effect("door_leak", loss=(0.3, 0, 10, "W/K")),
    effect("sensor_offset", sensor=True, offset=(0.5, -20, 20, "K")),
    effect("sensor_idle", sensor=True, offset=(1, -20, 20, "K")),  # read by nobody, which the diagnosis tells
]


def simulate(inputs, p):
    time, now, said = inputs["time"], p["start"], []
    for k, t in enumerate(time):
        said.append(now + p["sensor_offset.offset"])
        step = (time[k + 1] - t) / 4 if k + 1 < len(time) else 0
        for _ in range(4):
            heat = inputs["power"][k] - (p["loss"] + p["door_leak.loss"] * inputs["door"][k]) * (now - 20)
            heat -= 5.67e-8 * p["radiation.area"] * ((now + 273.15) ** 4 - 293.15**4)
            now += step * heat / p["capacity"]
    return {"temperature": said}
