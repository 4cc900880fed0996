"""Packs unit.c as an FMI 2.0 unit for co-simulation, with the campaign that names its parameters: `make.py FOLDER`."""
import os
import subprocess
import sys
import zipfile

# In the order of unit.c: name, causality, start, unit.
VARIABLES = [
    ("force", "input", 0, "N"),
    ("position", "output", None, "m"),
    ("speed", "local", None, None),
    ("stiffness", "parameter", 100, "N/m"),
    ("viscous", "parameter", 0.5, "N.s/m"),
    ("coulomb", "parameter", 0, "N"),
    ("mass", "parameter", 1, "kg"),
    ("cubic", "parameter", 0, "N/m3"),
]
CAMPAIGN = """[channels]
position = "m"
[[run]]
file = "run1.csv"
[[run]]
file = "run2.csv"
[[run]]
file = "run3.csv"
[fmu.accuracy]
position = 0.0005
[[fmu.nuisance]]
parameter = "mass"
low = 0.7
high = 1.5
[[fmu.nuisance]]
parameter = "stiffness"
low = 60
high = 150
[[fmu.nuisance]]
parameter = "viscous"
low = 0
high = 5
[[fmu.effect]]
parameter = "coulomb"
trial = 0.02
low = 0
high = 2
[[fmu.effect]]
parameter = "cubic"
trial = 100
low = -4e3
high = 4e4
"""


def variable(reference, name, causality, start, unit):
    variability = "tunable" if causality == "parameter" else "continuous"
    initial = ' initial="exact"' if causality == "parameter" else ""
    own = ("" if start is None else f' start="{start}"') + (f' unit="{unit}"' if unit else "")
    head = f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}"'
    return f'{head} variability="{variability}"{initial}><Real{own}/></ScalarVariable>'


folder, here = sys.argv[1], os.path.dirname(os.path.abspath(__file__))
library = os.path.join(folder, "unit.so")
subprocess.run(["gcc", "-shared", "-fPIC", "-O2", "-w", "-o", library, os.path.join(here, "unit.c"), "-lm"], check=True)
units = "".join(f'<Unit name="{u}"/>' for u in sorted({u for *_, u in VARIABLES if u}))
variables = "".join(variable(k, *v) for k, v in enumerate(VARIABLES))
description = (
    '<?xml version="1.0" encoding="UTF-8"?>'
    '<fmiModelDescription fmiVersion="2.0" modelName="unit" guid="{1}">'
    '<CoSimulation modelIdentifier="unit" canHandleVariableCommunicationStepSize="true"/>'
    f"<UnitDefinitions>{units}</UnitDefinitions><ModelVariables>{variables}</ModelVariables>"
    '<ModelStructure><Outputs><Unknown index="2"/></Outputs></ModelStructure></fmiModelDescription>'
)
with zipfile.ZipFile(os.path.join(folder, "unit.fmu"), "w") as out:
    out.writestr("modelDescription.xml", description)
    out.write(library, "binaries/linux64/unit.so")
with open(os.path.join(folder, "campaign.toml"), "w") as out:
    out.write(CAMPAIGN)
