"""A pendulum in MuJoCo as a model: `python3 -m lss_model mujoco_pendulum.py`, with `pip install mujoco ./python`.

A mass of 0.4 kg on a rod of about 0.5 m without mass, let go at the angle `begin` (a setting of the run, rad). The model's
joint has viscous damping; dry friction (MuJoCo's frictionloss), a torsion spring and a sensor offset are effects.
"""
import mujoco

from lss_model import effect, nuisance

XML = """
<mujoco>
  <option timestep="0.002" integrator="implicitfast"/>
  <worldbody><body>
    <joint name="hinge" type="hinge" axis="0 1 0" damping="0" frictionloss="0" stiffness="0"/>
    <geom type="sphere" size="0.02" mass="0.4" pos="0 0 -0.5"/>
  </body></worldbody>
  <sensor><jointpos joint="hinge"/></sensor>
</mujoco>
"""

NUISANCES = [
    nuisance("damping", 0.005, 0, 0.05, "N m s/rad", shared=True),
    nuisance("length", 0.5, 0.45, 0.55, "m", shared=True),
]
EFFECTS = [
    effect("dry_friction", torque=(0.002, 0, 0.2, "N m")),
    effect("torsion_spring", stiffness=(0.02, -0.5, 0.5, "N m/rad")),
    effect("sensor_offset", sensor=True, offset=(0.005, -0.2, 0.2, "rad")),
]
ACCURACY = {"angle": 0.003}

model = mujoco.MjModel.from_xml_string(XML)
data = mujoco.MjData(model)


def simulate(inputs, p):
    mujoco.mj_resetData(model, data)
    model.body_ipos[1] = (0, 0, -p["length"])
    model.dof_damping[0] = p["damping"]
    model.dof_frictionloss[0] = p["dry_friction.torque"]
    model.jnt_stiffness[0] = p["torsion_spring.stiffness"]
    data.qpos[0] = p["begin"]
    mujoco.mj_setConst(model, mujoco.MjData(model))
    mujoco.mj_forward(model, data)
    angle = []
    for t in inputs["time"]:
        while data.time < t - 1e-9:
            mujoco.mj_step(model, data)
        angle.append(data.qpos[0] + p["sensor_offset.offset"])
    return {"angle": angle}
