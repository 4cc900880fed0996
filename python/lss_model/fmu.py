"""`python3 -m lss_model.fmu FILE.fmu CAMPAIGN`: a functional mock-up unit (FMI 2.0 or 3.0, co-simulation) as a model.

`lss gap diagnose CAMPAIGN --fmu FILE.fmu` starts it. The table [fmu] of the campaign.toml names the unit's parameters:

    [[fmu.nuisance]]
    parameter = "tank.k1"       # begins at the unit's start value
    low = 0.02
    high = 0.1

    [[fmu.effect]]
    name = "overflow"           # the parameter's own name when not given
    parameter = "tank.overflow"
    trial = 0.02                # deviations from the unit's start value: 0 is no effect
    low = 0
    high = 1
    sensor = false

Columns of a run that are named like inputs of the unit are fed into it, the run's settings are start values, and the
declared channels are read from variables of the same names. Nuisances and effects are varied continuously, so their
parameters are real numbers: Real of FMI 2.0, Float64 or Float32 of FMI 3.0. Settings may be integers and Booleans, too.
Arrays are refused. Event mode, early return and intermediate updates of FMI 3.0 are off. Needs FMPy (`pip install fmpy`).
"""
import os
import shutil
import sys
import tomllib

from . import effect, nuisance, serve


def fail(why):
    print(f"lss_model.fmu: {why}", file=sys.stderr)
    sys.exit(1)


REAL = ("Real", "Float64", "Float32")


def number(variable, file):
    """A variable that is one number."""
    if getattr(variable, "dimensions", None):
        sizes = " x ".join(str(x.start if x.start is not None else x.valueReference) for x in variable.dimensions)
        raise ValueError(f"{variable.name} of {file} is an array ({sizes}); only variables of one number are read and set")
    if variable.type in ("String", "Binary", "Clock"):
        raise ValueError(f"{variable.name} of {file} is of type {variable.type}, no number")
    return variable


def real(variable, file):
    """A variable whose values are real numbers."""
    if number(variable, file).type not in REAL:
        raise ValueError(
            f"{variable.name} of {file} is of type {variable.type}; a nuisance or an effect is varied continuously, so it"
            f" has to be one of {', '.join(REAL)}. A setting of a run may be of any numeric type"
        )
    return variable


def whole(variable, value):
    """The value of a setting in the variable's type; an integer or Boolean is not rounded without a word."""
    if variable.type in REAL:
        return value
    if value != int(value) or (variable.type == "Boolean" and value not in (0, 1)):
        raise ValueError(f"{variable.name} is of type {variable.type}, but {value} was given")
    return int(value)


class Unit:
    """A unit that was unpacked and instantiated once."""

    def __init__(self, file, campaign):
        try:
            import fmpy
            import numpy
        except ImportError as why:
            fail(f"{why}; FMPy runs the units: pip install fmpy")
        self.fmpy, self.numpy = fmpy, numpy
        listed = os.path.join(campaign, "campaign.toml") if os.path.isdir(campaign) else campaign
        with open(listed, "rb") as opened:
            campaign = tomllib.load(opened)
        self.channels = list(campaign.get("channels", {}))
        own = campaign.get("fmu", {})
        self.folder = fmpy.extract(file)
        self.description = fmpy.read_model_description(self.folder)
        if self.description.coSimulation is None:
            fail(f"{file} has no co-simulation")
        variables = {v.name: v for v in self.description.modelVariables}
        for name in self.channels:
            if name not in variables:
                fail(f"the channel {name} is no variable of {file}; it has {', '.join(sorted(variables)[:20])}")
            number(variables[name], file)
        self.variables, self.file = variables, file
        self.inputs = [v.name for v in self.description.modelVariables if v.causality == "input"]
        self.parameters, self.nuisances, self.effects = {}, [], []
        for table, kind in ((own.get("nuisance", []), "nuisance"), (own.get("effect", []), "effect")):
            for said in table:
                parameter = said.get("parameter", "")
                variable = variables.get(parameter)
                if variable is None or variable.start is None:
                    fail(f"[[fmu.{kind}]]: {parameter or 'a parameter'} is no variable of {file} with a start value")
                real(variable, file)
                start, unit, name = float(variable.start), variable.unit or "", said.get("name", parameter)
                try:
                    if kind == "nuisance":
                        low, high = said["low"], said["high"]
                        self.nuisances.append(nuisance(name, start, low, high, unit, said.get("shared", False)))
                        self.parameters[name] = (parameter, 0.0)
                    else:
                        strength = (said["trial"], said["low"], said["high"], unit)
                        self.effects.append(effect(name, sensor=said.get("sensor", False), deviation=strength))
                        self.parameters[f"{name}.deviation"] = (parameter, start)
                except KeyError as key:
                    fail(f"[[fmu.{kind}]] of {parameter} lacks {key}")
        if not self.effects:
            fail("the campaign.toml names no [[fmu.effect]], so there is nothing to choose from")
        self.accuracy = own.get("accuracy", {})
        self.instance = fmpy.instantiate_fmu(self.folder, self.description, "CoSimulation")
        self.signals, self.fresh = {}, True

    def simulate(self, inputs, parameters):
        time = inputs["time"]
        start = {}
        for name in parameters.keys() & self.variables.keys():
            start[name] = whole(number(self.variables[name], self.file), parameters[name])
        for name, (parameter, added) in self.parameters.items():
            start[parameter] = parameters[name] + added
        fed = [number(self.variables[name], self.file).name for name in self.inputs if name in inputs]
        key = id(inputs)
        if fed and key not in self.signals:
            rows = zip(time, *(inputs[name] for name in fed))
            self.signals[key] = self.numpy.array(list(rows), dtype=[(name, float) for name in ["time", *fed]])
        steps = len(time) - 1
        if not self.fresh:
            self.instance.reset()
        self.fresh = False
        try:
            result = self.fmpy.simulate_fmu(
                self.folder,
                start_time=time[0],
                stop_time=time[-1],
                output_interval=(time[-1] - time[0]) / steps,
                start_values=start,
                input=self.signals.get(key),
                output=self.channels,
                model_description=self.description,
                fmu_instance=self.instance,
                fmi_type="CoSimulation",
                terminate=False,
            )
        except Exception:
            # What failed once may be in any state.
            self.instance = self.fmpy.instantiate_fmu(self.folder, self.description, "CoSimulation")
            self.fresh = True
            raise
        return {"time": result["time"], **{name: result[name] for name in self.channels}}


def main():
    if len(sys.argv) != 3:
        fail("usage: python3 -m lss_model.fmu FILE.fmu CAMPAIGN")
    try:
        unit = Unit(sys.argv[1], sys.argv[2])
    except ValueError as why:
        fail(why)
    try:
        serve(unit.simulate, unit.effects, unit.nuisances, unit.accuracy)
    finally:
        shutil.rmtree(unit.folder, ignore_errors=True)


main()
