//! Contacts between the shapes of an MJCF file (MuJoCo, *Computation*, "Collision detection").

use super::body::WORLD;
use super::reader::MjcfReader;
use super::touch::{ContactGeometry, friction_of_condim, read_contact_dimension};
use crate::diag::Place;
use crate::import::contact_limit::list_first_names;
use crate::import::context::{Cx, quote_word};
use crate::import::element::{
    Node, child_elements, element_source_position, read_name_attribute, report_missing_or_misspelt_attributes,
};
use crate::import::pose::{NumericPose, vector_norm, vector_sum, vector_times_scalar};
use crate::import::robot::unused_name;
use crate::syntax::contact::MAX_CONTACT_POINTS;
use crate::syntax::{ContactOption, FileContact, FileContactKind, GROUND, JointKind, Name};
use std::collections::{BTreeMap, BTreeSet};

/// Coefficients of friction of a `<pair>` without the attribute: two sliding, one torsional, two rolling.
const PAIR_FRICTION: [f64; 5] = [1.0, 1.0, 0.005, 0.0001, 0.0001];

/// Links of a robot as groups of links that do not move relative to each other.
struct LinkGroups {
    /// First link of the group of each link.
    group: Vec<usize>,
    /// Group of the parent body of each group.
    parent: Vec<usize>,
    /// First link of the kinematic tree of each link: an outermost moving body.
    tree: Vec<usize>,
    /// Whether each link is fixed in the world.
    is_fixed: Vec<bool>,
}

/// Contact that `<pair>` declares.
struct ContactPair {
    /// Indices of both shapes.
    shapes: [usize; 2],
    name: Option<String>,
    friction: [f64; 3],
    place: Place,
}

/// Contact of two shapes that the file may have.
struct ContactCandidate {
    shapes: [usize; 2],
    name: Option<String>,
    friction: [f64; 3],
    place: Place,
    of_file: FileContact,
}

impl<'a> MjcfReader<'a> {
    /// Collects the names of the shapes for which `<pair>` elements declare contacts.
    pub(super) fn collect_paired_shape_names(&mut self, root: Node<'a>) {
        let pairs = contact_elements(root, "pair");
        let names = pairs.flat_map(|pair| ["geom1", "geom2"].map(|end| pair.attribute(end)));
        self.paired_shapes = names.flatten().map(|name| name.trim().to_string()).collect();
    }

    /// Declares the contacts of the file: those of planes, of declared pairs, and of all shapes whose masks
    /// permit contact and whose bodies are neither connected by a joint nor excluded.
    pub(super) fn add_contacts(&mut self, root: Node<'a>, cx: &mut Cx<'_>) {
        if self.options.contacts == ContactOption::Ignore {
            return;
        }
        if !self.settings.are_contacts_enabled() {
            self.left_out.push("contacts, which the file disables".to_string());
            return;
        }
        let groups = self.link_groups();
        let (pairs, excluded) =
            (self.read_contact_pairs(root, &groups, cx), self.read_excluded_bodies(root, cx));
        let mut candidates = self.candidates_of_pairs(pairs, &groups);
        candidates.extend(self.candidates_of_masks(&candidates, &excluded, &groups));
        if self.options.contacts == ContactOption::Ground {
            let shapes = &self.contact_shapes;
            let touches_world =
                |one: &ContactCandidate| one.shapes.iter().any(|k| groups.is_fixed[shapes[*k].link]);
            let count = candidates.len();
            candidates.retain(touches_world);
            if candidates.len() < count {
                self.left_out.push("contacts of bodies with each other".to_string());
            }
        }
        if candidates.is_empty() {
            let place = &self.options.path.place;
            cx.report_error(place, "no shapes of the file can touch each other", |d| {
                d.add_help(
                    "shapes excluded by `contype` and `conaffinity`, or fitted to meshes, have no contacts",
                )
                .add_help("to ignore the contacts of the file, remove `contacts = file`")
            });
        }
        self.add_supported_contacts(candidates);
    }

    /// Adds the supported contacts among the candidates, and lists the others in the documentation.
    fn add_supported_contacts(&mut self, mut candidates: Vec<ContactCandidate>) {
        let labels = self.shape_labels();
        let has_planes = self.contact_shapes.iter().filter(|shape| shape.form.is_plane()).count() > 1;
        let mut names: BTreeSet<String> = self.joint_names.union(&self.link_names).cloned().collect();
        let mut unsupported = Vec::new();
        let shapes = &self.contact_shapes;
        candidates.retain(|one| {
            let [first, second] = one.shapes.map(|k| &shapes[k]);
            let is_supported = first.form.supports_contact_with(&second.form);
            if !is_supported {
                unsupported.push(one.shapes.map(|k| labels[k].in_pairs.clone()).join(" with "));
            }
            is_supported
        });
        self.left_out
            .extend(keep_nearest_candidates_within_limit(&mut candidates, self.options.contact_points));
        for one in candidates {
            let [first, second] = one.shapes;
            let text = match one.name {
                Some(name) => name,
                None if !shapes[second].form.is_plane() => {
                    format!("{}_{}_contact", labels[first].in_pairs, labels[second].in_pairs)
                }
                None if has_planes => {
                    format!("{}_{}_contact", labels[first].on_planes, labels[second].on_planes)
                }
                None => format!("{}_contact", labels[first].on_planes),
            };
            let text = unused_name(&text, |name| names.contains(name));
            names.insert(text.clone());
            let [first, second] = [&shapes[first], &shapes[second]];
            let links = [first, second].map(|shape| self.robot.links[shape.link].name.text.as_str());
            let contact = first.contact_with(second, (text, &one.place), links, one.friction, one.of_file);
            self.robot.contacts.push(contact);
        }
        if !unsupported.is_empty() {
            self.left_out.push(list_first_names("contacts of surfaces that are not supported", &unsupported));
        }
    }

    /// Returns the links that do not move relative to each other, as joints of the file and locked joints
    /// determine them.
    fn link_groups(&self) -> LinkGroups {
        let links = &self.robot.links;
        let indices: BTreeMap<&str, usize> =
            links.iter().enumerate().map(|(k, link)| (link.name.text.as_str(), k)).collect();
        let mut all = LinkGroups {
            group: (0..links.len()).collect(),
            parent: vec![0; links.len()],
            tree: (0..links.len()).collect(),
            is_fixed: vec![true; links.len()],
        };
        // Every link follows its parent in the list. Massless links between two joints of a body belong to
        // the parent of the body.
        let mut carrier = vec![0; links.len()];
        for joint in &self.robot.joints {
            let (Some(parent), Some(child)) =
                (indices.get(joint.parent.text.as_str()), indices.get(joint.child.text.as_str()))
            else {
                continue;
            };
            let (parent, child) = (*parent, *child);
            let is_body = parent == 0 || self.poses.contains_key(&joint.parent.text);
            carrier[child] = if is_body { parent } else { carrier[parent] };
            let is_mocap = self.mocap.contains(&joint.child.text);
            let is_locked = self.options.lock.iter().any(|lock| lock.text == joint.name.text);
            if joint.kind == JointKind::Weld && !is_mocap || is_locked {
                all.group[child] = all.group[parent];
                all.parent[child] = all.parent[parent];
                (all.tree[child], all.is_fixed[child]) = (all.tree[parent], all.is_fixed[parent]);
                continue;
            }
            all.parent[child] = all.group[carrier[child]];
            all.is_fixed[child] = is_mocap;
            all.tree[child] = if all.is_fixed[parent] { child } else { all.tree[parent] };
        }
        all
    }

    /// Returns the names of the shapes in the names of contacts. A shape without a name has that of its body
    /// in contacts of bodies if the body has no other shape.
    fn shape_labels(&self) -> Vec<ShapeLabel> {
        let mut planes = 0;
        let shapes = self.contact_shapes.iter().map(|shape| {
            let link = match self.robot.links[shape.link].name.text.as_str() {
                GROUND => WORLD,
                link => link,
            };
            let numbered = match shape.form {
                ContactGeometry::Plane(_) => {
                    planes += 1;
                    format!("plane{planes}")
                }
                ContactGeometry::Solid { number, .. } => format!("{link}_geom{number}"),
            };
            let on_planes = shape.name.clone().unwrap_or(numbered);
            let is_alone = self.contact_shapes.iter().filter(|other| other.link == shape.link).count() == 1;
            let in_pairs = match shape.name {
                None if is_alone && link != WORLD => link.to_string(),
                _ => on_planes.clone(),
            };
            ShapeLabel { on_planes, in_pairs }
        });
        shapes.collect()
    }

    /// Reads the `<pair>` elements.
    fn read_contact_pairs(
        &mut self,
        root: Node<'a>,
        groups: &LinkGroups,
        cx: &mut Cx<'_>,
    ) -> Vec<ContactPair> {
        let mut pairs: Vec<ContactPair> = Vec::new();
        let mut unknown_surfaces = Vec::new();
        for node in contact_elements(root, "pair") {
            report_missing_or_misspelt_attributes(node, &["geom1", "geom2"], &[], cx);
            let element = self.defaults.element_with_defaults(node, &["pair"], 0, cx);
            let mut read_known_shape_name = |attribute: &str| {
                let name = read_name_attribute(node, attribute, cx)?;
                if !self.named_shapes.contains_key(&name.text) {
                    let known = self.named_shapes.keys().map(String::as_str);
                    let message = format!("unknown geom {}", quote_word(&name.text));
                    cx.report_error(&name.place, message, |d| d.suggest_name(&name.text, known));
                    return None;
                }
                Some(name)
            };
            let (Some(first), Some(second)) =
                (read_known_shape_name("geom1"), read_known_shape_name("geom2"))
            else {
                continue;
            };
            let friction = read_pair_friction(&element, cx);
            if let Some(found) = element.nonzero_attribute_number("adhesion", cx) {
                cx.report_error(&found.place, "`adhesion` of a contact is not supported", |d| {
                    d.add_help("to ignore the contacts of the file, remove `contacts = file`")
                });
            }
            if element.nonzero_attribute_number("margin", cx).is_some() {
                self.count_skipped_contents("margins of contacts", 1);
            }
            let shape_index_of_name = |name: &Name| {
                self.contact_shapes.iter().position(|shape| shape.name.as_deref() == Some(name.text.as_str()))
            };
            let (Some(a), Some(b)) = (shape_index_of_name(&first), shape_index_of_name(&second)) else {
                unknown_surfaces.push(format!("{} with {}", first.text, second.text));
                continue;
            };
            let shapes = self.shapes_in_contact_order([a, b], groups);
            let place = element_source_position(node, cx);
            if pairs.iter().any(|known| known.shapes == shapes) {
                let message = format!(
                    "second `<pair>` of {} and {}",
                    quote_word(&first.text),
                    quote_word(&second.text)
                );
                cx.report_error(&place, message, |d| d.add_help("remove one of them"));
            }
            let name = node.attribute("name").map(str::to_string);
            pairs.push(ContactPair { shapes, name, friction, place });
        }
        if !unknown_surfaces.is_empty() {
            let what = "declared contacts of height fields, distance fields and shapes fitted to meshes";
            self.left_out.push(list_first_names(what, &unknown_surfaces));
        }
        pairs
    }

    /// Returns the indices of two shapes in the order of a contact: shapes of moving bodies before fixed
    /// shapes, and these before planes.
    fn shapes_in_contact_order(&self, [a, b]: [usize; 2], groups: &LinkGroups) -> [usize; 2] {
        let rank_in_contact_order = |k: usize| {
            let shape = &self.contact_shapes[k];
            (shape.form.is_plane(), groups.is_fixed[shape.link], k)
        };
        if rank_in_contact_order(a) <= rank_in_contact_order(b) { [a, b] } else { [b, a] }
    }

    /// Reads the `<exclude>` elements: pairs of links whose shapes do not collide.
    fn read_excluded_bodies(&self, root: Node<'a>, cx: &mut Cx<'_>) -> BTreeSet<[usize; 2]> {
        let mut excluded = BTreeSet::new();
        for node in contact_elements(root, "exclude") {
            report_missing_or_misspelt_attributes(node, &["body1", "body2"], &["name"], cx);
            let mut excluded_link_index = |attribute: &str| {
                let (body, _) = self.find_body(read_name_attribute(node, attribute, cx)?, cx)?;
                self.robot.links.iter().position(|link| link.name.text == body.text)
            };
            if let (Some(first), Some(second)) = (excluded_link_index("body1"), excluded_link_index("body2"))
            {
                excluded.extend([[first, second], [second, first]]);
            }
        }
        excluded
    }

    /// Returns the candidates that `<pair>` elements declare, without those whose shapes do not move relative
    /// to each other.
    fn candidates_of_pairs(&self, pairs: Vec<ContactPair>, groups: &LinkGroups) -> Vec<ContactCandidate> {
        let moving = pairs.into_iter().filter(|pair| {
            let [a, b] = pair.shapes.map(|k| self.contact_shapes[k].link);
            groups.group[a] != groups.group[b] && !(groups.is_fixed[a] && groups.is_fixed[b])
        });
        let candidates = moving.map(|ContactPair { shapes, name, friction, place }| {
            let kind = match self.contact_shapes[shapes[1]].form {
                ContactGeometry::Plane(_) => FileContactKind::Plane,
                ContactGeometry::Solid { .. } => FileContactKind::Pair,
            };
            let of_file = FileContact { kind, distance: self.bounding_sphere_distance(shapes) };
            ContactCandidate { shapes, name, friction, place, of_file }
        });
        candidates.collect()
    }

    /// Returns the candidates that the masks permit and that are not declared: first those with planes.
    fn candidates_of_masks(
        &self,
        declared: &[ContactCandidate],
        excluded: &BTreeSet<[usize; 2]>,
        groups: &LinkGroups,
    ) -> Vec<ContactCandidate> {
        let shapes = &self.contact_shapes;
        let declared: BTreeSet<[usize; 2]> = declared.iter().map(|one| one.shapes).collect();
        let candidate_if_masks_permit = |pair: [usize; 2]| {
            let [first, second] = pair.map(|k| &shapes[k]);
            let collide = first.law.masks_permit_contact(&second.law)
                && groups.may_links_collide(first.link, second.link, self.settings.filter_parent)
                && !excluded.contains(&[first.link, second.link])
                && !declared.contains(&pair);
            let is_fixed = [first, second].map(|shape| groups.is_fixed[shape.link]);
            let kind = match is_fixed {
                _ if second.form.is_plane() => FileContactKind::Plane,
                [true, _] | [_, true] => FileContactKind::World,
                _ if groups.tree[first.link] != groups.tree[second.link] => FileContactKind::Bodies,
                _ => FileContactKind::Connected,
            };
            collide.then(|| ContactCandidate {
                shapes: pair,
                name: None,
                friction: first.law.combined_friction_coefficients(&second.law),
                place: first.place.clone(),
                of_file: FileContact { kind, distance: self.bounding_sphere_distance(pair) },
            })
        };
        let (planes, solids): (Vec<usize>, Vec<usize>) =
            (0..shapes.len()).partition(|k| shapes[*k].form.is_plane());
        let on_planes = solids.iter().flat_map(|solid| planes.iter().map(|plane| [*solid, *plane]));
        let others = solids.iter().enumerate().flat_map(|(k, first)| {
            solids[k + 1..].iter().map(|second| self.shapes_in_contact_order([*first, *second], groups))
        });
        on_planes.chain(others).filter_map(candidate_if_masks_permit).collect()
    }

    /// Returns the distance of the spheres around two shapes in the configuration of the file, m; zero for a
    /// plane.
    fn bounding_sphere_distance(&self, pair: [usize; 2]) -> f64 {
        let bounding_sphere = |k: usize| match &self.contact_shapes[k].form {
            ContactGeometry::Plane(_) => None,
            ContactGeometry::Solid { shape, center, .. } => {
                let link = &self.robot.links[self.contact_shapes[k].link].name.text;
                let pose = self.poses.get(link).copied().unwrap_or(NumericPose::ZERO);
                let inner = NumericPose { at: *center, ..NumericPose::ZERO };
                Some((pose.compose_with(&inner).at, shape.bounding_radius()))
            }
        };
        let [Some((a, first)), Some((b, second))] = pair.map(bounding_sphere) else { return 0.0 };
        vector_norm(vector_sum(a, vector_times_scalar(b, -1.0))) - first - second
    }
}

/// Names of a shape in the names of contacts.
struct ShapeLabel {
    /// Name in contacts with planes.
    on_planes: String,
    /// Name in other contacts.
    in_pairs: String,
}

impl LinkGroups {
    /// Whether two links may collide: they move relative to each other, and neither is the parent of the
    /// other, unless the parent is fixed in the world or `filter_parent` is false.
    fn may_links_collide(&self, a: usize, b: usize, filter_parent: bool) -> bool {
        let [first, second] = [self.group[a], self.group[b]];
        let is_parent = self.parent[first] == second || self.parent[second] == first;
        first != second
            && !(self.is_fixed[a] && self.is_fixed[b])
            && !(filter_parent && first != 0 && second != 0 && is_parent)
    }
}

/// Returns the elements of a kind in the `<contact>` sections.
fn contact_elements<'a>(root: Node<'a>, kind: &'static str) -> impl Iterator<Item = Node<'a>> {
    let sections = child_elements(root).filter(|node| node.tag_name().name() == "contact");
    sections.flat_map(child_elements).filter(move |node| node.tag_name().name() == kind)
}

/// Reads the coefficients of sliding, torsional and rolling friction of a `<pair>`.
fn read_pair_friction(element: &super::defaults::ElementWithDefaults<'_>, cx: &mut Cx<'_>) -> [f64; 3] {
    let dimension = read_contact_dimension(element, cx);
    let found = element.numbers_with_defaults("friction", PAIR_FRICTION, cx);
    let [first, second, torsional, around_first, around_second] =
        found.as_ref().map_or(PAIR_FRICTION, |found| found.value);
    let is_anisotropic =
        dimension >= 3.0 && first != second || dimension >= 6.0 && around_first != around_second;
    if let Some(found) = found.filter(|_| is_anisotropic) {
        cx.report_error(&found.place, "friction that differs along the tangents is not supported", |d| {
            d.add_help(format!(
                "the sliding coefficients of the pair are {first} and {second}, those of rolling \
                 {around_first} and {around_second}; MuJoCo completes a shorter list by the entries of 1 1 \
                 0.005 0.0001 0.0001"
            ))
        });
    }
    friction_of_condim(dimension, [first, torsional, around_first])
}

/// Removes the most distant candidates of each kind beyond the limit of contact points, because each
/// contact has a point. Returns a line of the documentation for each kind with removed candidates.
fn keep_nearest_candidates_within_limit(candidates: &mut Vec<ContactCandidate>, limit: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for (kind, what) in [
        (FileContactKind::World, "contacts of bodies with distant shapes of the world"),
        (FileContactKind::Bodies, "contacts of distant bodies"),
        (FileContactKind::Connected, "contacts of bodies that joints connect"),
    ] {
        let mut distances: Vec<f64> = candidates
            .iter()
            .filter(|one| one.of_file.kind == kind)
            .map(|one| one.of_file.distance)
            .collect();
        let limit = match kind {
            FileContactKind::Connected => limit.min(MAX_CONTACT_POINTS),
            _ => limit,
        };
        if distances.len() <= limit {
            continue;
        }
        distances.sort_by(f64::total_cmp);
        let farthest = match kind {
            FileContactKind::Connected => f64::NEG_INFINITY,
            _ => distances[limit],
        };
        let count = candidates.len();
        candidates.retain(|one| one.of_file.kind != kind || one.of_file.distance < farthest);
        let removed = count - candidates.len();
        let reason = format!("beyond the {limit} contact points of a mechanism");
        lines.push(format!("{what}, {reason}: {removed}"));
    }
    lines
}
