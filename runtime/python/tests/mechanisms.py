"""Mechanisms of the tests, as declarations and as a robot file."""

import linkwork

PENDULUM = """
/// A rod on a hinge, with a motor.
#[mechanism(gravity = -9.81 * y)]
pub struct Pendulum {
    pub mass: f64,
    pub length: f64,
    #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
    rod: Body,
    #[joint(ground -> rod, about = z)]
    hinge: Pin,
    #[acts(on = hinge)]
    motor: Torque,
}
"""
# A particle on a circle of radius 1 in the plane: a pendulum modelled by a constraint.
BEAD = """
#[mechanism(gravity = -9.81 * y)]
pub struct Bead {
    pub mass: f64,
    #[particle(mass = mass)]
    bead: Particle,
    #[joint(ground -> bead, along = (x, y))]
    plane: Stage,
    #[constraint(plane.x * plane.x + plane.y * plane.y = 1)]
    wire: Holonomic,
}
"""
# A mass on a spring whose potential energy is a table.
SLIDER = """
#[mechanism]
pub struct Slider {
    pub mass: f64,
    pub energy: Table<1>,
    #[particle(mass = mass)]
    block: Particle,
    #[joint(ground -> block, along = x)]
    rail: Sleeve,
    #[energy(energy(rail))]
    spring: Potential,
}
"""
BALL = """
#[mechanism(gravity = -9.81 * z)]
pub struct Bouncing {
    #[particle(mass = 1)]
    ball: Particle,
    #[joint(ground -> ball, along = z)]
    height: Sleeve,
    #[contact(ball, ground.plane(z), restitution = 0.5)]
    floor: Contact,
}
"""
# Two links and a tool.
ROBOT = """<robot name="two links">
  <link name="base"/>
  <link name="upper"><inertial><origin xyz="0 0 -0.5"/><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tool"/>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="50" velocity="3"/></joint>
  <joint name="flange" type="fixed"><parent link="upper"/><child link="tool"/><origin xyz="0 0 -1"/></joint>
</robot>"""


def compiled(declaration, **settings):
    return linkwork.compile(declaration, **settings)
