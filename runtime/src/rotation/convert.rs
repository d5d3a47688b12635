//! Conversions between the rotation parameters, through the Euler parameters.

use super::euler_parameters::quaternion_of_rotation;
use super::{Gibbs, Mrp, RotationVector, Singular};
use crate::Real;
use nalgebra::{Rotation3, UnitQuaternion};

macro_rules! conversions {
    ($($from:ident => $($to:ident),+;)+) => {$($(
        impl<T: Real> From<$from<T>> for $to<T> {
            fn from(from: $from<T>) -> Self {
                Self::from_quaternion(&from.quaternion())
            }
        }
    )+)+};
}

conversions! {
    RotationVector => Mrp;
    Gibbs => RotationVector, Mrp;
    Mrp => RotationVector;
}

macro_rules! to_nalgebra {
    ($($from:ident)+) => {$(
        impl<T: Real> From<$from<T>> for UnitQuaternion<T> {
            fn from(from: $from<T>) -> Self {
                from.quaternion()
            }
        }

        impl<T: Real> From<$from<T>> for Rotation3<T> {
            fn from(from: $from<T>) -> Self {
                from.rotation()
            }
        }
    )+};
}

to_nalgebra!(RotationVector Gibbs Mrp);

macro_rules! from_nalgebra {
    ($($to:ident)+) => {$(
        impl<T: Real> From<UnitQuaternion<T>> for $to<T> {
            fn from(from: UnitQuaternion<T>) -> Self {
                Self::from_quaternion(&from)
            }
        }

        impl<T: Real> From<Rotation3<T>> for $to<T> {
            fn from(from: Rotation3<T>) -> Self {
                Self::from_quaternion(&quaternion_of_rotation(&from))
            }
        }
    )+};
}

from_nalgebra!(RotationVector Mrp);

macro_rules! to_gibbs {
    ($($from:ty),+) => {$(
        impl<T: Real> TryFrom<$from> for Gibbs<T> {
            type Error = Singular;

            fn try_from(from: $from) -> Result<Self, Singular> {
                Self::from_quaternion(&from.into())
            }
        }
    )+};
}

to_gibbs!(RotationVector<T>, Mrp<T>, UnitQuaternion<T>);

impl<T: Real> TryFrom<Rotation3<T>> for Gibbs<T> {
    type Error = Singular;

    fn try_from(from: Rotation3<T>) -> Result<Self, Singular> {
        Self::from_rotation(&from)
    }
}
