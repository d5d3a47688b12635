//! Random robots: as files, as the order of their coordinates, and as poses of their links in a motion.

use crate::jet::{
    C, Jet, Matrix, constant_vector, identity_matrix, matrix_product, rotation_about_axis, scaled_vector,
    sum_of_vectors,
};
use crate::kane::State;
use crate::motion::{MovingBody, Pose, compose_poses, position_moving_with_velocity, rotating_orientation};
use crate::random::Random;
use std::array::from_fn;
use std::fmt::Write;

pub const KINDS: [&str; 7] =
    ["revolute", "continuous", "prismatic", "fixed", "floating", "planar", "spherical"];

pub struct Link {
    name: String,
    pub mass: f64,
    /// Position of the link's centre of mass in link axes.
    pub com: [f64; 3],
    /// Inertia of the link about its centre of mass, in link axes.
    pub inertia: [[f64; 3]; 3],
    inertial: String,
    /// Joint of the link to its parent; `None` for the root.
    pub joint: Option<Joint>,
}

pub struct Joint {
    pub name: String,
    pub kind: usize,
    pub parent: usize,
    pub xyz: [f64; 3],
    pub rpy: [f64; 3],
    pub axis: [f64; 3],
    locked: bool,
    /// Mimic relation: link whose joint is the leader, factor and offset.
    pub mimic: Option<(usize, f64, f64)>,
}

pub struct Robot {
    pub free: bool,
    pub links: Vec<Link>,
    /// Order in which links and joints are written to the file.
    shuffle: Vec<usize>,
}

/// Returns the rotation matrix `R_z(yaw) R_y(pitch) R_x(roll)` of roll, pitch and yaw.
pub fn rotation_of_rpy([roll, pitch, yaw]: [f64; 3]) -> Matrix {
    let coordinate_axis_rotation = |k: usize, angle| {
        rotation_about_axis(from_fn(|i| f64::from(u8::from(i == k))), Jet::constant_series(angle))
    };
    matrix_product(
        &matrix_product(&coordinate_axis_rotation(2, yaw), &coordinate_axis_rotation(1, pitch)),
        &coordinate_axis_rotation(0, roll),
    )
}

impl Link {
    fn random_link(k: usize, random: &mut Random) -> Link {
        // Inertia of four point masses in the axes of an inertial frame, about their centre.
        let points: [([f64; 3], f64); 4] =
            from_fn(|_| (random.four_digit_numbers(), 1.0 + random.four_digit_number().abs()));
        let mass: f64 = points.iter().map(|(_, m)| m).sum();
        let center: [f64; 3] = from_fn(|i| points.iter().map(|(p, m)| m * p[i]).sum::<f64>() / mass);
        let mut own = [[0.0; 3]; 3];
        for (p, m) in points {
            let r: [f64; 3] = from_fn(|i| p[i] - center[i]);
            for (i, row) in own.iter_mut().enumerate() {
                for (j, entry) in row.iter_mut().enumerate() {
                    *entry += m * (if i == j { r.iter().map(|x| x * x).sum() } else { 0.0 } - r[i] * r[j]);
                }
            }
        }
        let (com, rpy) =
            (random.four_digit_numbers(), random.four_digit_numbers::<3>().map(|angle| 3.0 * angle));
        let rotated = rotation_of_rpy(rpy);
        let r: [[f64; 3]; 3] = rotated.map(|row| row.map(|entry| entry.0[0].re));
        let ([xx, xy, xz], [_, yy, yz], [_, _, zz]) = (own[0], own[1], own[2]);
        let inertial = format!(
            "<inertial><mass value=\"{mass:?}\"/><origin xyz=\"{}\" rpy=\"{}\"/><inertia ixx=\"{xx:?}\" \
             ixy=\"{xy:?}\" ixz=\"{xz:?}\" iyy=\"{yy:?}\" iyz=\"{yz:?}\" izz=\"{zz:?}\"/></inertial>",
            space_separated_text(com),
            space_separated_text(rpy)
        );
        let inertia =
            from_fn(|i| from_fn(|j| (0..9).map(|k| r[i][k / 3] * own[k / 3][k % 3] * r[j][k % 3]).sum()));
        Link { name: format!("l{k}"), mass, com, inertia, inertial, joint: None }
    }
}

/// Formats three numbers as text, separated by spaces.
pub fn space_separated_text(numbers: [f64; 3]) -> String {
    numbers.map(|x| format!("{x:?}")).join(" ")
}

impl Joint {
    fn random_joint(child: usize, links: &[Link], kinds: &[usize], random: &mut Random) -> Joint {
        let kind = kinds[random.index_below(kinds.len())];
        let axis = match (KINDS[kind], random.index_below(3)) {
            // The directions of x and y are a convention: for a coordinate axis, the other two axes in cyclic
            // order.
            ("planar", k) => from_fn(|i| if i == k { 2.0 } else { 0.0 }),
            (_, 0) => random.four_digit_numbers::<3>().map(|x| x + if x < 0.0 { -0.1 } else { 0.1 }),
            (_, k) => from_fn(|i| if i == k { random.four_digit_number() - 2.0 } else { 0.0 }),
        };
        let leaders: Vec<usize> = (1..child).filter(|k| links[*k].can_joint_be_mimicked()).collect();
        let follows = kind < 3 && !leaders.is_empty() && random.index_below(4) == 0;
        Joint {
            name: format!("{}{child}", ["j", "J", "a", "joint_"][random.index_below(4)]),
            kind,
            parent: random.index_below(child),
            xyz: random.four_digit_numbers(),
            rpy: if random.index_below(3) == 0 {
                [0.0; 3]
            } else {
                random.four_digit_numbers::<3>().map(|angle| 3.0 * angle)
            },
            axis,
            locked: !follows && random.index_below(8) == 0,
            mimic: follows.then(|| {
                (
                    leaders[random.index_below(leaders.len())],
                    random.four_digit_number() * 2.0,
                    random.four_digit_number(),
                )
            }),
        }
    }
}

impl Link {
    /// Returns true if other joints may follow the joint of this link.
    fn can_joint_be_mimicked(&self) -> bool {
        self.joint.as_ref().is_some_and(|j| j.kind < 3 && !j.locked && j.mimic.is_none())
    }

    /// Returns the numbers of entries of the link's joint in `q` and `v`.
    fn joint_entry_counts(&self, free: bool) -> [usize; 2] {
        match &self.joint {
            None if free => [7, 6],
            None => [0, 0],
            Some(joint) if joint.locked || joint.mimic.is_some() => [0, 0],
            Some(joint) => [[1, 1], [1, 1], [1, 1], [0, 0], [7, 6], [3, 3], [4, 3]][joint.kind],
        }
    }
}

impl Robot {
    /// Returns a random robot whose joints have these types.
    pub fn random_robot(kinds: &[usize], random: &mut Random) -> Robot {
        let n = 2 + random.index_below(6);
        let mut links = vec![Link::random_link(0, random)];
        for k in 1..n {
            let mut link = Link::random_link(k, random);
            link.joint = Some(Joint::random_joint(k, &links, kinds, random));
            links.push(link);
        }
        let mut shuffle: Vec<usize> = (0..2 * n - 1).collect();
        (1..shuffle.len()).for_each(|k| shuffle.swap(k, random.index_below(k + 1)));
        Robot { free: random.index_below(2) == 0, links, shuffle }
    }

    pub fn urdf_text(&self) -> String {
        let mut text = String::from("<robot name=\"r\">\n");
        for k in &self.shuffle {
            match k.checked_sub(self.links.len()) {
                None => {
                    let Link { name, inertial, .. } = &self.links[*k];
                    let _ = writeln!(text, "<link name=\"{name}\">{inertial}</link>");
                }
                Some(k) => self.write_urdf_joint(&mut text, k + 1),
            }
        }
        text + "</robot>"
    }

    /// Returns a random robot with the joint types of MJCF.
    pub fn random_robot_for_mjcf(random: &mut Random) -> Robot {
        let mut robot = Robot::random_robot(&[0, 1, 2, 3, 6, 6, 6], random);
        for joint in robot.links.iter_mut().filter_map(|link| link.joint.as_mut()) {
            // A body without a joint cannot be locked.
            joint.locked &= joint.kind != 3;
        }
        robot
    }

    /// Returns the robot as an MJCF file. `inside` returns additional text for the body of each link, and
    /// `behind` is inserted after the bodies.
    pub fn mjcf_text(&self, inside: &dyn Fn(usize) -> String, behind: &str) -> String {
        let mimic_constraint_text = |link: &Link| {
            let joint = link.joint.as_ref()?;
            let (leader, factor, offset) = joint.mimic.filter(|_| !joint.locked)?;
            let leader = &self.links[leader].joint.as_ref()?.name;
            Some(format!(
                "<joint joint1=\"{}\" joint2=\"{leader}\" polycoef=\"{offset:?} {factor:?}\"/>",
                joint.name
            ))
        };
        let couplings: String = self.links.iter().filter_map(mimic_constraint_text).collect();
        format!(
            "<mujoco><compiler angle=\"radian\" eulerseq=\"XYZ\"/>\n<worldbody>{}</worldbody>\n\
             <equality>{couplings}</equality>\n{behind}</mujoco>",
            self.mjcf_body(0, inside)
        )
    }

    fn mjcf_body(&self, k: usize, inside: &dyn Fn(usize) -> String) -> String {
        let Link { name, mass, com, inertia, joint, .. } = &self.links[k];
        let (place, own) = match joint {
            None if self.free => (String::new(), "<freejoint name=\"root_joint\"/>".to_string()),
            None => (String::new(), String::new()),
            Some(joint) => {
                let Joint { name, xyz, rpy, axis, .. } = joint;
                let own = match KINDS[joint.kind] {
                    "fixed" => String::new(),
                    "prismatic" => {
                        format!(
                            "<joint name=\"{name}\" type=\"slide\" axis=\"{}\"/>",
                            space_separated_text(*axis)
                        )
                    }
                    "spherical" => format!("<joint name=\"{name}\" type=\"ball\"/>"),
                    _ => format!("<joint name=\"{name}\" axis=\"{}\"/>", space_separated_text(*axis)),
                };
                (
                    format!(
                        " pos=\"{}\" euler=\"{}\"",
                        space_separated_text(*xyz),
                        space_separated_text(*rpy)
                    ),
                    own,
                )
            }
        };
        let joint_of_link = |k: usize| self.links[k].joint.as_ref();
        let mut children: Vec<usize> = (1..self.links.len())
            .filter(|child| joint_of_link(*child).is_some_and(|joint| joint.parent == k))
            .collect();
        children.sort_by_key(|k| joint_of_link(*k).map(|joint| joint.name.clone()));
        let children: String = children.into_iter().map(|child| self.mjcf_body(child, inside)).collect();
        let ([xx, xy, xz], [_, yy, yz], [_, _, zz]) = (inertia[0], inertia[1], inertia[2]);
        format!(
            "<body name=\"{name}\"{place}>{own}<inertial mass=\"{mass:?}\" pos=\"{}\" fullinertia=\"{xx:?} \
             {yy:?} {zz:?} {xy:?} {xz:?} {yz:?}\"/>{}{children}</body>\n",
            space_separated_text(*com),
            inside(k)
        )
    }

    /// Returns whether the link `carrier` equals the link `carried` or is an ancestor of it.
    pub fn is_link_or_ancestor(&self, carrier: usize, carried: usize) -> bool {
        carrier == carried
            || self.links[carried]
                .joint
                .as_ref()
                .is_some_and(|joint| self.is_link_or_ancestor(carrier, joint.parent))
    }

    /// Returns the pose of a frame on a link; its orientation is `R_z R_y R_x` of the angles.
    pub fn pose_of_frame(&self, link: usize, xyz: [f64; 3], rpy: [f64; 3], state: &State) -> Pose {
        compose_poses(
            &self.poses_of_links(state)[link],
            &Pose { r: rotation_of_rpy(rpy), p: constant_vector(xyz) },
        )
    }

    fn write_urdf_joint(&self, text: &mut String, child: usize) {
        let Some(joint) = &self.links[child].joint else { return };
        let mimic = joint.mimic.map(|(leader, factor, offset)| {
            let leader = self.links[leader].joint.as_ref().map_or("", |joint| &joint.name);
            format!("<mimic joint=\"{leader}\" multiplier=\"{factor:?}\" offset=\"{offset:?}\"/>")
        });
        let _ = writeln!(
            text,
            "<joint name=\"{}\" type=\"{}\"><child link=\"{}\"/><axis xyz=\"{}\"/>\
             <origin rpy=\"{}\" xyz=\"{}\"/>{}<parent link=\"{}\"/></joint>",
            joint.name,
            KINDS[joint.kind],
            self.links[child].name,
            space_separated_text(joint.axis),
            space_separated_text(joint.rpy),
            space_separated_text(joint.xyz),
            mimic.unwrap_or_default(),
            self.links[joint.parent].name
        );
    }

    pub fn locked_joint_names(&self) -> impl Iterator<Item = &str> {
        self.links.iter().filter_map(|link| link.joint.as_ref()).filter(|j| j.locked).map(|j| j.name.as_str())
    }

    /// Counts the types of the joints that are not locked.
    pub fn count_joint_types(&self, kinds: &mut [usize; 7]) {
        let joints = self.links.iter().filter_map(|link| link.joint.as_ref()).filter(|joint| !joint.locked);
        joints.for_each(|joint| kinds[joint.kind] += 1);
    }

    /// Returns the link indices in depth-first order; links of one parent are sorted by the names of their
    /// joints.
    fn links_depth_first(&self) -> Vec<usize> {
        let (mut order, mut open) = (Vec::new(), vec![0]);
        while let Some(link) = open.pop() {
            order.push(link);
            let joint_of_link = |k: usize| self.links[k].joint.as_ref();
            let mut children: Vec<usize> = (1..self.links.len())
                .filter(|k| joint_of_link(*k).is_some_and(|j| j.parent == link))
                .collect();
            children.sort_by_key(|k| std::cmp::Reverse(joint_of_link(*k).map(|j| j.name.clone())));
            open.extend(children);
        }
        order
    }

    /// Returns the names of the entries of the configuration `q`.
    pub fn coordinate_names(&self) -> Vec<String> {
        const PLACE: [&str; 7] = ["x", "y", "z", "qx", "qy", "qz", "qw"];
        let mut names = Vec::new();
        for link in self.links_depth_first() {
            let name = self.links[link].joint.as_ref().map_or("root_joint", |joint| &joint.name);
            match self.links[link].joint_entry_counts(self.free) {
                [0, _] => {}
                [1, _] => names.push(name.to_string()),
                [3, _] => names.extend(["x", "y", "angle"].map(|entry| format!("{name}.{entry}"))),
                [n, _] => names.extend(PLACE[7 - n..].iter().map(|entry| format!("{name}.{entry}"))),
            }
        }
        names
    }

    /// Returns for each link the indices of the first entries of its joint in `q` and `v`.
    fn joint_start_indices(&self) -> Vec<[usize; 2]> {
        let (mut entries, mut next) = (vec![[0; 2]; self.links.len()], [0; 2]);
        for link in self.links_depth_first() {
            entries[link] = next;
            let [q, v] = self.links[link].joint_entry_counts(self.free);
            next = [next[0] + q, next[1] + v];
        }
        entries
    }

    /// Returns random `q`, `v` and `v̇`; quaternions in `q` are normalised.
    pub fn random_state(&self, random: &mut Random) -> [Vec<f64>; 3] {
        let entries = self.joint_start_indices();
        let total_size =
            |k: usize| self.links.iter().map(|link| link.joint_entry_counts(self.free)[k]).sum::<usize>();
        let mut random_numbers =
            |n: usize| -> Vec<f64> { (0..n).map(|_| random.four_digit_number()).collect() };
        let (mut q, v, a) =
            (random_numbers(total_size(0)), random_numbers(total_size(1)), random_numbers(total_size(1)));
        for (link, [first, _]) in self.links.iter().zip(entries) {
            let [n, _] = link.joint_entry_counts(self.free);
            if n == 4 || n == 7 {
                let quaternion = &mut q[first + n - 4..first + n];
                let norm = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
                quaternion.iter_mut().for_each(|x| *x /= norm);
            }
        }
        [q, v, a]
    }

    /// Returns whether a link can move relative to the ground.
    pub fn can_move_link(&self, link: usize) -> bool {
        match &self.links[link].joint {
            None => self.free,
            Some(joint) => (joint.kind != 3 && !joint.locked) || self.can_move_link(joint.parent),
        }
    }

    /// Returns axes and origin of every link relative to the ground.
    fn poses_of_links(&self, state: &State) -> Vec<Pose> {
        let entries = self.joint_start_indices();
        let mut places: Vec<Pose> = Vec::new();
        for (k, link) in self.links.iter().enumerate() {
            let Some(joint) = &link.joint else {
                places.push(if self.free { floating_pose(state, entries[k]) } else { Pose::identity_pose() });
                continue;
            };
            let start = Pose { r: rotation_of_rpy(joint.rpy), p: constant_vector(joint.xyz) };
            let moved = match joint.mimic {
                _ if joint.locked => Pose::identity_pose(),
                Some((leader, factor, offset)) => {
                    let angle = coordinate_series(state, entries[leader]);
                    joint.joint_pose_at_coordinate(
                        angle * Jet::constant_series(factor) + Jet::constant_series(offset),
                    )
                }
                None if joint.kind < 3 => {
                    joint.joint_pose_at_coordinate(coordinate_series(state, entries[k]))
                }
                None => joint.joint_pose_at_state(state, entries[k]),
            };
            let there = compose_poses(&places[joint.parent], &start);
            places.push(compose_poses(&there, &moved));
        }
        places
    }

    /// Returns the moving bodies of the robot with their masses and poses.
    pub fn moving_bodies(&self, state: &State) -> Vec<MovingBody> {
        let places = self.poses_of_links(state);
        let moving = (0..self.links.len()).filter(|k| self.can_move_link(*k));
        let moving_body_of_link = |k: usize| {
            let Link { mass, com, inertia, .. } = self.links[k];
            let center = Pose { r: identity_matrix(), p: constant_vector(com) };
            MovingBody { mass, inertia, r: places[k].r, p: compose_poses(&places[k], &center).p }
        };
        moving.map(moving_body_of_link).collect()
    }
}

impl Joint {
    fn unit_axis(&self) -> [f64; 3] {
        let length = self.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        self.axis.map(|x| x / length)
    }

    /// Returns the pose of a joint that rotates about its axis or slides along it, at a value of its
    /// coordinate.
    fn joint_pose_at_coordinate(&self, coordinate: Jet) -> Pose {
        match KINDS[self.kind] {
            "prismatic" => Pose { p: scaled_vector(coordinate, self.unit_axis()), ..Pose::identity_pose() },
            _ => Pose { r: rotation_about_axis(self.unit_axis(), coordinate), ..Pose::identity_pose() },
        }
    }

    /// Returns the pose of a joint with several coordinates, or none.
    fn joint_pose_at_state(&self, state: &State, [q, v]: [usize; 2]) -> Pose {
        match KINDS[self.kind] {
            "floating" => floating_pose(state, [q, v]),
            "planar" => {
                let normal = self.axis.iter().position(|x| *x != 0.0).unwrap_or(0);
                let in_plane_unit_axis = |k: usize| from_fn(|i| f64::from(u8::from(i == (normal + k) % 3)));
                let planar_shift_along = |k: usize| {
                    scaled_vector(coordinate_series(state, [q + k - 1, v + k - 1]), in_plane_unit_axis(k))
                };
                let r = rotation_about_axis(self.unit_axis(), coordinate_series(state, [q + 2, v + 2]));
                Pose { r, p: sum_of_vectors(planar_shift_along(1), planar_shift_along(2)) }
            }
            "spherical" => {
                let r = rotating_orientation(
                    &state.q[q..q + 4],
                    three_entries_from(&state.v, v),
                    three_entries_from(&state.a, v),
                );
                Pose { r, ..Pose::identity_pose() }
            }
            _ => Pose::identity_pose(),
        }
    }
}

/// Returns a joint coordinate as a Taylor series in time.
fn coordinate_series(state: &State, [q, v]: [usize; 2]) -> Jet {
    Jet([state.q[q], state.v[v], state.a[v] * 0.5])
}

fn three_entries_from(list: &[C], at: usize) -> [C; 3] {
    from_fn(|k| list[at + k])
}

/// Returns the pose from position and quaternion; linear and angular velocity are in body axes.
fn floating_pose(state: &State, [q, v]: [usize; 2]) -> Pose {
    let (w, rate) = (three_entries_from(&state.v, v + 3), three_entries_from(&state.a, v + 3));
    let r = rotating_orientation(&state.q[q + 3..q + 7], w, rate);
    Pose {
        r,
        p: position_moving_with_velocity(
            &state.q[q..q + 3],
            &r,
            three_entries_from(&state.v, v),
            w,
            three_entries_from(&state.a, v),
        ),
    }
}
