"""Models of the benchmark: `python3 models.py CASE` answers `lss gap diagnose`. Plain Python, a Runge-Kutta step of its
own; the measurements come from `measure.py`, by another integrator, with more in them than the model knows.

SI units throughout. Signs of friction are smoothed over a small velocity, as a fixed step needs it.
"""
import math
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../python"))
from lss_model import effect, nuisance, serve  # noqa: E402


def rk4(rate, state, time, substeps=2):
    """States at each time; `rate(k, state)` is a tuple, with the inputs of the k-th sample held to the next."""
    out = [state]
    for k, (begin, end) in enumerate(zip(time, time[1:])):
        h = (end - begin) / substeps
        for _ in range(substeps):
            a = rate(k, state)
            b = rate(k, tuple(s + h / 2 * x for s, x in zip(state, a)))
            c = rate(k, tuple(s + h / 2 * x for s, x in zip(state, b)))
            d = rate(k, tuple(s + h * x for s, x in zip(state, c)))
            state = tuple(s + h / 6 * (p + 2 * q + 2 * r + w) for s, p, q, r, w in zip(state, a, b, c, d))
        out.append(state)
    return out


def lagged(time, values, lag):
    if lag <= 0:
        return values
    out = [values[0]]
    for (a, b), x in zip(zip(time, time[1:]), values[1:]):
        out.append(out[-1] + (x - out[-1]) * (1 - math.exp(-(b - a) / lag)))
    return out


def sign(v, smooth):
    return math.tanh(v / smooth)


# --- pendulum: q'' = -(g/l) sin q - c q' - friction --------------------------------------------------------------------

def pendulum(inputs, p):
    ratio, coulomb, drag = 9.81 / p["length"], p["coulomb.torque"], p["drag.quadratic"]
    spring = p["spring.stiffness"]

    def rate(k, s):
        q, v = s
        return v, -ratio * math.sin(q) - p["viscous"] * v - coulomb * sign(v, 0.01) - drag * v * abs(v) - spring * q**3

    states = rk4(rate, (p["begin"], 0.0), inputs["time"])
    angle = [(1 + p["sensor_gain.gain"]) * q + p["sensor_offset.offset"] for q, _ in states]
    return {"angle": lagged(inputs["time"], angle, p["sensor_lag.time"])}


PENDULUM = dict(
    simulate=pendulum,
    nuisances=[nuisance("length", 0.5, 0.4, 0.6, "m"), nuisance("viscous", 0.05, 0.0, 0.5, "1/s")],
    effects=[
        effect("coulomb", torque=(0.02, 0, 2, "rad/s2")),
        effect("drag", quadratic=(0.01, 0, 1, "1/rad")),
        effect("spring", stiffness=(0.2, -10, 10, "1/s2")),
        effect("sensor_gain", sensor=True, gain=(0.01, -0.2, 0.2)),
        effect("sensor_offset", sensor=True, offset=(0.005, -0.2, 0.2, "rad")),
        effect("sensor_lag", sensor=True, time=(0.005, 0, 0.2, "s")),
    ],
    accuracy={"angle": 0.002},
)

# --- cart on a rail, driven by a force: m x'' = u - c x' - friction - slope -------------------------------------------

def cart(inputs, p):
    force = inputs["force"]

    def rate(k, s):
        x, v = s
        push = force[k] * (1 + p["motor_gain.gain"]) - p["viscous"] * v
        push -= p["coulomb.force"] * sign(v, 0.002) + p["drag.quadratic"] * v * abs(v) + p["spring.stiffness"] * x
        return v, push / p["mass"] + p["slope.slope"] * 9.81

    states = rk4(rate, (0.0, 0.0), inputs["time"])
    return {
        "position": lagged(inputs["time"], [x for x, _ in states], p["sensor_lag.time"]),
        "speed": [v for _, v in states],
    }


CART = dict(
    simulate=cart,
    nuisances=[nuisance("mass", 1.0, 0.5, 2.0, "kg"), nuisance("viscous", 1.0, 0.0, 10.0, "N s/m")],
    effects=[
        effect("coulomb", force=(0.02, 0, 2, "N")),
        effect("drag", quadratic=(0.1, 0, 20, "N s2/m2")),
        effect("spring", stiffness=(0.1, -5, 20, "N/m")),
        effect("slope", slope=(0.001, -0.1, 0.1)),
        effect("motor_gain", gain=(0.02, -0.3, 0.3)),
        effect("sensor_lag", sensor=True, time=(0.01, 0, 0.5, "s")),
    ],
    accuracy={"position": 0.002, "speed": 0.002},
)

# --- Silverbox: an electronic Duffing oscillator, in volts ------------------------------------------------------------

def silverbox(inputs, p):
    u = inputs["drive"]
    w = 2 * math.pi * p["frequency"]

    def rate(k, s):
        y, v = s
        back = y + p["cubic.cubic"] * y**3 + p["quadratic.quadratic"] * y * y
        damped = 2 * p["damping"] / w * v * (1 + p["damping_grows.square"] * y * y)
        return v, w * w * (p["gain"] * u[k] - back - damped) - p["coulomb.level"] * w * w * sign(v, 0.5)

    states = rk4(rate, (0.0, 0.0), inputs["time"])
    return {"output": [(1 + p["sensor_gain.gain"]) * y + p["sensor_offset.offset"] for y, _ in states]}


SILVERBOX = dict(
    simulate=silverbox,
    nuisances=[
        nuisance("frequency", 66, 55, 85, "Hz"),
        nuisance("damping", 0.04, 0.005, 0.2),
        nuisance("gain", 1.0, 0.5, 2.0),
    ],
    effects=[
        effect("cubic", cubic=(0.2, -2, 20, "1/V2")),
        effect("quadratic", quadratic=(0.02, -2, 2, "1/V")),
        effect("damping_grows", square=(0.5, 0, 50, "1/V2")),
        effect("coulomb", level=(0.0005, 0, 0.05, "V")),
        effect("sensor_gain", sensor=True, gain=(0.01, -0.2, 0.2)),
        effect("sensor_offset", sensor=True, offset=(0.001, -0.05, 0.05, "V")),
    ],
    accuracy={"output": 0.0002},
)

# --- bolted joint: softens and damps with amplitude, x in mm ----------------------------------------------------------

def bolted(inputs, p):
    u = inputs["force"]
    w = 2 * math.pi * p["frequency"]

    def rate(k, s):
        x, v = s
        stiff = 1 - p["softening.slope"] * math.sqrt(x * x + 1e-6) + p["hardening.cubic"] * x * x
        damping = p["damping"] * (1 + p["amplitude_damping.slope"] * math.sqrt(x * x + (v / w) ** 2 + 1e-6))
        pushed = w * w * p["gain"] * u[k] - w * w * p["coulomb.level"] * sign(v, 1.0)
        return v, pushed - w * w * stiff * x - 2 * damping * w * v

    states = rk4(rate, (0.0, 0.0), inputs["time"])
    return {"displacement": [(1 + p["sensor_gain.gain"]) * x for x, _ in states]}


BOLTED = dict(
    simulate=bolted,
    nuisances=[
        nuisance("frequency", 20.5, 17, 24, "Hz"),
        nuisance("damping", 0.01, 0.001, 0.1),
        nuisance("gain", 1.0, 0.5, 2.0),
    ],
    effects=[
        effect("softening", slope=(0.01, 0, 0.4, "1/mm")),
        effect("hardening", cubic=(0.01, 0, 0.5, "1/mm2")),
        effect("amplitude_damping", slope=(0.2, 0, 20, "1/mm")),
        effect("coulomb", level=(0.001, 0, 0.2, "mm")),
        effect("sensor_gain", sensor=True, gain=(0.01, -0.2, 0.2)),
    ],
    accuracy={"displacement": 0.003},
)

# --- cascaded tanks (Schoukens and others 2016), levels in V ----------------------------------------------------------

def tanks(inputs, p):
    u = inputs["pump"]

    def rate(k, s):
        a, b = max(s[0], 0.0), max(s[1], 0.0)
        over = p["overflow.rate"] * max(a - 10.0, 0.0)
        flow = p["k1"] * math.sqrt(a)
        leak = p["leak.rate"] * b
        evaporates = p["evaporation.rate"]
        return (
            p["k4"] * u[k] * (1 + p["pump_fade.fade"] * k / 1000) - flow - over - evaporates,
            flow + p["splash.share"] * over - p["k3"] * math.sqrt(b) - leak - evaporates,
        )

    states = rk4(rate, (p["upper"], p["lower"]), inputs["time"], 4)
    return {"level": [b + p["sensor_offset.offset"] for _, b in states]}


TANKS = dict(
    simulate=tanks,
    nuisances=[
        nuisance("k1", 0.05, 0.02, 0.1, "V^0.5/s"),
        nuisance("k3", 0.05, 0.02, 0.1, "V^0.5/s"),
        nuisance("k4", 0.04, 0.02, 0.08, "1/s"),
    ],
    effects=[
        effect("overflow", rate=(0.02, 0, 1, "1/s")),
        effect("leak", rate=(0.0005, 0, 0.05, "1/s")),
        effect("evaporation", rate=(0.0005, 0, 0.05, "V/s")),
        effect("pump_fade", fade=(0.02, -0.5, 0.5)),
        effect("splash", share=(0.1, 0, 1)),
        effect("sensor_offset", sensor=True, offset=(0.02, -1, 1, "V")),
    ],
    accuracy={"level": 0.03},
)

# --- mass on a spring, shaken: sensor faults, nothing, or something unknown -------------------------------------------

def spring(inputs, p):
    u = inputs["force"]

    def rate(k, s):
        x, v = s
        push = u[k] - p["stiffness"] * x - p["viscous"] * v - p["coulomb.force"] * sign(v, 0.002)
        return v, (push - p["cubic.cubic"] * x**3 - p["drag.quadratic"] * v * abs(v)) / p["mass"]

    states = rk4(rate, (0.0, 0.0), inputs["time"])
    x = [(1 + p["sensor_gain.gain"]) * x + p["sensor_offset.offset"] for x, _ in states]
    return {"position": lagged(inputs["time"], x, p["sensor_lag.time"])}


SPRING = dict(
    simulate=spring,
    nuisances=[
        nuisance("mass", 1.0, 0.7, 1.5, "kg"),
        nuisance("stiffness", 100, 60, 150, "N/m"),
        nuisance("viscous", 0.5, 0.0, 5.0, "N s/m"),
    ],
    effects=[
        effect("coulomb", force=(0.02, 0, 2, "N")),
        effect("cubic", cubic=(100, -4e3, 4e4, "N/m3")),
        effect("drag", quadratic=(0.2, 0, 40, "N s2/m2")),
        effect("sensor_gain", sensor=True, gain=(0.01, -0.3, 0.3)),
        effect("sensor_offset", sensor=True, offset=(0.001, -0.05, 0.05, "m")),
        effect("sensor_lag", sensor=True, time=(0.002, 0, 0.2, "s")),
    ],
    accuracy={"position": 0.0005},
)

MODELS = {
    "pendulum_coulomb": PENDULUM, "pendulum_drag": PENDULUM, "pendulum_both": PENDULUM, "pendulum_dashpot": PENDULUM,
    "pendulum_wear": PENDULUM,
    "cart_rail": CART, "silverbox": SILVERBOX, "bolted_joint": BOLTED, "tanks": TANKS,
    "spring_lag": SPRING, "spring_right": SPRING, "spring_unknown": SPRING,
}

if __name__ == "__main__":
    serve(**MODELS[sys.argv[1]])
