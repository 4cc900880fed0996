"""Makes a campaign of published measurements: `python3 prepare.py CASE FOLDER FILE ...`, with the files that README.md names.

It cuts a record into runs, names the columns and converts units; it removes no outliers and fits nothing. Needs numpy and,
for inverse models, scipy (a low-pass that leaves no lag); workbooks need openpyxl.
"""
import csv
import os
import sys

import numpy as np


def write(folder, name, columns):
    with open(os.path.join(folder, name + ".csv"), "w", newline="") as out:
        rows = csv.writer(out)
        rows.writerow(columns)
        for row in zip(*columns.values()):
            rows.writerow(["" if np.isnan(x) else f"{x:.9g}" for x in row])


def campaign(folder, channels, runs):
    os.makedirs(folder, exist_ok=True)
    text = ["[channels]"] + [f'{name} = "{unit}"' for name, unit in channels.items()]
    for name, columns, settings in runs:
        write(folder, name, columns)
        text += ["", "[[run]]", f'file = "{name}.csv"'] + [f"{key} = {x:.9g}" for key, x in settings.items()]
    with open(os.path.join(folder, "campaign.toml"), "w") as out:
        out.write("\n".join(text) + "\n")


def table(file, skip=0, columns=None):
    return np.genfromtxt(file, delimiter=",", skip_header=skip, usecols=columns)


def sheet(file, name=None):
    import openpyxl

    book = openpyxl.load_workbook(file, data_only=True)
    rows = (book[name] if name else book.worksheets[0]).iter_rows(values_only=True)
    return np.array([[x for x in row if x is not None] for row in rows if isinstance(row[1], (int, float))], float)


def lowpass(x, corner, rate):
    from scipy.signal import butter, sosfiltfilt

    return sosfiltfilt(butter(4, corner, fs=rate, output="sos"), x)


def motion(time, position, corner):
    """Position, speed and acceleration by central differences of a position that passed a low-pass."""
    q = lowpass(position, corner, 1 / np.mean(np.diff(time)))
    v = np.gradient(q, time)
    return {"position": q, "speed": v, "acceleration": np.gradient(v, time)}


def silverbox(folder, file):
    """Three stretches of the multisine part, at 1e7/2^14 Hz. Each is compared after the first 0.3 s, in which the state that
    it began from dies away."""
    rate, data = 1e7 / 2**14, table(file, 1, (0, 1))
    runs = []
    for k, first in enumerate((49152, 73728, 98304)):
        u, y = data[first : first + 2000].T
        compared = y.copy()
        compared[: round(0.3 * rate)] = np.nan
        begin = {"begin": y[0], "rise": (data[first + 1, 1] - data[first - 1, 1]) * rate / 2}
        runs.append((f"multisine{k + 1}", {"time": np.arange(len(u)) / rate, "drive": u, "output": compared}, begin))
    campaign(folder, {"output": "V"}, runs)


def tanks(folder, file):
    data = table(file, 1)[:, :4]
    time = 4.0 * np.arange(len(data))
    runs = [
        (name, {"time": time, "pump": data[:, k], "level": data[:, k + 2]}, {"lower": data[0, k + 2]})
        for k, name in enumerate(("estimation", "validation"))
    ]
    campaign(folder, {"level": "V"}, runs)


def pendulum(folder, time, angle, offset=0.0, runs_wanted=4):
    """A decay cut into runs of equally many swings, each from an extreme on, where the speed is nearly zero."""
    step = np.mean(np.diff(time))
    near = max(1, round(0.1 / step))
    extremes = [
        k for k in range(near, len(angle) - near)
        if abs(angle[k] - offset) >= max(abs(angle[k - near : k + near + 1] - offset)) and abs(angle[k] - offset) > 0.05
    ]
    # Of equal samples around an extreme the middle one.
    groups = np.split(np.array(extremes), np.flatnonzero(np.diff(extremes) > near) + 1)
    firsts = [int(np.median(g)) for g in groups]
    cuts = [firsts[round(1 + n * (len(firsts) - 1) / runs_wanted)] if n < runs_wanted else None for n in range(runs_wanted + 1)]
    runs = []
    for n in range(runs_wanted):
        at = slice(cuts[n], cuts[n + 1])
        t, q = time[at] - time[at][0], angle[at] - offset
        runs.append((f"swings{n + 1}", {"time": t, "angle": q}, {"begin": q[0]}))
    campaign(folder, {"angle": "rad"}, runs)


def wooden_bob(folder, file):
    data = sheet(file)
    pendulum(folder, data[:, 0], np.radians(data[:, 1]))


def skov_pendulum_1(folder, file):
    data = table(file)[300:]
    pendulum(folder, data[::2, 0], data[::2, 1], np.pi)


def skov_pendulum_2(folder, file):
    data = table(file)[150:]
    pendulum(folder, data[::2, 0], data[::2, 1], np.pi)


def balls(folder, file, *names):
    runs = []
    for name in names:
        data = sheet(file, name)
        for drop in (1, 2):
            time, height = data[data[:, 0] == drop][:, 1:3].T
            runs.append((f"{name.lower().replace(' ', '_')}_{drop}", {"time": time, "height": height}, {"begin": height[0]}))
    campaign(folder, {"height": "m"}, runs)


def basketballs(folder, file):
    balls(folder, file, "Blue Basketball", "Green Basketball")


def whiffle_balls(folder, file):
    balls(folder, file, "Whiffle Ball 1", "Whiffle Ball 2")


def dfki_pendulum(folder, file):
    data = table(file, 1)
    columns = {"time": data[:, 0], **motion(data[:, 0], data[:, 1], 15), "torque": data[:, 3]}
    campaign(folder, {"torque": "N m"}, [("swing_up", columns, {})])


def exchanger(folder, file):
    """Four runs of a thousand samples."""
    data = table(file, 1)
    runs = []
    for k in range(4):
        flow, temperature = data[1000 * k : 1000 * (k + 1), 1:].T
        compared = temperature.copy()
        compared[:100] = np.nan
        runs.append((f"part{k + 1}", {"time": np.arange(1000.0), "flow": flow, "temperature": compared}, {}))
    campaign(folder, {"temperature": "°C"}, runs)


def rack_and_pinion(folder, force_file, speed_file):
    """Scales, the shift of 4 ms between both recorders and the low-pass at 30 Hz as in the source's acquisition.m and
    conditioning.m, but without its lag."""
    force, speed = table(force_file, 5, (0, 1)), table(speed_file, 5, (0, 1))
    time, v = speed[:, 0] / 1000, -speed[:, 1] * 0.02 / 60
    f = -200 * (force[:, 1] - np.mean(force[:10, 1]))
    inside = (time > force[0, 0] + 0.004) & (time < force[-1, 0] + 0.004)
    time, v = time[inside], v[inside]
    f = np.interp(time, force[:, 0] + 0.004, f)
    rate = 1 / np.mean(np.diff(time))
    v, f = lowpass(v, 30, rate), lowpass(f, 30, rate)
    columns = {"time": time, "speed": v, "acceleration": np.gradient(v, time), "position": np.cumsum(v) * np.mean(np.diff(time)), "force": f}
    campaign(folder, {"force": "N"}, [("stroke", columns, {})])


CASES = {
    f.__name__: f
    for f in (silverbox, tanks, wooden_bob, skov_pendulum_1, skov_pendulum_2, exchanger, basketballs, whiffle_balls, dfki_pendulum, rack_and_pinion)
}

if __name__ == "__main__":
    if len(sys.argv) < 4 or sys.argv[1] not in CASES:
        sys.exit(f"usage: python3 prepare.py CASE FOLDER FILE ...; cases: {', '.join(CASES)}")
    CASES[sys.argv[1]](*sys.argv[2:])
