"""Any Python function as a model for `lss gap diagnose CAMPAIGN --model "python3 FILE.py"`.

    import lss_model

    def simulate(inputs, parameters):
        return {"temperature": [...]}            # one list or array a channel, as long as inputs["time"]

    lss_model.serve(
        simulate,
        nuisances=[lss_model.nuisance("loss", 5, 1, 15, "W/K")],
        effects=[lss_model.effect("radiation", area=(0.02, 0, 0.5, "m2"))],
    )

`inputs` is a dictionary of the run's columns, each a list (text stays text), `time` in seconds among them.
`parameters` is a dictionary of numbers: the nuisances by name, the strengths by `effect.strength` (0 where the effect is
not there), the settings of the run's entry in campaign.toml, and `from` and `to`, the stretch that is compared.

Needs no packages. Arrays of numpy may be answered as they are.
"""
import csv
import json
import math
import sys

__all__ = ["nuisance", "effect", "serve", "read"]


def nuisance(name, nominal, low, high, unit="", shared=False):
    """A parameter that is not well known: it is fitted, to each run or to all together, and explains nothing."""
    said = {"name": name, "unit": unit, "nominal": nominal, "low": low, "high": high}
    return {**said, "shared": True} if shared else said


def effect(name, place="", sensor=False, **strengths):
    """What may be missing in the model. Each strength is (trial, low, high) or (trial, low, high, unit); 0 is none."""
    said = [
        {"name": own, "trial": x[0], "low": x[1], "high": x[2], "unit": x[3] if len(x) > 3 else ""}
        for own, x in strengths.items()
    ]
    return {"name": name, "place": place, "sensor": sensor, "strengths": said}


def read(file):
    """The columns of a CSV file, or of a Parquet file where pyarrow is there. Empty fields are NaN."""
    if file.lower().endswith(".parquet"):
        import pyarrow.parquet

        return pyarrow.parquet.read_table(file).to_pydict()
    with open(file, newline="") as opened:
        rows = list(csv.reader(opened))
    return {name.strip(): [_number(row[k]) for row in rows[1:] if row] for k, name in enumerate(rows[0])}


def _number(text):
    if not text.strip():
        return math.nan
    try:
        return float(text)
    except ValueError:
        return text


def _channel(values):
    """JSON has no NaN."""
    values = values.tolist() if hasattr(values, "tolist") else values
    return [x if x is not None and math.isfinite(x) else None for x in map(_plain, values)]


def _plain(x):
    return None if x is None else float(x)


def serve(simulate, effects, nuisances=(), accuracy=None, lines=None, write=None):
    """Answers questions line by line until the input ends. What `simulate` prints goes to the standard error."""
    lines = sys.stdin if lines is None else lines
    out, sys.stdout = sys.stdout, sys.stderr
    write = write or (lambda text: print(text, file=out, flush=True))
    names = [f"{e['name']}{'@' + e['place'] if e.get('place') else ''}.{s['name']}" for e in effects for s in e["strengths"]]
    known = {}
    for line in lines:
        asked = json.loads(line)
        if asked["request"] == "describe":
            said = {"nuisances": list(nuisances), "effects": list(effects), "accuracy": accuracy or {}}
        else:
            try:
                run = asked["run"]
                if run["file"] not in known:
                    known[run["file"]] = read(run["file"])
                inputs = known[run["file"]]
                parameters = {**run["settings"], "from": run["from"], "to": run["to"], **dict.fromkeys(names, 0.0)}
                parameters.update(asked["nuisances"])
                for e in asked["effects"]:
                    at = f"{e['name']}{'@' + e['place'] if e.get('place') else ''}"
                    parameters.update({f"{at}.{name}": x for name, x in e["strengths"].items()})
                answer = dict(simulate(inputs, parameters))
                time = answer.pop("time", inputs["time"])
                said = {"time": _channel(time), "channels": {name: _channel(x) for name, x in answer.items()}}
            except Exception as why:  # a model may fail in any way; the diagnosis tells how
                said = {"error": f"{type(why).__name__}: {why}"}
        write(json.dumps(said))
