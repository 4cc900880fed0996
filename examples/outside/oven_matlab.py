"""The oven of oven.m as a model: `lss gap diagnose examples/outside --model "python3 -m lss_model
examples/outside/oven_matlab.py"`, with lss_model installed (`pip install ./python`), and MATLAB or GNU Octave."""
import os

from lss_model import effect, nuisance
from lss_model.matlab import Matlab

NUISANCES = [nuisance("capacity", 9000, 4000, 20000, "J/K"), nuisance("loss", 5, 1, 15, "W/K", shared=True)]
EFFECTS = [
    effect("radiation", area=(0.02, 0, 0.5, "m2")),
    effect("door_leak", loss=(0.3, 0, 10, "W/K")),
    effect("sensor_offset", sensor=True, offset=(0.5, -20, 20, "K")),
]

matlab = Matlab(os.path.dirname(os.path.abspath(__file__)))


def simulate(inputs, p):
    return {"temperature": matlab.call("oven", inputs["time"], inputs["power"], inputs["door"], p)}
