//! Linkages with singular configurations, with random dimensions, for tests.

use linkwork::prelude::*;
use std::f64::consts::PI;
use support::random::Random;

/// Declares a four-bar linkage of rods along `$along`, which moves in the plane normal to `$about`, with
/// springs on its pins.
macro_rules! four_bar {
    ($name:ident, $about:expr, $along:expr, $gravity:expr) => {
        #[mechanism(gravity = down * $gravity + aside * $along)]
        #[derive(Clone, Copy, Debug)]
        pub struct $name {
            down: f64,
            aside: f64,
            base: f64,
            l1: f64,
            l2: f64,
            l3: f64,
            m1: f64,
            m2: f64,
            m3: f64,
            k1: f64,
            k2: f64,
            k3: f64,
            free: f64,
            #[body(mass = m1, com = l1 / 2 * $along, inertia = rod(m1, l1, $along))]
            crank: Body,
            #[body(mass = m2, com = l2 / 2 * $along, inertia = rod(m2, l2, $along))]
            coupler: Body,
            #[body(mass = m3, com = l3 / 2 * $along, inertia = rod(m3, l3, $along))]
            rocker: Body,
            #[joint(ground -> crank, about = $about)]
            first: Pin,
            #[joint(crank.at(l1 * $along) -> coupler, about = $about)]
            second: Pin,
            #[joint(ground.at(base * $along) -> rocker, about = $about)]
            third: Pin,
            #[joint(rocker.at(l3 * $along) -> coupler.at(l2 * $along), about = $about)]
            closing: Pin,
            #[acts(on = first, stiffness = k1, free_angle = free)]
            s1: Spring,
            #[acts(on = second, stiffness = k2, free_angle = 0)]
            s2: Spring,
            #[acts(on = third, stiffness = k3, free_angle = free / 2)]
            s3: Spring,
        }

        impl $name {
            /// Returns an instance with these lengths and random masses, springs and gravity.
            pub fn random_instance(random: &mut Random, style: &MagnitudeRanges, lengths: [f64; 4]) -> Self {
                let [base, l1, l2, l3] = lengths;
                let (mut mass, angle) = (|| style.random_mass(random), 2.0);
                let [m1, m2, m3] = [mass(), mass(), mass()];
                let mut stiffness = || style.random_stiffness(random);
                let [k1, k2, k3] = [stiffness(), stiffness(), stiffness()];
                let turn = random.uniform_number(PI);
                let (aside, down) = (9.81 * turn.sin(), 9.81 * turn.cos());
                let free = random.uniform_number(angle);
                Self { down, aside, base, l1, l2, l3, m1, m2, m3, k1, k2, k3, free }
            }
        }
    };
}

four_bar!(FourBar, z, x, y);
four_bar!(Tilted, unit(x + 2 * y + 2 * z), (2 * x + y - 2 * z) / 3, (2 * x - 2 * y + z) / 3);

/// Linkage of two stacked parallelogram windows, each with two posts of equal length.
#[mechanism(gravity = down * y + aside * x)]
#[derive(Clone, Copy, Debug)]
pub struct StackedWindows {
    pub down: f64,
    pub aside: f64,
    pub low: f64,
    pub high: f64,
    pub width: f64,
    pub shelf: f64,
    pub m1: f64,
    pub m2: f64,
    pub m3: f64,
    pub m4: f64,
    pub m5: f64,
    pub m6: f64,
    pub k1: f64,
    pub k2: f64,
    pub k3: f64,
    pub k4: f64,
    #[body(mass = m1, com = low / 2 * x, inertia = rod(m1, low, x))]
    left: Body,
    #[body(mass = m2, com = width / 2 * x, inertia = rod(m2, width, x))]
    beam: Body,
    #[body(mass = m3, com = low / 2 * x, inertia = rod(m3, low, x))]
    right: Body,
    #[body(mass = m4, com = high / 2 * x, inertia = rod(m4, high, x))]
    post: Body,
    #[body(mass = m5, com = shelf / 2 * x, inertia = rod(m5, shelf, x))]
    top: Body,
    #[body(mass = m6, com = high / 2 * x, inertia = rod(m6, high, x))]
    prop: Body,
    #[joint(ground -> left, about = z)]
    first: Pin,
    #[joint(left.at(low * x) -> beam, about = z)]
    second: Pin,
    #[joint(ground.at(width * x) -> right, about = z)]
    third: Pin,
    #[joint(right.at(low * x) -> beam.at(width * x), about = z)]
    close: Pin,
    #[joint(beam.at(width / 4 * x) -> post, about = z)]
    fourth: Pin,
    #[joint(post.at(high * x) -> top, about = z)]
    fifth: Pin,
    #[joint(beam.at((width / 4 + shelf) * x) -> prop, about = z)]
    sixth: Pin,
    #[joint(prop.at(high * x) -> top.at(shelf * x), about = z)]
    shut: Pin,
    #[acts(on = first, stiffness = k1, free_angle = 0.3)]
    s1: Spring,
    #[acts(on = second, stiffness = k2, free_angle = 0)]
    s2: Spring,
    #[acts(on = fourth, stiffness = k3, free_angle = 0)]
    s3: Spring,
    #[acts(on = fifth, stiffness = k4, free_angle = -0.2)]
    s4: Spring,
}

/// Linkage of three parallelogram windows side by side, whose posts have equal lengths.
#[mechanism(gravity = down * y + aside * x)]
#[derive(Clone, Copy, Debug)]
pub struct RowOfWindows {
    pub down: f64,
    pub aside: f64,
    pub post: f64,
    pub w1: f64,
    pub w2: f64,
    pub w3: f64,
    pub m1: f64,
    pub m2: f64,
    pub m3: f64,
    pub m4: f64,
    pub k1: f64,
    pub k2: f64,
    pub k3: f64,
    #[body(mass = m1, com = post / 2 * x, inertia = rod(m1, post, x))]
    p0: Body,
    #[body(mass = m2, com = w1 / 2 * x, inertia = rod(m2, w1, x))]
    b1: Body,
    #[body(mass = m3, com = post / 2 * x, inertia = rod(m3, post, x))]
    p1: Body,
    #[body(mass = m4, com = w2 / 2 * x, inertia = rod(m4, w2, x))]
    b2: Body,
    #[body(mass = m1, com = post / 2 * x, inertia = rod(m1, post, x))]
    p2: Body,
    #[body(mass = m2, com = w3 / 2 * x, inertia = rod(m2, w3, x))]
    b3: Body,
    #[body(mass = m3, com = post / 2 * x, inertia = rod(m3, post, x))]
    p3: Body,
    #[joint(ground -> p0, about = z)]
    first: Pin,
    #[joint(p0.at(post * x) -> b1, about = z)]
    second: Pin,
    #[joint(ground.at(w1 * x) -> p1, about = z)]
    third: Pin,
    #[joint(p1.at(post * x) -> b2, about = z)]
    fourth: Pin,
    #[joint(ground.at((w1 + w2) * x) -> p2, about = z)]
    fifth: Pin,
    #[joint(p2.at(post * x) -> b3, about = z)]
    sixth: Pin,
    #[joint(ground.at((w1 + w2 + w3) * x) -> p3, about = z)]
    seventh: Pin,
    #[joint(b1.at(w1 * x) -> p1.at(post * x), about = z)]
    close1: Pin,
    #[joint(b2.at(w2 * x) -> p2.at(post * x), about = z)]
    close2: Pin,
    #[joint(b3.at(w3 * x) -> p3.at(post * x), about = z)]
    close3: Pin,
    #[acts(on = second, stiffness = k1, free_angle = 0.5)]
    s1: Spring,
    #[acts(on = fifth, stiffness = k2, free_angle = 0)]
    s2: Spring,
    #[acts(on = sixth, stiffness = k3, free_angle = 0)]
    s3: Spring,
}

/// Ranges from which random masses and springs are drawn, in powers of ten.
pub struct MagnitudeRanges {
    pub masses: f64,
    pub springs: f64,
}

impl MagnitudeRanges {
    pub fn random_mass(&self, random: &mut Random) -> f64 {
        10_f64.powf(random.uniform_number(self.masses))
    }

    /// Returns a random spring stiffness, which is zero for one spring in three.
    pub fn random_stiffness(&self, random: &mut Random) -> f64 {
        if random.uniform_number(1.0) < -0.33 {
            0.0
        } else {
            10_f64.powf(random.uniform_number(self.springs))
        }
    }
}
