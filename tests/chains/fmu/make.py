"""Packs a unit for co-simulation with the campaign that names its parameters: `make.py FOLDER 2` for unit.c and FMI 2.0,
`make.py FOLDER 3` for unit3.c and FMI 3.0."""
import os
import subprocess
import sys
import zipfile

# In the order of mass.h: name, causality, start, unit.
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
    head = f'name="{name}" valueReference="{reference}" causality="{causality}" variability="{variability}"{initial}'
    if VERSION == 2:
        return f"<ScalarVariable {head}><Real{own}/></ScalarVariable>"
    return f"<Float{32 if name in NARROW else 64} {head}{own}/>"


FOLDER, VERSION = sys.argv[1], int(sys.argv[2])
NARROW = ("coulomb", "cubic")
SOURCE = {2: "unit.c", 3: "unit3.c"}[VERSION]
PLATFORM = {2: "linux64", 3: "x86_64-linux"}[VERSION]

here = os.path.dirname(os.path.abspath(__file__))
library = os.path.join(FOLDER, "unit.so")
subprocess.run(["gcc", "-shared", "-fPIC", "-O2", "-w", "-o", library, os.path.join(here, SOURCE), "-lm"], check=True)
units = "".join(f'<Unit name="{u}"/>' for u in sorted({u for *_, u in VARIABLES if u}))
variables = "".join(variable(k, *v) for k, v in enumerate(VARIABLES))
if VERSION == 2:
    head = 'fmiVersion="2.0" modelName="unit" guid="{1}"'
    can = 'canHandleVariableCommunicationStepSize="true"'
    outputs = '<Outputs><Unknown index="2"/></Outputs>'
else:
    tunable = 'causality="parameter" variability="tunable" initial="exact"'
    variables += f'<Int32 name="substeps" valueReference="8" {tunable} start="8"/>'
    variables += f'<Float64 name="masses" valueReference="9" {tunable} start="1 2"><Dimension start="2"/></Float64>'
    variables += '<Float64 name="time" valueReference="10" causality="independent" variability="continuous"/>'
    head = 'fmiVersion="3.0" modelName="unit" instantiationToken="{1}"'
    can = 'canHandleVariableCommunicationStepSize="true" hasEventMode="true" providesIntermediateUpdate="true"'
    outputs = '<Output valueReference="1"/>'
description = (
    f'<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription {head}><CoSimulation modelIdentifier="unit" {can}/>'
    f"<UnitDefinitions>{units}</UnitDefinitions><ModelVariables>{variables}</ModelVariables>"
    f"<ModelStructure>{outputs}</ModelStructure></fmiModelDescription>"
)
with zipfile.ZipFile(os.path.join(FOLDER, "unit.fmu"), "w") as out:
    out.writestr("modelDescription.xml", description)
    out.write(library, f"binaries/{PLATFORM}/unit.so")
with open(os.path.join(FOLDER, "campaign.toml"), "w") as out:
    out.write(CAMPAIGN)
