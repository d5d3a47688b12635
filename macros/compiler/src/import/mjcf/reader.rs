//! State of the reader of an MJCF file.

use super::body::WORLD;
use super::defaults::{Defaults, ElementWithDefaults};
use super::geometry::BodyMassProperties;
use super::mesh::Meshes;
use super::settings::MjcfSettings;
use super::touch::ContactShape;
use crate::diag::Place;
use crate::import::context::{Cx, quote_word};
use crate::import::imported::Located;
use crate::import::pose::{NumericPose, roll_pitch_yaw, vector_times_scalar};
use crate::import::robot::{FileOrigin, Robot};
use crate::syntax::{Body, Expr, ExprKind, FileOptions, GROUND, Name};
use std::collections::{BTreeMap, BTreeSet};

/// State of the reader of an MJCF file.
pub(super) struct MjcfReader<'a> {
    pub(super) options: &'a FileOptions,
    pub(super) settings: MjcfSettings,
    pub(super) defaults: Defaults<'a>,
    /// Meshes of the MJCF file.
    pub(super) meshes: Meshes<'a>,
    /// Whether forces of a fluid are imported.
    pub(super) passive: bool,
    /// Whether springs of joints and tendons are imported.
    pub(super) springs: bool,
    /// Whether dampers of joints, tendons and actuators are imported.
    pub(super) dampers: bool,
    /// Whether dry friction is imported.
    pub(super) friction: bool,
    pub(super) robot: Robot,
    pub(super) joint_names: BTreeSet<String>,
    pub(super) link_names: BTreeSet<String>,
    /// Coordinate of each joint in the configuration of the file.
    pub(super) references: BTreeMap<String, f64>,
    /// Coordinate at which the spring of each joint is relaxed.
    pub(super) rests: BTreeMap<String, f64>,
    pub(super) left_out: Vec<String>,
    pub(super) counts: BTreeMap<&'static str, usize>,
    /// Pose of each body relative to the world, in the configuration of the file.
    pub(super) poses: BTreeMap<String, NumericPose>,
    /// Body of each site, and pose of the site relative to the body.
    pub(super) poses_of_sites: BTreeMap<String, (String, NumericPose)>,
    /// Named shapes, each with its body and the pose of its surrounding `<frame>` elements relative to the
    /// body.
    pub(super) named_shapes: BTreeMap<String, (String, ElementWithDefaults<'a>, NumericPose)>,
    /// Source position of the first shape with an individual fluid model.
    pub(super) shaped: Option<Place>,
    /// Names of mocap bodies, whose poses programs prescribe.
    pub(super) mocap: BTreeSet<String>,
    /// Mass properties of each link of the robot.
    pub(super) masses: Vec<Option<BodyMassProperties>>,
    /// Number of bodies read so far, which is MuJoCo's index of the last one.
    pub(super) bodies: usize,
    pub(super) sites: Vec<(Name, String, NumericPose)>,
    /// Shapes that can touch each other, in the order of the file, those of the world first.
    pub(super) contact_shapes: Vec<ContactShape>,
    /// Names of the shapes for which the file declares contacts.
    pub(super) paired_shapes: BTreeSet<String>,
}

impl<'a> MjcfReader<'a> {
    /// Creates the reader of an MJCF file before any element is read.
    pub(super) fn new(
        options: &'a FileOptions,
        settings: MjcfSettings,
        defaults: Defaults<'a>,
        meshes: Meshes<'a>,
    ) -> MjcfReader<'a> {
        let honour = options.honour_passive;
        let (passive, friction) =
            (honour && settings.are_passive_forces_enabled(), honour && settings.is_dry_friction_enabled());
        let (springs, dampers) = (honour && settings.springs, honour && settings.dampers);
        MjcfReader {
            options,
            settings,
            defaults,
            meshes,
            passive,
            springs,
            dampers,
            friction,
            robot: Robot::default(),
            joint_names: BTreeSet::new(),
            link_names: BTreeSet::new(),
            references: BTreeMap::new(),
            rests: BTreeMap::new(),
            left_out: Vec::new(),
            counts: BTreeMap::new(),
            poses: BTreeMap::new(),
            poses_of_sites: BTreeMap::new(),
            named_shapes: BTreeMap::new(),
            shaped: None,
            mocap: BTreeSet::new(),
            masses: vec![None],
            bodies: 0,
            sites: Vec::new(),
            contact_shapes: Vec::new(),
            paired_shapes: BTreeSet::new(),
        }
    }

    /// Adds `more` to the count of skipped contents of this kind.
    pub(super) fn count_skipped_contents(&mut self, what: &'static str, more: usize) {
        *self.counts.entry(what).or_default() += more;
    }

    /// Returns the link of a body of the file, and its pose relative to the world in the configuration of the
    /// file. Reports an unknown body.
    pub(super) fn find_body(&self, mut body: Name, cx: &mut Cx<'_>) -> Option<(Name, NumericPose)> {
        if body.text == WORLD {
            return Some((Name { text: GROUND.to_string(), ..body }, NumericPose::ZERO));
        }
        if body.text == GROUND {
            // The body `ground` of the file was renamed.
            let renamed = self.poses.keys().find(|known| known.starts_with("ground_link"));
            body.text = renamed.cloned().unwrap_or(body.text);
        }
        let Some(pose) = self.poses.get(&body.text) else {
            let known = self.poses.keys().map(String::as_str);
            let message = format!("unknown body {}", quote_word(&body.text));
            cx.report_error(&body.place, message, |d| d.suggest_name(&body.text, known));
            return None;
        };
        Some((body, *pose))
    }

    /// Scales all masses by a common factor to the value of `settotalmass`.
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
                let inertia = mass.inertia.map(|row| vector_times_scalar(row, factor));
                assign_mass_properties(
                    link,
                    &BodyMassProperties { mass: mass.mass * factor, inertia, ..*mass },
                    &place,
                );
            }
        }
    }
}

/// Sets the mass properties of a link from numbers.
pub(super) fn assign_mass_properties(link: &mut Body, mass: &BodyMassProperties, place: &Place) {
    link.mass = Some(Expr::number_at(mass.mass, place));
    link.com = (mass.com != [0.0; 3]).then(|| Expr::vector_at(mass.com, place));
    let rows: Vec<Expr> = (0..3)
        .map(|i| {
            // The two triangles of the matrix may differ by rounding errors.
            let symmetric_entry = |j: usize| if i <= j { mass.inertia[i][j] } else { mass.inertia[j][i] };
            Expr::vector_at(std::array::from_fn(symmetric_entry), place)
        })
        .collect();
    let zero = mass.inertia.iter().flatten().all(|entry| *entry == 0.0);
    link.inertia = (!zero).then(|| Expr { kind: ExprKind::Array(rows), place: place.clone() });
}

/// Converts a numeric pose to a [`FileOrigin`] with a source position.
pub(super) fn origin_from_pose(pose: &NumericPose, place: &Place) -> FileOrigin {
    let value_with_source_place = |value| Located { value, place: place.clone() };
    FileOrigin {
        xyz: value_with_source_place(pose.at.map(|x| x + 0.0)),
        rpy: value_with_source_place(roll_pitch_yaw(&pose.axes)),
    }
}
