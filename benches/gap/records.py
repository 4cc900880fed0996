"""Writes a campaign's runs as another hand might have recorded them, one folder a way, to see what a diagnosis makes of it.

    python3 benches/gap/records.py CAMPAIGN OUT
    lss gap diagnose OUT/kilonewtons -o gap

CAMPAIGN is a folder with campaign.toml, a layout, and runs as CSV with their sidecars, as in docs/gap.md.
"""

import csv
import math
import random
import re
import shutil
import sys
from pathlib import Path

FORCES = ["steer_left", "steer_right", "run_left", "run_right", "joint_xi", "joint_eta", "joint_zeta"]


class Record:
    """A run: its columns by name, and the text of its sidecar."""

    def __init__(self, path):
        rows = list(csv.reader(path.open()))
        self.columns = {name: [float(x) if x else math.nan for x in column] for name, *column in zip(*rows)}
        self.sidecar = path.with_suffix(".toml").read_text()

    def write(self, path):
        with path.open("w", newline="") as file:
            out = csv.writer(file)
            out.writerow(self.columns)
            # Times of a clock of 1970 take more digits than a force has.
            out.writerows([["" if math.isnan(x) else f"{x:.14g}" for x in row] for row in zip(*self.columns.values())])
        path.with_suffix(".toml").write_text(self.sidecar)

    def change(self, names, value):
        for name in names:
            self.columns[name] = [value(x) for x in self.columns[name]]

    def keep(self, samples):
        self.columns = {name: column[samples] for name, column in self.columns.items()}

    def nominal(self, key, value):
        """Changes a number of the sidecar."""
        found = re.search(rf"^{key} = (.*)$", self.sidecar, re.M)
        self.sidecar = self.sidecar.replace(found[0], f"{key} = {value(float(found[1])):g}")


def kilonewtons(run, chance):
    run.change(FORCES, lambda x: x / 1000)


def reversed_tension(run, chance):
    run.change(["joint_xi"], lambda x: -x)


def zeroed_under_load(run, chance):
    for name in FORCES:
        mean = sum(run.columns[name]) / len(run.columns[name])
        run.change([name], lambda x: x - mean)


def exchanged(run, chance):
    columns = run.columns
    columns["run_left"], columns["run_right"] = columns["run_right"], columns["run_left"]


def dead_channel(run, chance):
    run.change(["joint_eta"], lambda x: 0.013)


def spikes(run, chance):
    for name in FORCES:
        for k in chance.sample(range(len(run.columns[name])), 6):
            run.columns[name][k] = 9999.0


def trigger_elsewhere(run, chance):
    run.nominal("trigger_position", lambda x: x + 4.5)


def edge_in_each_lap(run, chance):
    """A second edge of the trigger 12 s after each."""
    trigger, time = run.columns["trigger"], run.columns["time"]
    late = round(12 / (time[1] - time[0]))
    for k in [k for k in range(1, len(trigger)) if trigger[k] > trigger[k - 1]]:
        trigger[k + late : k + late + 20] = [1.0] * len(trigger[k + late : k + late + 20])


def bouncing_photocell(run, chance):
    """The photocell closes once more 16 ms after it opened, for 12 ms."""
    trigger, time = run.columns["trigger"], run.columns["time"]
    step = time[1] - time[0]
    later, long = round(0.016 / step), round(0.012 / step)
    for k in [k for k in range(1, len(trigger)) if trigger[k] < trigger[k - 1]]:
        trigger[k + later : k + later + long] = [1.0] * len(trigger[k + later : k + later + long])


def hum(run, chance):
    """3 N at 50 Hz."""
    for name in FORCES:
        phase = chance.uniform(0, math.tau)
        swing = [3 * math.sin(math.tau * 50 * t + phase) for t in run.columns["time"]]
        run.columns[name] = [x + y for x, y in zip(run.columns[name], swing)]


def other_speed(run, chance):
    run.nominal("speed_setpoint", lambda x: 1.06 * x)


def other_low_pass(run, chance):
    run.nominal("lowpass", lambda x: 0.4 * x)


def other_cart(run, chance):
    run.nominal("sensor_cart", lambda x: x + 39)


def unix_time(run, chance):
    run.change(["time"], lambda x: x + 1.7e9)


def slow_clock(run, chance):
    run.change(["time"], lambda x: 1.002 * x)


def jitter(run, chance):
    run.change(["time"], lambda x: x + chance.uniform(-2e-4, 2e-4))


def half_the_rate(run, chance):
    run.keep(slice(None, None, 2))


def forces_late(run, chance):
    for name in FORCES:
        run.columns[name] = run.columns[name][:1] * 20 + run.columns[name][:-20]


def coarse(run, chance):
    run.change(FORCES, lambda x: 2 * round(x / 2))


def no_wheel_speeds(run, chance):
    run.columns = {name: column for name, column in run.columns.items() if not name.startswith("wheel_speed")}


def main(campaign, out):
    ways = [kilonewtons, reversed_tension, zeroed_under_load, exchanged, dead_channel, spikes, trigger_elsewhere, other_speed]
    ways += [edge_in_each_lap, bouncing_photocell, hum]
    ways += [other_low_pass, other_cart, unix_time, slow_clock, jitter, half_the_rate, forces_late, coarse, no_wheel_speeds]
    for way in ways:
        folder = out / way.__name__
        folder.mkdir(parents=True)
        chance = random.Random(5)
        for path in sorted(campaign.iterdir()):
            if path.suffix == ".csv":
                run = Record(path)
                way(run, chance)
                run.write(folder / path.name)
            elif path.suffix == ".lss" or path.name == "campaign.toml":
                shutil.copy(path, folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
