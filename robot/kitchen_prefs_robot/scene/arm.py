"""The arm and its gripper: position servos with the real arm's force limits."""

import mujoco

from kitchen_prefs_robot.scene.assets import arm_spec

ARM_JOINTS = tuple(f"joint{number}" for number in range(1, 8))
ARM_BODY = "link0"  # at the origin of the base's frame
PINCH = "pinch"  # the site between the fingertips: z points out of the hand, y from pad to pad
GRIPPER = "fingers_actuator"
FINGER = "right_driver_joint"
OPEN, CLOSED = 0.0, 255.0  # the gripper's controls
# Radians, the hand over the counter's near edge, out of the cameras' view of the dishes.
HOME = (0.0, -1.10, 0.0, -2.50, 0.0, 1.40, 0.785)

# N m a rad, N m s a rad: as stiff as the real arm's joint impedance allows, and critically damped.
GAINS = ((4500, 450), (4500, 450), (3500, 350), (3500, 350), (2000, 200), (2000, 200), (2000, 200))


def arm_and_gripper() -> mujoco.MjSpec:
    """A specification with the arm at the origin, driven by `data.ctrl`.

    Controls 0 to 6 are the joints' targets in radians, 7 is the gripper's, from `OPEN` to `CLOSED`.
    The arm carries its own weight, as the real one's controller does; it does not know the weight
    of what it holds.
    """
    spec = arm_spec()
    for body in spec.bodies[1:]:  # the first is the world
        body.gravcomp = 1.0
    for number, (stiffness, damping) in enumerate(GAINS, start=1):
        servo = spec.actuator(f"actuator{number}")
        limit = servo.ctrlrange[1]  # the motor's, N m
        servo.set_to_position(kp=stiffness, kv=damping)
        servo.forcelimited, servo.forcerange = True, (-limit, limit)
        servo.ctrllimited, servo.ctrlrange = True, spec.joint(f"joint{number}").range
    for camera in list(spec.cameras):
        spec.delete(camera)  # the paper's cameras stand beside the table
    return spec


def arm_kinematics() -> mujoco.MjSpec:
    """The arm alone, with its seven joints and a rigid hand, for inverse kinematics."""
    spec = arm_spec()
    for part in (*spec.actuators, *spec.sensors, *spec.equalities, *spec.tendons):
        spec.delete(part)
    for joint in spec.joints:
        if joint.name not in ARM_JOINTS:
            spec.delete(joint)
    return spec
