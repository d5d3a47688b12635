//! Parameters of links and joints in robot files.

use crate::Real;
use crate::private::constant;

/// Mass properties of a link, as in URDF files: the field of a link in a mechanism with `parameters =
/// inertial("link")` (see [robots](crate::guide::robots#figures-as-parameters)).
///
/// ```
/// use linkwork::Inertial;
///
/// // A ball of mass 2 kg and radius 0.1 m at a height of 0.5 m, with a point mass of 0.5 kg on top.
/// let i = 0.4 * 2.0 * 0.01;
/// let ball = Inertial { mass: 2.0, com: [0.0, 0.0, 0.5], ixx: i, ixy: 0.0, ixz: 0.0, iyy: i, iyz: 0.0, izz: i };
/// let both = ball.plus(&Inertial::point(0.5, [0.0, 0.0, 0.6]));
/// assert_eq!(both.mass, 2.5);
/// assert!((both.com[2] - 0.52_f64).abs() < 1e-15);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Inertial<T> {
    /// Mass of the link, kg.
    pub mass: T,
    /// Position of the centre of mass relative to the link's origin, in the link's axes, m.
    pub com: [T; 3],
    /// Entry xx of the inertia about the centre of mass, in the link's axes, kg·m². An inertia that a file
    /// gives in other axes has been rotated.
    pub ixx: T,
    /// Entry xy of the inertia about the centre of mass, kg·m²: a product of inertia with the sign of the
    /// matrix entry.
    pub ixy: T,
    /// Entry xz of the inertia about the centre of mass, kg·m².
    pub ixz: T,
    /// Entry yy of the inertia about the centre of mass, kg·m².
    pub iyy: T,
    /// Entry yz of the inertia about the centre of mass, kg·m².
    pub iyz: T,
    /// Entry zz of the inertia about the centre of mass, kg·m².
    pub izz: T,
}

impl<T: Real> Inertial<T> {
    /// Returns a point mass of `mass` (kg) at `com` (m).
    #[must_use]
    pub fn point(mass: T, com: [T; 3]) -> Self {
        let o = T::zero();
        Inertial { mass, com, ixx: o, ixy: o, ixz: o, iyy: o, iyz: o, izz: o }
    }

    /// Returns the ten standard parameters, in which the dynamics are linear: the mass (kg), the first
    /// moments `m c` (x, y, z; kg·m), and the inertia about the link's origin (xx, xy, yy, xz, yz, zz;
    /// kg·m²), in the order of `standard_parameters`.
    #[must_use]
    pub fn to_standard(&self) -> [T; 10] {
        let Inertial { mass: m, com: [x, y, z], ixx, ixy, ixz, iyy, iyz, izz } = *self;
        let (h, k) = (m * x, m * y);
        let (xx, yy, zz) = (h * x, k * y, m * z * z);
        [m, h, k, m * z, ixx + yy + zz, ixy - h * y, iyy + xx + zz, ixz - h * z, iyz - k * z, izz + xx + yy]
    }

    /// Returns the mass properties with these ten standard parameters. For zero mass, the centre of mass is
    /// the origin.
    #[must_use]
    pub fn from_standard([m, hx, hy, hz, xx, xy, yy, xz, yz, zz]: [T; 10]) -> Self {
        let divisor = if m == T::zero() { T::one() } else { m };
        let [x, y, z] = [hx / divisor, hy / divisor, hz / divisor];
        let (sx, sy, sz) = (hx * x, hy * y, hz * z);
        Inertial {
            mass: m,
            com: [x, y, z],
            ixx: xx - sy - sz,
            ixy: xy + hx * y,
            ixz: xz + hx * z,
            iyy: yy - sx - sz,
            iyz: yz + hy * z,
            izz: zz - sx - sy,
        }
    }

    /// Returns the combined mass properties of two rigidly connected bodies, such as a link and its payload.
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        let (a, b) = (self.to_standard(), other.to_standard());
        Self::from_standard(core::array::from_fn(|k| a[k] + b[k]))
    }

    /// Returns the mass properties with the density multiplied by `factor`: mass and inertia change, the
    /// centre of mass does not.
    #[must_use]
    pub fn scaled(&self, factor: T) -> Self {
        let Inertial { mass, com, ixx, ixy, ixz, iyy, iyz, izz } = *self;
        Inertial {
            mass: mass * factor,
            com,
            ixx: ixx * factor,
            ixy: ixy * factor,
            ixz: ixz * factor,
            iyy: iyy * factor,
            iyz: iyz * factor,
            izz: izz * factor,
        }
    }

    /// Returns the same values in another scalar type, for example SIMD lanes.
    #[must_use]
    pub fn cast<U: Real>(&self) -> Inertial<U>
    where
        T: Into<f64>,
    {
        let convert_number = |x: T| constant::<U>(x.into());
        let Inertial { mass, com, ixx, ixy, ixz, iyy, iyz, izz } = *self;
        Inertial {
            mass: convert_number(mass),
            com: com.map(convert_number),
            ixx: convert_number(ixx),
            ixy: convert_number(ixy),
            ixz: convert_number(ixz),
            iyy: convert_number(iyy),
            iyz: convert_number(iyz),
            izz: convert_number(izz),
        }
    }
}

/// Pose of a joint on its parent link, as in URDF files: the field `joint_placement` of a joint in a
/// mechanism with `parameters = placement("joint")`, for calibration.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Placement<T> {
    /// Position of the joint on its parent link, m.
    pub xyz: [T; 3],
    /// Roll, pitch and yaw, rad: rotations about the parent's x, y and z axes, in this order.
    pub rpy: [T; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_parameters_convert_back() {
        let body = Inertial::<f64> {
            mass: 2.0,
            com: [0.1, -0.2, 0.3],
            ixx: 0.3,
            ixy: 0.01,
            ixz: -0.02,
            iyy: 0.4,
            iyz: 0.03,
            izz: 0.5,
        };
        let ten = body.to_standard();
        // Parallel axis theorem (Huygens and Steiner): m (y² + z²) and −m x y.
        assert!((ten[4] - (0.3 + 2.0 * 0.13)).abs() < 1e-15);
        assert!((ten[5] - (0.01 + 2.0 * 0.02)).abs() < 1e-15);
        let back = Inertial::from_standard(ten).to_standard();
        assert!(ten.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-15));
        let halves = body.scaled(0.5).plus(&body.scaled(0.5));
        assert!((halves.iyz - body.iyz).abs() < 1e-15 && (halves.mass - 2.0).abs() < 1e-15);
        assert_eq!(Inertial::from_standard([0.0; 10]), Inertial::point(0.0, [0.0; 3]));
    }
}
