//! Reads a URDF file into a [`Model`]. Fixed links are merged into the links that carry them. Coordinates are
//! depth first, with the joints of one link in alphabetical order.

use super::{Frame, Inertia, JointMotion, Link, Model, Placement};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node};

/// Options for reading a robot file. Mimic joints are read as independent joints.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options<'a> {
    /// Whether the robot's base is free instead of fixed.
    pub free: bool,
    /// Names of the joints that are locked at the coordinate zero.
    pub lock: &'a [&'a str],
}

/// Reads the text of a URDF file.
pub fn read_urdf(text: &str, options: &Options<'_>) -> Result<Model, String> {
    let document = Document::parse(text).map_err(|e| e.to_string())?;
    let robot = document.root_element();
    let children_with_tag = |kind: &'static str| robot.children().filter(move |n| n.has_tag_name(kind));
    let mut joints: Vec<Node<'_, '_>> = children_with_tag("joint").collect();
    joints.sort_by_key(|joint| joint.attribute("name"));
    let links: Vec<Node<'_, '_>> = children_with_tag("link").collect();
    let is_child =
        |link: &Node<'_, '_>| joints.iter().any(|j| link_at_joint_end(j, "child") == link.attribute("name"));
    let root = links.iter().find(|link| !is_child(link)).ok_or("no root link")?;
    let mut reader = UrdfReader {
        joints: &joints,
        links: &links,
        lock: options.lock,
        model: Model {
            links: Vec::new(),
            frames: Vec::new(),
            gravity: Vector3::new(0.0, 0.0, -9.81),
            nq: 0,
            nv: 0,
        },
    };
    let at = options
        .free
        .then(|| reader.add_massless_link(None, Placement::identity_placement(), JointMotion::Free));
    reader.read_link_tree(root.attribute("name").unwrap_or_default(), at, Placement::identity_placement())?;
    Ok(reader.model)
}

/// Returns the name of the parent or child link of a joint.
fn link_at_joint_end<'a>(joint: &Node<'a, '_>, which: &str) -> Option<&'a str> {
    let node = joint.children().find(|n| n.has_tag_name(which))?;
    node.attribute("link")
}

struct UrdfReader<'a, 'd, 'i> {
    joints: &'a [Node<'d, 'i>],
    links: &'a [Node<'d, 'i>],
    lock: &'a [&'a str],
    model: Model,
}

impl UrdfReader<'_, '_, '_> {
    /// Adds a moving link of zero mass, and returns its index.
    fn add_massless_link(
        &mut self,
        parent: Option<usize>,
        placement: Placement,
        motion: JointMotion,
    ) -> usize {
        let (nq, nv) = motion.entry_counts_of_q_and_v();
        let (q, v) = (self.model.nq, self.model.nv);
        self.model.nq += nq;
        self.model.nv += nv;
        self.model.links.push(Link { parent, placement, motion, q, v, inertia: Inertia::zero_inertia() });
        self.model.links.len() - 1
    }

    /// Reads a link that is fixed at `placement` in the moving link `at`, and all its descendants.
    fn read_link_tree(&mut self, name: &str, at: Option<usize>, placement: Placement) -> Result<(), String> {
        self.model.frames.push(Frame { name: name.to_string(), link: at, placement });
        let node = self.links.iter().find(|n| n.attribute("name") == Some(name));
        let node = node.ok_or_else(|| format!("no link `{name}`"))?;
        if let (Some(at), Some(inertial)) = (at, node.children().find(|n| n.has_tag_name("inertial"))) {
            self.model.links[at].inertia += read_inertia(&inertial)?.inertia_in_parent(&placement);
        }
        for joint in self.joints.iter().filter(|j| link_at_joint_end(j, "parent") == Some(name)) {
            let child = link_at_joint_end(joint, "child").ok_or("a joint without child")?;
            let origin = placement.compose_with(&read_origin(joint)?);
            match self.motion_of_joint(joint)? {
                None => self.read_link_tree(child, at, origin)?,
                Some(motion) => {
                    let link = self.add_massless_link(at, origin, motion);
                    self.read_link_tree(child, Some(link), Placement::identity_placement())?;
                }
            }
        }
        Ok(())
    }

    /// Returns the motion of a joint, or `None` if it is fixed or locked.
    fn motion_of_joint(&self, joint: &Node<'_, '_>) -> Result<Option<JointMotion>, String> {
        let name = joint.attribute("name").unwrap_or_default();
        if self.lock.contains(&name) {
            return Ok(None);
        }
        if joint.children().any(|n| n.has_tag_name("dynamics")) {
            return Err(format!("joint `{name}`: damping and friction are not supported"));
        }
        let axis = joint.children().find(|n| n.has_tag_name("axis"));
        let axis = axis.map_or(Ok(Vector3::x()), |n| read_vector_attribute(&n, "xyz"))?;
        let axis = Unit::try_new(axis, 1e-9).ok_or_else(|| format!("joint `{name}`: the axis is zero"))?;
        match joint.attribute("type").unwrap_or_default() {
            "fixed" => Ok(None),
            "revolute" | "continuous" => Ok(Some(JointMotion::Turn(axis))),
            "prismatic" => Ok(Some(JointMotion::Slide(axis))),
            "floating" => Ok(Some(JointMotion::Free)),
            other => Err(format!("joint `{name}`: type `{other}` is not supported")),
        }
    }
}

/// Reads an `<origin>` element as a placement.
fn read_origin(parent: &Node<'_, '_>) -> Result<Placement, String> {
    let Some(node) = parent.children().find(|n| n.has_tag_name("origin")) else {
        return Ok(Placement::identity_placement());
    };
    let angles = read_vector_attribute(&node, "rpy")?;
    let rotation = Rotation3::from_euler_angles(angles.x, angles.y, angles.z);
    Ok(Placement::new(rotation.into_inner(), read_vector_attribute(&node, "xyz")?))
}

/// Reads an `<inertial>` element about the link's origin.
fn read_inertia(inertial: &Node<'_, '_>) -> Result<Inertia, String> {
    let find_child_by_tag = |tag: &str| inertial.children().find(|n| n.has_tag_name(tag));
    let mass = find_child_by_tag("mass").map_or(Ok(0.0), |n| read_number_attribute(&n, "value"))?;
    let mut entries = [0.0; 6];
    if let Some(node) = find_child_by_tag("inertia") {
        for (entry, key) in entries.iter_mut().zip(["ixx", "ixy", "ixz", "iyy", "iyz", "izz"]) {
            *entry = read_number_attribute(&node, key)?;
        }
    }
    let [xx, xy, xz, yy, yz, zz] = entries;
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let central = Inertia::inertia_of_body(mass, Vector3::zeros(), tensor);
    Ok(central.inertia_in_parent(&read_origin(inertial)?))
}

fn read_number_attribute(node: &Node<'_, '_>, key: &str) -> Result<f64, String> {
    let text = node.attribute(key).unwrap_or("0");
    text.trim().parse().map_err(|_| format!("`{text}` is not a number"))
}

/// Reads three numbers, which are zero if the attribute is absent.
fn read_vector_attribute(node: &Node<'_, '_>, key: &str) -> Result<Vector3<f64>, String> {
    let Some(text) = node.attribute(key) else {
        return Ok(Vector3::zeros());
    };
    let numbers: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
    match numbers.as_deref() {
        Ok(&[x, y, z]) => Ok(Vector3::new(x, y, z)),
        _ => Err(format!("`{text}` are not three numbers")),
    }
}
