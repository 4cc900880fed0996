"""A positioning drive, as a model for `lss gap diagnose`: which force does its rigid model lack?

    M q'' + F_v q' + offset + effects = g u,  u drive command V, q position m, g = 35.1506 N/V

The drive command is compared. It is predicted from the measured motion (inverse model), so nothing drifts away as in an open loop:
position passes a Butterworth low-pass of 4th order forwards and backwards, which leaves no lag, and is differentiated over central
differences (Gautier 1997). The command passes no filter: means over windows do that. The data are those of A. Janot, M. Gautier and
M. Brunot, "Data set and reference models of EMPS", 2019 (nonlinearbenchmark.org). Plain Python, no packages.
"""
import csv, json, math, sys
from bisect import bisect_left, bisect_right

GAIN = 35.1506  # N/V
CORNER = 50.0  # Hz, of the low-pass on position
STRIBECK = 0.01  # m/s, speed over which breaking loose fades
LOAD = 0.5  # share of the moved mass behind the backlash
EVERY = 5  # samples of the answer's step


def effect(name, strength, unit, trial, low, high):
    return {"name": name, "strengths": [{"name": strength, "unit": unit, "trial": trial, "low": low, "high": high}]}


DESCRIPTION = {
    "nuisances": [
        {"name": "mass", "unit": "kg", "nominal": 100, "low": 50, "high": 150},
        {"name": "viscous_friction", "unit": "N s/m", "nominal": 250, "low": 0, "high": 800},
        {"name": "offset", "unit": "N", "nominal": 0, "low": -30, "high": 30},
    ],
    "effects": [
        effect("coulomb", "force", "N", 2, 0, 100),
        effect("stribeck", "force", "N", 2, 0, 100),
        effect("quadratic_drag", "coefficient", "N s2/m2", 100, -10000, 10000),
        effect("cubic_drag", "coefficient", "N s3/m3", 1000, -100000, 100000),
        effect("spring", "stiffness", "N/m", 10, -500, 500),
        effect("backlash", "gap", "m", 0.001, 0, 0.02),
        effect("asymmetric_friction", "coefficient", "N s/m", 20, -400, 400),
        effect("friction_drift", "rate", "1/s", 0.002, -0.03, 0.03),
        effect("drive_gain", "relative", "", 0.02, -0.3, 0.3),
        effect("drive_saturation", "relative", "1/V2", 0.002, 0, 0.03),
        effect("drive_delay", "time", "s", 0.002, 0, 0.05),
    ],
    # 1 % of the largest command: no rigid model of a drive is asked to follow more closely.
    "accuracy": {"drive_command": 0.04},
}


def lowpass(x, corner, rate):
    """Butterworth of 4th order, forwards and backwards; at the ends the signal is reflected through its end point."""
    pad = min(len(x) - 1, int(3 * rate / corner))
    y = [2 * x[0] - v for v in x[pad:0:-1]] + x + [2 * x[-1] - v for v in x[-2 : -2 - pad : -1]]
    w = math.tan(math.pi * corner / rate)
    for _ in range(2):
        for k in (0, 1):
            damping = 2 * math.cos(math.pi * (2 * k + 1) / 8) * w
            b, a1, a2 = (v / (1 + damping + w * w) for v in (w * w, 2 * (w * w - 1), 1 - damping + w * w))
            u1 = u2 = v1 = v2 = y[0]
            passed = []
            for u in y:
                v = b * (u + 2 * u1 + u2) - a1 * v1 - a2 * v2
                u1, u2, v1, v2 = u, u1, v, v1
                passed.append(v)
            y = passed
        y.reverse()
    return y[pad : pad + len(x)]


def slope(x, step):
    inner = [(b - a) / (2 * step) for a, b in zip(x, x[2:])]
    return [(x[1] - x[0]) / step] + inner + [(x[-1] - x[-2]) / step]


def since_reversal(q, dq):
    """How far the drive has gone since it last turned."""
    turned, sign, gone = q[0], 0, []
    for x, v in zip(q, dq):
        if abs(v) > 1e-3 and (v > 0) != (sign > 0):
            turned, sign = x, v
        gone.append(abs(x - turned))
    return gone


runs = {}  # motion by file, worked out once


def motion(file):
    if file not in runs:
        with open(file, newline="") as opened:
            rows = list(csv.DictReader(opened))
        time = [float(row["time"]) for row in rows]
        step = (time[-1] - time[0]) / (len(time) - 1)
        q = lowpass([float(row["position"]) for row in rows], CORNER, 1 / step)
        dq = slope(q, step)
        runs[file] = time, q, dq, slope(dq, step), since_reversal(q, dq)
    return runs[file]


def sign(x):
    return (x > 0) - (x < 0)


def simulate(run, nuisances, effects):
    time, q, dq, ddq, gone = motion(run["file"])
    mass, viscous, offset = (nuisances[n] for n in ("mass", "viscous_friction", "offset"))
    add = {e["name"]: next(iter(e["strengths"].values())) for e in effects}
    has = lambda name: add.get(name, 0.0)
    coulomb, breakaway, quadratic, cubic = map(has, ("coulomb", "stribeck", "quadratic_drag", "cubic_drag"))
    spring, gap, asymmetric, drift = map(has, ("spring", "backlash", "asymmetric_friction", "friction_drift"))
    gain, saturation, delay = 1 + has("drive_gain"), has("drive_saturation"), has("drive_delay")
    # With a delay the command comes before the force that it makes.
    first = max(0, bisect_left(time, run["from"]) - EVERY)
    last = min(len(time) - 1, bisect_right(time, run["to"] + delay) + EVERY)
    at = list(range(first, last, EVERY)) + [last]
    command = []
    for i in at:
        v = dq[i]
        driven = mass * (1 - LOAD if gone[i] < gap else 1)
        force = driven * ddq[i] + viscous * (1 + drift * (time[i] - time[0])) * v + offset + spring * q[i]
        force += (coulomb + breakaway * math.exp(-((v / STRIBECK) ** 2))) * sign(v)
        force += (quadratic + cubic * abs(v)) * abs(v) * v + asymmetric * abs(v)
        u = force / (GAIN * gain)
        command.append(u * (1 + saturation * u * u))
    said = [time[i] - delay for i in at]
    if said[-1] < run["to"]:  # of the last moments the force is not known yet
        said.append(run["to"])
        command.append(None)
    return {"time": said, "channels": {"drive_command": command}}


for line in sys.stdin:
    asked = json.loads(line)
    if asked["request"] == "describe":
        answer = DESCRIPTION
    else:
        try:
            answer = simulate(asked["run"], asked["nuisances"], asked["effects"])
        except (OSError, KeyError, ValueError, IndexError) as why:
            answer = {"error": f"{type(why).__name__}: {why}"}
    print(json.dumps(answer), flush=True)
