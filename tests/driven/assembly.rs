//! Assembly from partial guesses: the result is within half a turn of the guess, in the nearest or in the
//! requested assembly mode.

use super::jansen;
use linkwork::prelude::*;
use std::f64::consts::PI;
use support::random::Random;

/// Declares a planar four-bar linkage with the given additional fields.
macro_rules! four_bar {
    ($(#[$about:meta])* $visibility:vis $name:ident, { $($more:tt)* }) => {
        $(#[$about])*
        #[mechanism(gravity = -9.81 * y)]
        $visibility struct $name {
            $visibility base: f64,
            $visibility first: f64,
            $visibility second: f64,
            $visibility third: f64,
            #[body(mass = 1, com = first / 3 * x, inertia = rod(1, first, x))]
            crank: Body,
            #[body(mass = 1.5, com = second / 2 * x + 0.1 * y, inertia = rod(1.5, second, x))]
            coupler: Body,
            #[body(mass = 0.8, com = third / 2 * x, inertia = rod(0.8, third, x))]
            rocker: Body,
            #[joint(ground -> crank, about = z)]
            shaft: Pin,
            #[joint(crank.at(first * x) -> coupler, about = z)]
            knee: Pin,
            #[joint(ground.at(base * x) -> rocker, about = z)]
            pivot: Pin,
            #[joint(coupler.at(second * x) -> rocker.at(third * x), about = z)]
            last: Pin,
            $($more)*
        }
    };
}
pub(super) use four_bar;

four_bar!(pub FourBar, {});

impl FourBar {
    /// Returns the joint angles of the linkage for a crank angle and an assembly mode `side`.
    pub fn joint_angles(&self, side: f64, angle: f64) -> SVector<f64, 3> {
        let bars = [self.base, self.first, self.second, self.third];
        let [pin, end] = linkage_corners(bars, side, angle);
        let coupler = (end[1] - pin[1]).atan2(end[0] - pin[0]);
        [angle, wrapped_angle(coupler - angle), end[1].atan2(end[0] - self.base)].into()
    }
}

/// Returns the pin of the crank and the end of the coupler of a four-bar linkage, by intersection of circles.
pub fn linkage_corners([base, first, second, third]: [f64; 4], side: f64, angle: f64) -> [[f64; 2]; 2] {
    let pin = [first * angle.cos(), first * angle.sin()];
    [pin, jansen::triangle_corner_from_sides(pin, [base, 0.0], second, third, side)]
}

/// Returns the bar lengths, the assembly mode and the crank angle of a random four-bar linkage. The sine of
/// the transmission angle is at least `least`.
pub fn random_linkage(source: &mut Random, least: f64) -> ([f64; 4], f64, f64) {
    loop {
        let bars = [(); 4].map(|()| 0.6 + source.uniform_number(0.4));
        let side = if source.uniform_number(1.0) < 0.0 { -1.0 } else { 1.0 };
        let angle = source.uniform_number(PI);
        let pin = [bars[1] * angle.cos(), bars[1] * angle.sin()];
        let square = (pin[0] - bars[0]).powi(2) + pin[1].powi(2);
        let cosine = (bars[2] * bars[2] + bars[3] * bars[3] - square) / (2.0 * bars[2] * bars[3]);
        if 1.0 - cosine * cosine > least * least && square > 0.01 {
            return (bars, side, angle);
        }
    }
}

fn wrapped_angle(angle: f64) -> f64 {
    angle.sin().atan2(angle.cos())
}

/// Returns the largest difference of joint angles, modulo whole turns.
fn largest_angle_difference(a: &SVector<f64, 3>, b: &SVector<f64, 3>) -> f64 {
    (a - b).iter().fold(0.0, |most, off| most.max(wrapped_angle(*off).abs()))
}

/// Checks that assembly from a guess of the crank angle alone, with or without additional turns, yields one
/// of the two intersections of circles, within half a turn of the guess.
#[test]
fn partial_guesses_assemble_within_half_a_revolution() {
    let mut source = Random::new(5);
    for case in 0..1000 {
        let (bars, side, angle) = random_linkage(&mut source, 0.02);
        let m = FourBar { base: bars[0], first: bars[1], second: bars[2], third: bars[3] };
        let turns = 6.0 * PI * f64::from(case % 3);
        let guess = [angle + turns, if case % 2 == 0 { 0.0 } else { source.uniform_number(9.0) }, 0.0].into();
        let q = m.assemble(&guess, &[0]).unwrap_or_else(|error| panic!("{bars:?}, {guess}: {error}"));
        assert!(m.constraint_residuals(&q).amax() < 1e-12 && q[0] == guess[0]);
        assert!((q - guess).amax() <= PI + 1e-12, "{bars:?}: from {guess} to {q}");
        let ways = [side, -side].map(|side| m.joint_angles(side, angle));
        let modes = ways.map(|way| m.assembly_mode(&way, &[0]).unwrap());
        assert_eq!(modes[0], -modes[1]);
        let found = m.assembly_mode(&q, &[0]).unwrap();
        let own = usize::from(found != modes[0]);
        assert!(largest_angle_difference(&q, &ways[own]) < 1e-9, "{bars:?}: {q}");
        // The same guess leads to the other mode if it is requested.
        let other = m.assemble_in_mode(&guess, &[0], -found).unwrap();
        assert!(
            largest_angle_difference(&other, &ways[1 - own]) < 1e-9 && (other - guess).amax() <= PI + 1e-12
        );
        assert_eq!(m.assemble_in_mode(&guess, &[0], found), Ok(q));
    }
}

/// Davidenko's homotopy reduces the residuals of a guess linearly to zero, in small steps. Its end equals the
/// result of the assembly, unless the assembly finds a nearer configuration.
#[test]
fn homotopy_reaches_the_assembly_mode_of_the_guess() {
    let mut source = Random::new(6);
    let mut same = 0;
    for _ in 0..1000 {
        let (bars, side, angle) = random_linkage(&mut source, 0.1);
        let m = FourBar { base: bars[0], first: bars[1], second: bars[2], third: bars[3] };
        let near = 0.6;
        let guess: SVector<f64, 3> = m.joint_angles(side, angle)
            + SVector::from([0.0, source.uniform_number(near), source.uniform_number(near)]);
        let Some(way) = follow_homotopy(&m, guess) else { continue };
        let q = m.assemble(&guess, &[0]).unwrap();
        if (q - way).amax() < 1e-6 {
            same += 1;
        } else {
            let (found, other) = ((q - guess).norm(), (way - guess).norm());
            assert!(found < other, "{bars:?}: from {guess} to {q}, not {way}");
        }
    }
    assert!(same > 800, "{same}");
}

/// Returns the end of the homotopy, or `None` if its path comes near a singular configuration.
fn follow_homotopy(m: &FourBar, guess: SVector<f64, 3>) -> Option<SVector<f64, 3>> {
    let (mut q, mode) = (guess, m.assembly_mode(&guess, &[0]));
    let start = m.constraint_residuals(&q);
    for step in 1..=400 {
        let aim = start * (1.0 - f64::from(step) / 400.0);
        for _ in 0..3 {
            let (j, gap) = (m.constraint_jacobian(&q), m.constraint_residuals(&q) - aim);
            let determinant = j[(0, 1)] * j[(1, 2)] - j[(0, 2)] * j[(1, 1)];
            if determinant.abs() < 0.03 {
                return None;
            }
            q[1] -= (j[(1, 2)] * gap[0] - j[(0, 2)] * gap[1]) / determinant;
            q[2] -= (j[(0, 1)] * gap[1] - j[(1, 1)] * gap[0]) / determinant;
        }
    }
    (m.assembly_mode(&q, &[0]) == mode).then_some(q)
}

#[mechanism]
struct Gears {
    #[body(mass = 1, inertia = disk(1, 0.4, z))]
    large: Body,
    #[body(mass = 1, inertia = disk(1, 0.1, z))]
    small: Body,
    #[joint(ground -> large, about = z)]
    slow: Pin,
    #[joint(ground.at(0.5 * x) -> small, about = z)]
    quick: Pin,
    #[constraint(quick = -4 * slow)]
    mesh: Holonomic,
}

/// Gears rotate by more than half a turn if necessary; an assembly mode that does not exist is an error.
#[test]
fn assembled_gears_rotate_as_far_as_necessary() {
    let gears = Gears {};
    let q = gears.assemble(&[3.0, 0.0].into(), &[0]).unwrap();
    assert!((q[1] + 12.0).abs() < 1e-12 && q[0] == 3.0);
    let mode = gears.assembly_mode(&q, &[0]).unwrap();
    assert_eq!(gears.assemble_in_mode(&q, &[0], -mode), Err(ConstraintError::Mode { mode: -mode }));
    assert_eq!(gears.assembly_mode(&q, &[]), None);
}

/// Checks that the assembly mode is undefined where all bars of a parallelogram are in line, because the two
/// modes coincide there.
#[test]
fn singular_configurations_have_no_assembly_mode() {
    let m = FourBar { base: 1.0, first: 0.5, second: 1.0, third: 0.5 };
    assert_eq!(m.assembly_mode(&[0.0, 0.0, 0.0].into(), &[0]), None);
    let (open, crossed) = (m.joint_angles(1.0, 0.8), m.joint_angles(-1.0, 0.8));
    assert!(open[1] + 0.8 < 1e-12 && crossed[1] + 0.8 < -0.1);
    assert_eq!(m.assembly_mode(&open, &[0]).map(|mode| -mode), m.assembly_mode(&crossed, &[0]));
}
