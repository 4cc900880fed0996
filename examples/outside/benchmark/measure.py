"""Makes the measurements of the benchmark: `python3 measure.py FOLDER [CASE ...]`. Needs numpy and scipy.

Integrated by scipy's DOP853 to 1e-9, friction with a sign that is ten times sharper than the models', noise from a seed
of each case's own. What a case has beyond its model is its truth, in `truth.json` beside its campaign.
"""
import csv
import json
import math
import os
import sys
import zlib

import numpy as np
from scipy.integrate import solve_ivp


def solve(rate, begin, time, step=None):
    """States at the times, a row each; `step` is the longest step."""
    found = solve_ivp(rate, (time[0], time[-1]), begin, "DOP853", time, rtol=1e-8, atol=1e-9, max_step=step or np.inf)
    assert found.success, found.message
    return found.y


def solve_held(rate, begin, time):
    """Piece by piece, as the input jumps at each sample."""
    out = [np.array(begin, float)]
    for k in range(len(time) - 1):
        found = solve_ivp(lambda t, s: rate(k, s), (time[k], time[k + 1]), out[-1], "DOP853", rtol=1e-8, atol=1e-10)
        out.append(found.y[:, -1])
    return np.array(out).T


def multisine(time, lines, size, random):
    phases = random.uniform(0, 2 * math.pi, len(lines))
    x = sum(np.cos(2 * math.pi * f * time + p) for f, p in zip(lines, phases))
    return size * x / np.std(x)


def filtered(random, count, memory):
    """Noise that remembers, of unit variance."""
    a = math.exp(-1 / memory)
    x = np.zeros(count)
    white = random.normal(size=count) * math.sqrt(1 - a * a)
    x[0] = random.normal()
    for k in range(1, count):
        x[k] = a * x[k - 1] + white[k]
    return x


def pendulum(random, length, viscous, coulomb=0.0, drag=0.0, dashpot=0.0, wear=0.0, noise=0.002):
    for begin in (1.2, 0.8, 1.6):
        time = np.arange(0, 24, 0.02)

        def rate(t, s):
            q, v = s
            # The dashpot works on one side only.
            side = dashpot * v * (q > 0.1) * abs(q - 0.1)
            dry = coulomb * math.tanh(v / 0.001) + drag * v * abs(v)
            return [v, -9.81 / length * math.sin(q) - (viscous + wear * t / 24) * v - dry - side]

        q = solve(rate, (begin, 0.0), time, 0.01)[0]
        yield {"begin": begin}, {"time": time, "angle": q + noise * random.normal(size=len(time))}


def cart(random):
    for k, size in enumerate((2.0, 3.0, 4.0)):
        time = np.arange(0, 20, 0.02)
        force = size * np.sign(np.sin(2 * math.pi * time / (3 + k)) + 0.2 * np.sin(2 * math.pi * time / 7))

        def rate(i, s):
            return [s[1], (force[i] - 2.0 * s[1] - 0.45 * math.tanh(s[1] / 0.0005)) / 1.15]

        x, v = solve_held(rate, (0.0, 0.0), time)
        own = {"position": x + 0.002 * random.normal(size=len(time)), "speed": v + 0.01 * random.normal(size=len(time))}
        yield {}, {"time": time, "force": force, **own}


def silverbox(random):
    rate_hz = 1e7 / 2**14  # as published, Wigren and Schoukens 2013
    for size in (0.009, 0.014, 0.02):
        time = np.arange(1400) / rate_hz
        lines = (2 * np.arange(100) + 1) * rate_hz / 1400 * 1.0
        drive = multisine(time, lines[lines < 200], size, random)
        w = 2 * math.pi * 68.6

        def rate(k, s):
            y, v = s
            return [v, w * w * (drive[k] - y - 3.9 * y**3) - 2 * 0.05 * w * v]

        y = solve_held(rate, (0.0, 0.0), time)[0]
        yield {}, {"time": time, "drive": drive, "output": y + 0.0009 * random.normal(size=len(time))}


def bolted(random):
    for size in (0.015, 0.03, 0.045):
        time = np.arange(0, 6, 1 / 250)
        force = size * np.sin(2 * math.pi * (14 * time + (26 - 14) / 2 / 6 * time**2))
        w = 2 * math.pi * 20.0

        def rate(k, s):
            x, v = s
            size = math.sqrt(x * x + (v / w) ** 2)
            return [v, w * w * (force[k] - x * (1 - 0.08 * abs(x))) - 2 * 0.012 * (1 + 1.6 * size) * w * v]

        x = solve_held(rate, (0.0, 0.0), time)[0]
        yield {}, {"time": time, "force": force, "displacement": x + 0.004 * random.normal(size=len(time))}


def tanks(random):
    for k in range(3):
        time = np.arange(1024) * 4.0
        pump = np.clip(3.2 + multisine(time, np.arange(1, 30) / 4096, 1.5, random), 0, 10)
        upper, lower = 5.0, 4.0 + k

        def rate(i, s):
            a, b = max(s[0], 0.0), max(s[1], 0.0)
            over = max(a - 10.0, 0.0) * 0.5
            flow = 0.054 * math.sqrt(a)
            return [0.047 * pump[i] - flow - over, flow - 0.058 * math.sqrt(b)]

        level = solve_held(rate, (upper, lower), time)[1]
        yield {"upper": upper, "lower": lower}, {"time": time, "pump": pump, "level": level + 0.05 * random.normal(size=len(time))}


def spring(random, lag=0.0, hysteresis=0.0, memory=0.0):
    for size in (0.6, 1.0, 1.5):
        time = np.arange(0, 16, 0.016)
        force = multisine(time, np.arange(2, 50) / 16, size, random)

        def rate(k, s):
            x, v, z = s
            # Bouc-Wen hysteresis (Wen 1976) of a rubber mount.
            dz = 60 * v - 60 * abs(v) * z
            return [v, (force[k] - 96 * x - 0.7 * v - hysteresis * z) / 1.08, dz]

        x = solve_held(rate, (0.0, 0.0, 0.0), time)[0]
        if lag:
            y = [x[0]]
            for now in x[1:]:
                y.append(y[-1] + (now - y[-1]) * (1 - math.exp(-0.016 / lag)))
            x = np.array(y)
        noise = filtered(random, len(time), memory) if memory else random.normal(size=len(time))
        yield {}, {"time": time, "force": force, "position": x + 0.0008 * noise}


CASES = {
    "pendulum_coulomb": (["coulomb"], lambda r: pendulum(r, 0.493, 0.06, coulomb=0.12)),
    "pendulum_drag": (["drag"], lambda r: pendulum(r, 0.512, 0.03, drag=0.05)),
    "pendulum_both": (["coulomb", "drag"], lambda r: pendulum(r, 0.493, 0.02, coulomb=0.08, drag=0.06)),
    "pendulum_dashpot": (["unknown"], lambda r: pendulum(r, 0.493, 0.04, dashpot=2.5)),
    "pendulum_wear": (["unknown"], lambda r: pendulum(r, 0.493, 0.05, wear=0.15)),
    "cart_rail": (["coulomb"], cart),
    "silverbox": (["cubic"], silverbox),
    "bolted_joint": (["softening", "amplitude_damping"], bolted),
    "tanks": (["overflow"], tanks),
    "spring_lag": (["sensor_lag"], lambda r: spring(r, lag=0.02)),
    "spring_right": (["none"], lambda r: spring(r, memory=5.0)),
    "spring_unknown": (["unknown"], lambda r: spring(r, hysteresis=0.9)),
}

CHANNELS = {
    "pendulum": {"angle": "rad"}, "cart": {"position": "m", "speed": "m/s"}, "silverbox": {"output": "V"},
    "bolted": {"displacement": "mm"}, "tanks": {"level": "V"}, "spring": {"position": "m"},
}


def main(folder, names):
    for name in names or CASES:
        truth, make = CASES[name]
        at = os.path.join(folder, name)
        os.makedirs(at, exist_ok=True)
        random = np.random.default_rng(zlib.crc32(name.encode()))
        lines = ["[channels]"] + [f'{c} = "{u}"' for c, u in CHANNELS[name.split("_")[0]].items()]
        for k, (settings, columns) in enumerate(make(random)):
            with open(os.path.join(at, f"run{k + 1}.csv"), "w", newline="") as out:
                writer = csv.writer(out, lineterminator="\n")
                writer.writerow(columns)
                writer.writerows(zip(*(map(lambda x: f"{x:.9g}", values) for values in columns.values())))
            lines += ["[[run]]", f'file = "run{k + 1}.csv"'] + [f"{s} = {x}" for s, x in settings.items()]
        with open(os.path.join(at, "campaign.toml"), "w") as out:
            out.write("\n".join(lines) + "\n")
        with open(os.path.join(at, "truth.json"), "w") as out:
            json.dump(truth, out)


if __name__ == "__main__":
    main(sys.argv[1], sys.argv[2:])
