//! Random mechanisms as source text of the attribute `#[mechanism]`.

use proptest::collection::vec;
use proptest::prelude::*;
use std::fmt::Write;

/// Random joint with its child body and the index of its parent body.
#[derive(Clone, Debug)]
struct JointWithChildBody {
    kind: usize,
    parent: usize,
    /// Random numbers from which axes, positions and masses are computed.
    numbers: Vec<f64>,
    /// Whether axes are coordinate axes, as in most machines, instead of general directions.
    plain_axes: bool,
    /// Whether masses and lengths are parameters of the struct instead of numbers.
    symbolic: bool,
}

/// Random mechanism: a tree of bodies with elements between them.
#[derive(Clone, Debug)]
pub struct Tree {
    limbs: Vec<JointWithChildBody>,
    /// Elements between two bodies: index of the declaration in `TIES`, first body, second body. If both
    /// bodies are the same, one end is on the ground.
    ties: Vec<(usize, usize, usize)>,
    gravity: [f64; 3],
}

/// Templates of elements that have inertia, store, dissipate or supply energy, and of particles placed along
/// axes of the body or the ground. `@a` is a point of a body, `@o` this body, `@b` a point of another body or
/// the ground, and `#` the number of the element.
const TIES: [&str; 9] = [
    "#[acts(between = (@b, @a), stiffness = 3, free_length = 0.2)] #: Spring,",
    "#[acts(between = (@b, @a), damping = 0.6)] #: Dashpot,",
    "#[acts(between = (@b, @a), inertance = 0.7)] #: Inerter,",
    "#[energy(0.3 * dot(r(@a / @b), r(@a / @b)))] #: Potential,",
    "#[dissipation(0.2 * dot(v(@a / @b / ground), v(@a / @b / ground)))] #: Rayleigh,",
    "#[acts(on = @a, value = 0.4 * r(@b / ground) - 0.3 * v(@a / ground / ground))] #: Force,",
    "way#: Coordinate, #[particle(mass = 0.6, at = @o.at(way# * ground.x + 0.3 * ground.y))] #: Particle,",
    "way#: Coordinate, #[particle(mass = 0.6, at = @o.at(way# * x + 0.3 * y))] #: Particle,",
    "#[acts(on = @o, value = 0.3 * @o.x - 0.4 * omega(@o / ground))] #: Torque,",
];

/// Returns trees with up to `joints` joints, with more free joints than [`random_trees`] has, and with
/// elements between two bodies or a body and the ground.
#[allow(dead_code, reason = "not every test that has trees has tied ones")]
pub fn random_trees_with_elements(joints: usize) -> impl Strategy<Value = Tree> {
    let ties = vec((0..TIES.len(), 0..8_usize, 0..8_usize), 0..=3);
    let free = vec(0..3_usize, joints);
    (random_trees(joints), ties, free).prop_map(|(mut tree, ties, free)| {
        for (limb, free) in tree.limbs.iter_mut().zip(free).filter(|(_, free)| *free == 0) {
            limb.kind = KINDS.iter().position(|kind| *kind == "Free").unwrap_or(free);
        }
        Tree { ties, ..tree }
    })
}

/// Returns trees with up to `joints` joints of any kind.
pub fn random_trees(joints: usize) -> impl Strategy<Value = Tree> {
    let limb = (0..KINDS.len(), 0_usize..8, vec(-1.0..1.0_f64, 24), any::<bool>(), any::<bool>()).prop_map(
        |(kind, parent, numbers, plain_axes, symbolic)| JointWithChildBody {
            kind,
            parent,
            numbers,
            plain_axes,
            symbolic,
        },
    );
    (vec(limb, 1..=joints), [-10.0..10.0_f64, -10.0..10.0_f64, -10.0..10.0_f64])
        .prop_map(|(limbs, gravity)| Tree { limbs, ties: Vec::new(), gravity })
}

const KINDS: [&str; 11] =
    ["Pin", "Sleeve", "Screw", "Collar", "Slot", "Universal", "Ball", "Planar", "Stage", "Free", "Weld"];

/// Returns the suffixes of the coordinates on which a spring or an input can act, with `true` for an angle.
fn coordinate_suffixes(kind: &str) -> &'static [(&'static str, bool)] {
    match kind {
        "Pin" | "Screw" => &[("", true)],
        "Sleeve" => &[("", false)],
        "Collar" | "Slot" => &[(".slide", false), (".turn", true)],
        "Universal" => &[(".first", true), (".second", true)],
        "Planar" => &[(".x", false), (".y", false), (".angle", true)],
        "Stage" => &[(".x", false), (".z", false)],
        _ => &[],
    }
}

impl Tree {
    /// Returns the generated source: the arguments of the attribute and the struct.
    pub fn tree_source(&self) -> (String, String) {
        let mut fields = String::new();
        // The first joint must be movable, so that the mechanism has a degree of freedom.
        for (k, limb) in self.limbs.iter().enumerate() {
            limb.write_joint(k, &mut fields);
        }
        for (k, (kind, first, second)) in self.ties.iter().enumerate() {
            let (first, second) = (first % self.limbs.len(), second % self.limbs.len());
            let other = if first == second { "ground".to_string() } else { format!("body{second}") };
            let stored_number_at_index =
                |which: usize| self.limbs[first].stored_number_at_index(which + 3 * k);
            let a = format!(
                "body{first}.at([{:?}, 0.8, {:?}])",
                stored_number_at_index(0),
                stored_number_at_index(1)
            );
            let b = format!(
                "{other}.at([{:?}, {:?}, 1.1])",
                stored_number_at_index(2),
                stored_number_at_index(3)
            );
            let tie = TIES[*kind].replace("@a", &a).replace("@b", &b);
            let tie = tie.replace("way#", &format!("way{k}")).replace("@o", &format!("body{first}"));
            let _ = writeln!(fields, "{}", tie.replace("#:", &format!("tie{k}:")));
        }
        let [x, y, z] = self.gravity;
        (format!("gravity = [{x:?}, {y:?}, {z:?}]"), format!("pub struct Random {{\n{fields}}}"))
    }
}

impl JointWithChildBody {
    fn stored_number_at_index(&self, k: usize) -> f64 {
        self.numbers[k % self.numbers.len()]
    }

    fn vector_text(&self, k: usize) -> String {
        format!(
            "[{:?}, {:?}, {:?}]",
            self.stored_number_at_index(k),
            self.stored_number_at_index(k + 1),
            self.stored_number_at_index(k + 2)
        )
    }

    fn axis_text(&self, k: usize) -> String {
        if self.plain_axes {
            let sign = if self.stored_number_at_index(k) < 0.0 { "-" } else { "" };
            format!(
                "{sign}{}",
                ["x", "y", "z"][(self.stored_number_at_index(k + 1).abs() * 3.0) as usize % 3]
            )
        } else {
            format!(
                "unit([{:?}, {:?}, 1.5])",
                self.stored_number_at_index(k),
                self.stored_number_at_index(k + 1)
            )
        }
    }

    fn write_joint(&self, k: usize, out: &mut String) {
        let kind = KINDS[self.kind];
        let mass = if self.symbolic {
            let _ = writeln!(out, "mass{k}: f64, length{k}: f64,");
            (format!("mass{k}"), format!("length{k}"))
        } else {
            (
                format!("{:?}", 1.5 + self.stored_number_at_index(0)),
                format!("{:?}", 1.2 + self.stored_number_at_index(1)),
            )
        };
        let (m, l) = mass;
        let _ = writeln!(
            out,
            "#[body(mass = {m}, com = {l} * {}, inertia = cuboid({m}, {l}, 0.7, 0.4).rotated(z({:?}), \
             x({:?})))] body{k}: Body,",
            self.vector_text(2),
            self.stored_number_at_index(5),
            self.stored_number_at_index(6)
        );
        let parent = if k == 0 { "ground".to_string() } else { format!("body{}", self.parent % k) };
        // The joint is off its parent's centre, with rotations on both sides; with plain axes it has only an
        // offset.
        let parent_end = match self.plain_axes {
            true => format!("{parent}.at({l} * x)"),
            false => format!(
                "{parent}.at({}).rotated(y({:?}), x({:?}))",
                self.vector_text(7),
                self.stored_number_at_index(8),
                self.stored_number_at_index(9)
            ),
        };
        let child_end = match self.symbolic {
            true => format!("body{k}.at(-{l} * z).rotated(z({:?}))", self.stored_number_at_index(10)),
            false => format!("body{k}"),
        };
        let _ = writeln!(
            out,
            "#[joint({parent_end} -> {child_end}{})] joint{k}: {kind},",
            self.joint_axes_source_text(kind)
        );
        self.write_actions(k, kind, out);
    }

    fn joint_axes_source_text(&self, kind: &str) -> String {
        let (a, b) = (self.axis_text(11), self.axis_text(14));
        match kind {
            "Pin" => format!(", about = {a}"),
            "Sleeve" => format!(", along = {a}"),
            "Screw" => format!(", about = {a}, pitch = {:?}", self.stored_number_at_index(13)),
            "Collar" => format!(", about = {a}"),
            "Slot" => format!(", along = {a}, about = {b}"),
            "Universal" => ", about = (x, y)".to_string(),
            "Planar" => format!(", about = {a}"),
            "Stage" => ", along = (x, unit(x + y), z)".to_string(),
            _ => String::new(),
        }
    }

    fn write_actions(&self, k: usize, kind: &str, out: &mut String) {
        for (c, (coordinate, angle)) in coordinate_suffixes(kind).iter().enumerate() {
            let on = format!("joint{k}{coordinate}");
            let free = if *angle { "free_angle" } else { "free_length" };
            let input = if *angle { "Torque" } else { "Force" };
            let _ = writeln!(
                out,
                "#[acts(on = {on}, stiffness = {:?}, {free} = {:?})] spring{k}_{c}: Spring,
                 #[acts(on = {on}, damping = {:?})] dashpot{k}_{c}: Dashpot,
                 #[acts(on = {on})] drive{k}_{c}: {input},",
                10.0 * self.stored_number_at_index(16),
                self.stored_number_at_index(17),
                self.stored_number_at_index(18).abs()
            );
        }
        // A body that only welds connect to the ground does not move, and the language rejects forces on it.
        if kind == "Weld" {
            return;
        }
        let _ = writeln!(
            out,
            "#[acts(on = body{k}.at({}), along = {} + ground.z)] push{k}: Force,
             #[acts(on = body{k}, about = {} - 0.5 * ground.x)] twist{k}: Torque,",
            self.vector_text(19),
            self.vector_text(20),
            self.vector_text(21)
        );
    }
}
