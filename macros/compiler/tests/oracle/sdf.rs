//! Random robots as SDF files of any version. Poses are relative to the model or to other links, and axes are
//! expressed in the frames of the version.

use crate::random::Random;
use crate::robot::{KINDS, Link, Robot};
use std::array::from_fn;
use std::fmt::Write;

/// Joint types of SDF, as indices of the joint types of URDF.
pub const OF_SDF: [usize; 5] = [0, 1, 2, 3, 6];

/// Minor version numbers of SDF 1.2 to 1.12.
const VERSIONS: [usize; 11] = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];

type Matrix = [[f64; 3]; 3];

/// Rigid pose: a matrix whose columns are the axes, and a position.
#[derive(Clone, Copy)]
struct RigidPose(Matrix, [f64; 3]);

fn rotate_vector(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| (0..3).map(|k| row[k] * v[k]).sum())
}

fn transposed_matrix(m: &Matrix) -> Matrix {
    from_fn(|i| from_fn(|j| m[j][i]))
}

impl RigidPose {
    const ZERO: RigidPose = RigidPose([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], [0.0; 3]);

    /// Creates the pose with this position, and roll, pitch and yaw.
    fn new(xyz: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> RigidPose {
        let [(sr, cr), (sp, cp), (sy, cy)] = [roll, pitch, yaw].map(f64::sin_cos);
        let rows = [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ];
        RigidPose(rows, xyz)
    }

    fn composed_with_inner_pose(&self, inner: &RigidPose) -> RigidPose {
        let columns = transposed_matrix(&inner.0).map(|column| rotate_vector(&self.0, column));
        let moved = rotate_vector(&self.0, inner.1);
        RigidPose(transposed_matrix(&columns), from_fn(|k| self.1[k] + moved[k]))
    }

    fn inverse_pose(&self) -> RigidPose {
        let axes = transposed_matrix(&self.0);
        RigidPose(axes, rotate_vector(&axes, self.1).map(|x| -x))
    }

    /// Returns the pose as the six numbers of an SDF element `<pose>`: position, then roll, pitch and yaw.
    fn pose_text(&self) -> String {
        let RigidPose(m, [x, y, z]) = self;
        let angles =
            [m[2][1].atan2(m[2][2]), (-m[2][0]).atan2(m[0][0].hypot(m[1][0])), m[1][0].atan2(m[0][0])];
        [*x, *y, *z].iter().chain(&angles).map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")
    }
}

/// Writer of a random robot as an SDF file of one version.
struct Writer<'a> {
    robot: &'a Robot,
    minor: usize,
    /// Pose of each link in the model while all coordinates are zero.
    placed: Vec<RigidPose>,
}

/// Writes the robot in a random version. Its joint types must be in [`OF_SDF`].
pub fn sdf_text(robot: &Robot, random: &mut Random) -> String {
    let minor = VERSIONS[random.index_below(VERSIONS.len())];
    let mut placed = vec![RigidPose::ZERO];
    for link in &robot.links[1..] {
        let parent = link.joint.as_ref().map_or(RigidPose::ZERO, |joint| {
            placed[joint.parent].composed_with_inner_pose(&RigidPose::new(joint.xyz, joint.rpy))
        });
        placed.push(parent);
    }
    let writer = Writer { robot, minor, placed };
    let parts: Vec<String> = (0..robot.links.len()).map(|k| writer.link_text(k, random)).collect();
    let joints: Vec<String> = (1..robot.links.len()).map(|k| writer.joint_text(k, random)).collect();
    let model = format!("<model name=\"m\">\n{}{}</model>", parts.concat(), joints.concat());
    let version = format!("1.{minor}");
    if robot.free || random.index_below(3) > 0 {
        return format!("<sdf version=\"{version}\">{model}</sdf>");
    }
    // In a world, gravity is an element of `<physics>` before version 1.6. Joints to the model are possible
    // since version 1.10.
    let gravity = "<gravity>0 0 -9.81</gravity>";
    let gravity = if minor < 6 { format!("<physics>{gravity}</physics>") } else { gravity.to_string() };
    let held = "<joint name=\"hold\" type=\"fixed\"><parent>world</parent><child>m::l0</child></joint>";
    let held = if minor < 10 { "" } else { held };
    format!("<sdf version=\"{version}\"><world name=\"w\">{gravity}{held}{model}</world></sdf>")
}

impl Writer<'_> {
    /// Returns the attribute of a pose that names a random link before link `k`, with the pose of that link.
    /// May also return an empty attribute and the pose `usual`.
    fn random_reference_attribute_and_pose(
        &self,
        k: usize,
        usual: RigidPose,
        random: &mut Random,
    ) -> (String, RigidPose) {
        let word = match self.minor {
            ..5 => "",
            5 | 6 => "frame",
            _ => "relative_to",
        };
        if word.is_empty() || k == 0 || random.index_below(2) == 0 {
            return (String::new(), usual);
        }
        let other = random.index_below(k);
        (format!(" {word}=\"l{other}\""), self.placed[other])
    }

    fn link_text(&self, k: usize, random: &mut Random) -> String {
        let Link { mass, com, inertia, .. } = self.robot.links[k];
        let (attribute, base) = self.random_reference_attribute_and_pose(k, RigidPose::ZERO, random);
        let pose = base.inverse_pose().composed_with_inner_pose(&self.placed[k]).pose_text();
        // Before version 1.7, the pose of the inertial frame may be relative to other links.
        let center = self.placed[k].composed_with_inner_pose(&RigidPose::new(com, [0.0; 3]));
        let usual = (String::new(), self.placed[k]);
        let (of_center, base) =
            if self.minor < 7 { self.random_reference_attribute_and_pose(k, usual.1, random) } else { usual };
        let center = base.inverse_pose().composed_with_inner_pose(&center).pose_text();
        let entries =
            [(0, 0, "ixx"), (0, 1, "ixy"), (0, 2, "ixz"), (1, 1, "iyy"), (1, 2, "iyz"), (2, 2, "izz")];
        let entries: String =
            entries.iter().map(|(i, j, name)| format!("<{name}>{:?}</{name}>", inertia[*i][*j])).collect();
        format!(
            "<link name=\"l{k}\"><pose{attribute}>{pose}</pose><inertial><pose{of_center}>{center}</pose>\
             <mass>{mass:?}</mass><inertia>{entries}</inertia></inertial></link>\n"
        )
    }

    fn joint_text(&self, child: usize, random: &mut Random) -> String {
        let Some(joint) = &self.robot.links[child].joint else { return String::new() };
        let kind = match KINDS[joint.kind] {
            "spherical" => "ball",
            // Older versions do not have this joint type.
            "continuous" if self.minor < 10 => "revolute",
            kind => kind,
        };
        let mut text = format!(
            "<joint name=\"{}\" type=\"{kind}\"><parent>l{}</parent><child>l{child}</child>",
            joint.name, joint.parent
        );
        if !matches!(kind, "ball" | "fixed") {
            self.write_axis(&mut text, child, joint.axis, random);
        }
        text + "</joint>\n"
    }

    fn write_axis(&self, text: &mut String, child: usize, axis: [f64; 3], random: &mut Random) {
        let in_model = random.index_below(2) == 0;
        let other = random.index_below(self.placed.len());
        let own = self.placed[child];
        let (attribute, element, frame) = match self.minor {
            ..5 => (String::new(), "", RigidPose::ZERO),
            5 | 6 if in_model => {
                (String::new(), "<use_parent_model_frame>true</use_parent_model_frame>", RigidPose::ZERO)
            }
            7.. if in_model => (" expressed_in=\"__model__\"".to_string(), "", RigidPose::ZERO),
            7.. if random.index_below(2) == 0 => {
                (format!(" expressed_in=\"l{other}\""), "", self.placed[other])
            }
            _ => (String::new(), "", own),
        };
        let axis = rotate_vector(&transposed_matrix(&frame.0), rotate_vector(&own.0, axis))
            .map(|x| format!("{x:?}"))
            .join(" ");
        let _ = write!(text, "<axis><xyz{attribute}>{axis}</xyz>{element}");
        if let Some((leader, factor, offset)) = self.robot.links[child].joint.as_ref().and_then(|j| j.mimic) {
            let leader = self.robot.links[leader].joint.as_ref().map_or("", |joint| &joint.name);
            let _ = write!(
                text,
                "<mimic joint=\"{leader}\"><multiplier>{factor:?}</multiplier><offset>{offset:?}</offset>\
                 </mimic>"
            );
        }
        text.push_str("</axis>");
    }
}
