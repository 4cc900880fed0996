"""Models of published measurements: `python3 models.py CASE [PERCENT]` answers `lss gap diagnose`. Plain Python, no packages.

Each knows the linear part, or what the publication takes for granted; what it found besides is among the effects, beside others
that could be there. `accuracy` is PERCENT, 1 when not given, of the largest value of the compared channel, for all cases
alike. SI units.
"""
import math
import os
import sys
from bisect import bisect_left, bisect_right

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, os.path.join(HERE, "../../../python"))
from lss_model import effect, nuisance, serve  # noqa: E402


def sign(v, smooth):
    return math.tanh(v / smooth)


def rk4(rate, state, time, substeps):
    """States at each time; `rate(k, share, state)`, `share` of the way from the k-th sample to the next."""
    out = [state]
    for k, (begin, end) in enumerate(zip(time, time[1:])):
        h = (end - begin) / substeps
        for n in range(substeps):
            at = n / substeps
            half, whole = at + 0.5 / substeps, at + 1 / substeps
            a = rate(k, at, state)
            b = rate(k, half, tuple(s + h / 2 * x for s, x in zip(state, a)))
            c = rate(k, half, tuple(s + h / 2 * x for s, x in zip(state, b)))
            d = rate(k, whole, tuple(s + h * x for s, x in zip(state, c)))
            state = tuple(s + h / 6 * (p + 2 * q + 2 * r + w) for s, p, q, r, w in zip(state, a, b, c, d))
        out.append(state)
    return out


def lagged(time, values, lag):
    out = [values[0]]
    for (a, b), x in zip(zip(time, time[1:]), values[1:]):
        out.append(out[-1] + (x - out[-1]) * (1 - math.exp(-(b - a) / lag)) if lag > 0 else x)
    return out


def at(time, values, moment):
    """A value on the straight line between two samples, of evenly sampled values."""
    x = min(max((moment - time[0]) / (time[-1] - time[0]) * (len(time) - 1), 0), len(time) - 1.000001)
    k = int(x)
    return values[k] + (x - k) * (values[k + 1] - values[k])


# --- Silverbox: y'' = w^2 (g u - y - cubic y^3) - 2 d w y', u between samples on straight lines ------------------------


def silverbox(inputs, p):
    time, w = inputs["time"], 2 * math.pi * p["frequency"]
    u = [at(time, inputs["drive"], t - p["delay"]) for t in time]
    u = [x * (1 + p["drive_saturation.square"] * x * x) for x in u] + [0.0]

    def rate(k, share, s):
        y, v = s
        push = u[k] + share * (u[k + 1] - u[k])
        back = y + p["cubic.cubic"] * y**3 + p["quadratic.quadratic"] * y * y
        damped = 2 * p["damping"] / w * v * (1 + p["damping_grows.square"] * y * y)
        return v, w * w * (p["gain"] * push - back - damped) - p["coulomb.level"] * w * w * sign(v, 0.5)

    states = rk4(rate, (p["begin"], p["rise"]), time, 2)
    return {"output": [y + p["sensor_cubic.cubic"] * y**3 + p["sensor_offset.offset"] for y, _ in states]}


SILVERBOX = dict(
    simulate=silverbox,
    nuisances=[
        nuisance("frequency", 66, 55, 85, "Hz", shared=True),
        nuisance("damping", 0.04, 0.005, 0.2, shared=True),
        nuisance("gain", 1.0, 0.5, 2.0, shared=True),
        nuisance("delay", 0, -0.002, 0.002, "s", shared=True),
    ],
    effects=[
        effect("cubic", cubic=(0.2, -2, 20, "1/V2")),
        effect("quadratic", quadratic=(0.02, -2, 2, "1/V")),
        effect("damping_grows", square=(0.5, 0, 50, "1/V2")),
        effect("coulomb", level=(0.0005, 0, 0.05, "V")),
        effect("drive_saturation", square=(1, -50, 50, "1/V2")),
        effect("sensor_cubic", sensor=True, cubic=(0.1, -5, 5, "1/V2")),
        effect("sensor_offset", sensor=True, offset=(0.001, -0.05, 0.05, "V")),
    ],
)

# --- Cascaded tanks, levels in V: outflow as the root of the level and, less, in proportion to it (Rogers and others
# 2017, On a grey box modelling framework for nonlinear system identification); the upper level is not measured ----------


def tanks(inputs, p):
    time, pump = inputs["time"], inputs["pump"]

    def rate(k, share, s):
        a, b = max(s[0], 0.0), max(s[1], 0.0)
        over, lost, into = max(a - 10.0, 0.0), p["overflow.lost"], p["overflow.into_lower"]
        out = p["k3"] * math.sqrt(b) + p["k7"] * b + p["leak.rate"] * b * b + (lost + into) * max(b - 10.0, 0.0)
        pumped = p["k4"] * pump[k] * (1 + p["pump_fade.fade"] * k / 1000) * (1 + p["pump_curve.slope"] * pump[k])
        upper = pumped - p["k1"] * math.sqrt(a) - p["k5"] * a - (lost + into) * over - p["evaporation.rate"]
        return upper, p["k2"] * math.sqrt(a) + p["k6"] * a + into * over - max(out, 0.0) - p["evaporation.rate"]

    level = [max(b, 0.0) for _, b in rk4(rate, (p["upper"], p["lower"]), time, 2)]
    limit = p["sensor_limit.share"]
    return {"level": [b - limit * max(b - 10.0, 0.0) + p["sensor_offset.offset"] for b in level]}


TANKS = dict(
    simulate=tanks,
    nuisances=[
        nuisance("k1", 0.05, 0.0, 0.1, "V^0.5/s", shared=True),
        nuisance("k2", 0.05, 0.0, 0.1, "V^0.5/s", shared=True),
        nuisance("k3", 0.05, 0.0, 0.15, "V^0.5/s", shared=True),
        nuisance("k4", 0.04, 0.02, 0.08, "1/s", shared=True),
        nuisance("k5", 0, -0.02, 0.02, "1/s", shared=True),
        nuisance("k6", 0, -0.02, 0.02, "1/s", shared=True),
        nuisance("k7", 0, -0.02, 0.02, "1/s", shared=True),
        nuisance("upper", 5, 0, 10, "V"),
    ],
    effects=[
        effect("overflow", lost=(0.02, 0, 1, "1/s"), into_lower=(0.02, 0, 1, "1/s")),
        effect("leak", rate=(0.0001, 0, 0.005, "1/V/s")),
        effect("evaporation", rate=(0.0005, 0, 0.05, "V/s")),
        effect("pump_fade", fade=(0.02, -0.5, 0.5)),
        effect("pump_curve", slope=(0.005, -0.1, 0.1, "1/V")),
        effect("sensor_limit", sensor=True, share=(0.2, 0, 1)),
        effect("sensor_offset", sensor=True, offset=(0.02, -1, 1, "V")),
    ],
)

# --- Free pendulum: q'' = -(g/l) sin q - c q' - friction, from an extreme on -----------------------------------------


def pendulum(inputs, p):
    ratio, coulomb, drag = 9.81 / p["length"], p["coulomb.torque"], p["drag.quadratic"]
    viscous, spring = p["viscous"], p["spring.stiffness"]

    def rate(k, share, s):
        q, v = s
        return v, -ratio * math.sin(q) - viscous * v - coulomb * sign(v, 0.01) - drag * v * abs(v) - spring * q**3

    states = rk4(rate, (p["begin"] + p["begin_error"], p["begin_speed"]), inputs["time"], 3)
    angle = [(1 + p["sensor_gain.gain"]) * q + p["sensor_offset.offset"] for q, _ in states]
    return {"angle": lagged(inputs["time"], angle, p["sensor_lag.time"])}


def a_pendulum(length, viscous, most):
    return dict(
        simulate=pendulum,
        nuisances=[
            nuisance("length", length, 0.8 * length, 1.2 * length, "m", shared=True),
            nuisance("viscous", viscous, 0.0, most, "1/s", shared=True),
            nuisance("begin_error", 0, -0.05, 0.05, "rad"),
            nuisance("begin_speed", 0, -1, 1, "rad/s"),  # of the sample nearest to the extreme
        ],
        effects=[
            effect("coulomb", torque=(0.02, 0, 2, "rad/s2")),
            effect("drag", quadratic=(0.01, 0, 1, "1/rad")),
            effect("spring", stiffness=(0.2, -10, 10, "1/s2")),
            effect("sensor_gain", sensor=True, gain=(0.01, -0.2, 0.2)),
            effect("sensor_offset", sensor=True, offset=(0.005, -0.2, 0.2, "rad")),
            effect("sensor_lag", sensor=True, time=(0.005, 0, 0.2, "s")),
        ],
    )


# --- Falling balls: h'' = -9.81 + drag -------------------------------------------------------------------------------


def ball(inputs, p):
    time = inputs["time"]

    def rate(k, share, s):
        v = s[1]
        pull = -9.81 * (1 - p["buoyancy.share"]) - p["drag.quadratic"] * v * abs(v) - p["stokes.rate"] * v
        return v, pull - p["cubic_drag.cubic"] * v**3

    clock = 1 + p["clock.rate"]
    states = rk4(rate, (p["begin"] + p["begin_error"], p["speed"]), [clock * t for t in time], 2)
    return {"height": [h + p["sensor_scale.gain"] * (h - 30) for h, _ in states]}


BALL = dict(
    simulate=ball,
    nuisances=[nuisance("begin_error", 0, -0.5, 0.5, "m"), nuisance("speed", 0, -4, 4, "m/s")],
    effects=[
        effect("drag", quadratic=(0.002, 0, 0.2, "1/m")),
        effect("stokes", rate=(0.02, 0, 2, "1/s")),
        effect("cubic_drag", cubic=(0.0001, 0, 0.02, "s/m2")),
        effect("buoyancy", share=(0.01, 0, 0.05)),
        effect("clock", sensor=True, rate=(0.005, -0.02, 0.02)),
        effect("sensor_scale", sensor=True, gain=(0.01, -0.05, 0.05)),
    ],
)

# --- Steam heat exchanger: outlet temperature from the flow of the liquid, two lags and a dead time ------------------


def exchanger(inputs, p):
    time, flow = inputs["time"], inputs["flow"]
    slow, warm, said = flow[0] - 0.4, flow[0] - 0.4, []
    for k, t in enumerate(time):
        u = at(time, flow, t - p["dead_time"]) - 0.4
        step = 1.0 / 2
        for _ in range(2):
            lag = p["lag"] * (1 + p["lag_by_flow.slope"] * u)
            slow += step * (u + p["curve.square"] * u * u + p["curve3.cubic"] * u**3 - slow) / max(lag, 1.0)
            warm += step * (slow - warm) / p["second_lag"]
        now = p["level"] - p["gain"] * (1 + p["fouling.fade"] * t / 1000) * warm
        now += p["inlet_drift.rate"] * t / 1000
        y = now - p["level"]
        said.append(now + p["sensor_curve.square"] * y * y)
    return {"temperature": said}


EXCHANGER = dict(
    simulate=exchanger,
    nuisances=[
        nuisance("gain", 20, 2, 80, "K s/l", shared=True),
        nuisance("level", 97, 90, 104, "°C", shared=True),
        nuisance("lag", 20, 3, 80, "s", shared=True),
        nuisance("second_lag", 5, 1, 40, "s", shared=True),
        nuisance("dead_time", 3, 0, 20, "s", shared=True),
    ],
    effects=[
        effect("curve", square=(0.2, -5, 5, "s/l")),
        effect("curve3", cubic=(0.5, -20, 20, "s2/l2")),
        effect("lag_by_flow", slope=(0.1, -2, 2, "s/l")),
        effect("fouling", fade=(0.02, -0.3, 0.3)),
        effect("inlet_drift", rate=(0.1, -2, 2, "K/1000 s")),
        effect("sensor_curve", sensor=True, square=(0.01, -0.1, 0.1, "1/K")),
    ],
)

# --- Inverse models: force or torque from the measured motion, so that nothing drifts away ----------------------------


def delay(p):
    return p["delay"] if "delay" in p else p["delay.time"]


def inverse(channel, gravity, smooth, fades):
    def simulate(inputs, p):
        time = inputs["time"]
        first = max(0, bisect_left(time, p["from"]) - 1)
        last = min(len(time), bisect_right(time, p["to"] + delay(p)) + 1)
        said, force = [], []
        for k in range(first, last):
            q, v, a = inputs["position"][k], inputs["speed"][k], inputs["acceleration"][k]
            way = sign(v, smooth)
            f = p["inertia"] * a + p["viscous"] * (1 + p["friction_drift.rate"] * (time[k] - time[0])) * v + p["offset"]
            f += (p["gravity"] * math.sin(q) if gravity else 0) + p["spring.stiffness"] * q + p.get("asymmetric.coefficient", 0) * abs(v)
            f += (p["coulomb.level"] + p["stribeck.level"] * math.exp(-((v / fades) ** 2))) * way
            f += (p["quadratic_drag.coefficient"] + p["cubic_drag.coefficient"] * abs(v)) * abs(v) * v
            said.append(time[k] - delay(p))
            force.append(f * (1 - p["gain.relative"]))
        if said[-1] < p["to"]:
            said.append(p["to"])
            force.append(None)
        return {"time": said, channel: force}

    return simulate


DFKI = dict(
    simulate=inverse("torque", True, 0.05, 0.5),
    nuisances=[
        nuisance("inertia", 0.06, 0.03, 0.12, "kg m2", shared=True),
        nuisance("gravity", 1.0, 0.5, 2.0, "N m", shared=True),
        nuisance("viscous", 0.05, 0, 0.3, "N m s", shared=True),
        nuisance("offset", 0, -0.5, 0.5, "N m", shared=True),
    ],
    effects=[
        effect("coulomb", level=(0.05, 0, 2, "N m")),
        effect("stribeck", level=(0.05, 0, 2, "N m")),
        effect("quadratic_drag", coefficient=(0.002, -0.1, 0.1, "N m s2")),
        effect("cubic_drag", coefficient=(0.0002, -0.01, 0.01, "N m s3")),
        effect("spring", stiffness=(0.05, -1, 1, "N m")),
        effect("asymmetric", coefficient=(0.01, -0.2, 0.2, "N m s")),
        effect("friction_drift", rate=(0.05, -0.3, 1, "1/s")),
        effect("gain", relative=(0.02, -0.3, 0.3)),
        effect("delay", time=(0.002, 0, 0.05, "s")),
    ],
)

RACK = dict(
    simulate=inverse("force", False, 0.002, 0.02),
    nuisances=[
        nuisance("inertia", 24.7, 20, 30, "kg", shared=True),
        nuisance("viscous", 50, 0, 300, "N s/m", shared=True),
        nuisance("offset", 0, -10, 10, "N", shared=True),
        nuisance("delay", 0, -0.005, 0.005, "s", shared=True),  # two recorders, aligned by eye in the publication
    ],
    effects=[
        effect("coulomb", level=(2, 0, 100, "N")),
        effect("stribeck", level=(2, 0, 100, "N")),
        effect("quadratic_drag", coefficient=(10, -500, 500, "N s2/m2")),
        effect("cubic_drag", coefficient=(20, -1000, 1000, "N s3/m3")),
        effect("spring", stiffness=(20, -500, 500, "N/m")),
        effect("friction_drift", rate=(0.1, -2, 5, "1/s")),
        effect("gain", relative=(0.02, -0.3, 0.3)),
    ],
)

MODELS = {
    "silverbox": SILVERBOX,
    "tanks": TANKS,
    "wooden_bob": a_pendulum(0.36, 0.0004, 0.002),  # a string: only Stokes's drag, as the publication has it
    "skov_pendulum_1": a_pendulum(0.32, 0.05, 0.5),
    "skov_pendulum_2": a_pendulum(0.2, 0.05, 0.5),
    "exchanger": EXCHANGER,
    "basketballs": BALL,
    "whiffle_balls": BALL,
    "dfki_pendulum": DFKI,
    "rack_and_pinion": RACK,
}

# The largest value of the compared channel: of a force, torque or voltage from 0, of a motion from where it ends or began.
LARGEST = {
    "silverbox": ("output", 0.21),
    "tanks": ("level", 10),
    "wooden_bob": ("angle", 0.95),
    "skov_pendulum_1": ("angle", 2.6),
    "skov_pendulum_2": ("angle", 2.6),
    "exchanger": ("temperature", 10),
    "basketballs": ("height", 36),
    "whiffle_balls": ("height", 36),
    "dfki_pendulum": ("torque", 18),
    "rack_and_pinion": ("force", 150),
}

if __name__ == "__main__":
    channel, largest = LARGEST[sys.argv[1]]
    share = float(sys.argv[2]) if len(sys.argv) > 2 else 1.0
    serve(**MODELS[sys.argv[1]], accuracy={channel: largest * share / 100})
