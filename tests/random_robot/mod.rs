//! Random robots with the rounding noise of exporters: frames rotated by right angles and a few other angles,
//! with noise in all values.

use proptest::collection::vec;
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Random robot: a tree of bodies on pins and sleeves.
#[derive(Clone, Debug)]
pub struct Robot {
    links: Vec<Link>,
    /// Magnitudes of the noise of angles, axes and lengths (absolute).
    noise: [f64; 3],
}

#[derive(Clone, Debug)]
struct Link {
    parent: usize,
    slides: bool,
    /// Number of right angles of the rotation about each axis of the parent; the value four means another
    /// angle.
    turns: [usize; 3],
    /// Components of the position and of the centre of mass that are not zero.
    present: [bool; 6],
    /// Magnitude of the lengths of the link, m.
    size: f64,
    numbers: Vec<f64>,
}

/// Returns robots with up to `joints` joints. The noise in angles, axes and lengths is 0, or 1e-16 to 1e-3.
pub fn random_robots(joints: usize) -> impl Strategy<Value = Robot> {
    let random_noise = || prop_oneof![1 => Just(0.0), 4 => (-16.0..-3.0_f64).prop_map(|e| 10.0_f64.powf(e))];
    let link =
        (0..3_usize, 0..6_usize, [0..5_usize, 0..5_usize, 0..5_usize], any::<[bool; 6]>(), -2.0..0.0_f64)
            .prop_flat_map(|(parent, kind, turns, present, size)| {
                vec(-1.0..1.0_f64, 24).prop_map(move |numbers| Link {
                    parent,
                    slides: kind == 0,
                    turns,
                    present,
                    size: 10.0_f64.powf(size),
                    numbers,
                })
            });
    (vec(link, 2..=joints), random_noise(), random_noise(), random_noise())
        .prop_map(|(links, angles, axes, lengths)| Robot { links, noise: [angles, axes, lengths] })
}

impl Robot {
    /// Returns the generated source: the arguments of the attribute and the struct.
    pub fn robot_source(&self) -> (String, String) {
        let mut fields = String::new();
        for (k, link) in self.links.iter().enumerate() {
            link.write_link(k, self.noise, &mut fields);
        }
        ("gravity = -9.81 * z".to_string(), format!("pub struct Robot {{\n{fields}}}"))
    }
}

impl Link {
    /// Returns three lengths, some of which consist only of noise.
    fn noisy_vector_text(&self, first: usize, noise: f64) -> String {
        let noisy_component = |i: usize| {
            let there = self.present[first + i];
            let rest = if there { self.size * self.numbers[first + i] } else { 0.0 };
            rest + noise * self.numbers[6 + first + i]
        };
        format!("[{:?}, {:?}, {:?}]", noisy_component(0), noisy_component(1), noisy_component(2))
    }

    fn write_link(&self, k: usize, [angles, axes, lengths]: [f64; 3], out: &mut String) {
        let stored_number_at_index = |which: usize| self.numbers[which];
        let (mass, s) = ((1.5 + stored_number_at_index(12)) * self.size, self.size);
        let _ = writeln!(
            out,
            "#[body(mass = {mass:?}, com = {}, inertia = cuboid({mass:?}, {s:?}, {:?}, \
             {:?}).rotated(x({:?})))] b{k}: Body,",
            self.noisy_vector_text(3, lengths),
            0.7 * s,
            0.4 * s,
            if self.present[5] { stored_number_at_index(13) } else { angles * stored_number_at_index(13) },
        );
        let angle_with_noise = |i: usize| match self.turns[i] {
            4 => stored_number_at_index(14 + i),
            turns => turns as f64 * FRAC_PI_2 + angles * stored_number_at_index(14 + i),
        };
        let parent = match k {
            0 => "ground".to_string(),
            _ => format!("b{}", k - 1 - self.parent.min(k - 1)),
        };
        let (word, kind) = if self.slides { ("along", "Sleeve") } else { ("about", "Pin") };
        let axis = format!(
            "unit([{:?}, {:?}, 1])",
            axes * stored_number_at_index(17),
            axes * stored_number_at_index(18)
        );
        let _ = writeln!(
            out,
            "#[joint({parent}.at({}).rotated(z({:?}), y({:?}), x({:?})) -> b{k}, {word} = {axis})] j{k}: \
             {kind},",
            self.noisy_vector_text(0, lengths),
            angle_with_noise(2),
            angle_with_noise(1),
            angle_with_noise(0),
        );
    }
}
