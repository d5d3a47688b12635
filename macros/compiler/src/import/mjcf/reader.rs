//! What is read of a file, while it is read.

use super::defaults::Defaults;
use super::geometry::Mass;
use super::pose::{Pose, scale};
use super::settings::Settings;
use crate::diag::Place;
use crate::import::robot::Robot;
use crate::syntax::{Body, Expr, ExprKind, FileOptions, Name};
use std::collections::{BTreeMap, BTreeSet};

/// What is read of a file.
pub(super) struct Reader<'a> {
    pub(super) options: &'a FileOptions,
    pub(super) settings: Settings,
    pub(super) defaults: Defaults<'a>,
    /// Springs, dampers and friction are taken over.
    pub(super) passive: bool,
    pub(super) robot: Robot,
    pub(super) joint_names: BTreeSet<String>,
    pub(super) link_names: BTreeSet<String>,
    /// Where each joint stands in the pose of the file.
    pub(super) references: BTreeMap<String, f64>,
    /// Where the spring of each joint is free.
    pub(super) rests: BTreeMap<String, f64>,
    pub(super) left_out: Vec<String>,
    pub(super) counts: BTreeMap<&'static str, usize>,
    /// Mass properties by link.
    pub(super) masses: Vec<Option<Mass>>,
    /// Bodies so far: that is the number which MuJoCo gives the last one.
    pub(super) bodies: usize,
    pub(super) sites: Vec<(Name, String, Pose)>,
}

impl<'a> Reader<'a> {
    /// Nothing is read yet.
    pub(super) fn new(options: &'a FileOptions, settings: Settings, defaults: Defaults<'a>) -> Reader<'a> {
        let passive = options.honour_passive && settings.passive;
        Reader {
            options,
            settings,
            defaults,
            passive,
            robot: Robot::default(),
            joint_names: BTreeSet::new(),
            link_names: BTreeSet::new(),
            references: BTreeMap::new(),
            rests: BTreeMap::new(),
            left_out: Vec::new(),
            counts: BTreeMap::new(),
            masses: vec![None],
            bodies: 0,
            sites: Vec::new(),
        }
    }

    /// Counts what is left out.
    pub(super) fn count(&mut self, what: &'static str, more: usize) {
        *self.counts.entry(what).or_default() += more;
    }

    /// `settotalmass`: all masses in the same proportion.
    pub(super) fn scale_masses(&mut self) {
        let Some(wanted) = self.settings.total_mass else { return };
        let total: f64 = self.masses.iter().flatten().map(|mass| mass.mass).sum();
        if total <= 0.0 {
            return;
        }
        let factor = wanted / total;
        for (link, mass) in self.robot.links.iter_mut().zip(&self.masses) {
            if let Some(mass) = mass {
                let place = link.mass.as_ref().map_or(link.name.place.clone(), |mass| mass.place.clone());
                let inertia = mass.inertia.map(|row| scale(row, factor));
                give(link, &Mass { mass: mass.mass * factor, inertia, ..*mass }, &place);
            }
        }
    }
}

/// Gives a link its mass properties.
pub(super) fn give(link: &mut Body, mass: &Mass, place: &Place) {
    link.mass = Some(Expr::number(mass.mass, place));
    link.com = (mass.com != [0.0; 3]).then(|| Expr::vector(mass.com, place));
    let rows: Vec<Expr> = (0..3)
        .map(|i| {
            // Rounding of products leaves the two halves different.
            let entry = |j: usize| if i <= j { mass.inertia[i][j] } else { mass.inertia[j][i] };
            Expr::vector(std::array::from_fn(entry), place)
        })
        .collect();
    let zero = mass.inertia.iter().flatten().all(|entry| *entry == 0.0);
    link.inertia = (!zero).then(|| Expr { kind: ExprKind::Array(rows), place: place.clone() });
}
