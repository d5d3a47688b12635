"""Linkwork for Python: robots and mechanisms with native functions on NumPy arrays.

A robot file (URDF, MJCF, SDF) or the declaration of a mechanism becomes a class, in milliseconds and without a
compiler. Its methods are the functions that Linkwork derives, with the same names as in Rust:

>>> import linkwork
>>> Pendulum = linkwork.compile('''
...     #[mechanism(gravity = -9.81 * y)]
...     pub struct Pendulum {
...         pub mass: f64,
...         pub length: f64,
...         #[body(mass = mass, com = -length / 2 * y, inertia = rod(mass, length, y))]
...         rod: Body,
...         #[joint(ground -> rod, about = z)]
...         hinge: Pin,
...     }
... ''')
>>> pendulum = Pendulum(mass=2.0, length=1.5)
>>> round(float(pendulum.mass_matrix([0.0])[0, 0]), 12)
1.5

All quantities are in SI units, angles in radians.
"""

from ._load import compile, gallery
from ._mechanism import Mechanism
from ._names import Error, UnknownName
from ._results import LinearSystem, Page, Run

__all__ = ["Error", "LinearSystem", "Mechanism", "Page", "Run", "UnknownName", "compile", "gallery"]
__version__ = "0.1.0"
