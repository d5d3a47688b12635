//! Animated scenes as data for `player.js`: moving points, and the parts that are drawn between them.

use linkwork::nalgebra::{IsometryMatrix3, Point3};
use std::fmt::Write;

/// Point in space: x to the right, y away from the viewer, z up, m.
pub type Point = [f64; 3];

/// Animated scene of a mechanism: moving points, and parts drawn between them.
pub struct Scene {
    /// Title of the scene.
    pub title: &'static str,
    /// Frames per second of simulated time.
    pub rate: f64,
    /// Simulated seconds per second of playback.
    pub speed: f64,
    /// Drawn parts of the scene, which refer to points by index.
    pub parts: Vec<Part>,
    /// Positions of all points in each frame of the animation.
    pub frames: Vec<Vec<Point>>,
    /// Time of the frame that the page shows as a picture (address with `#picture`), s.
    pub still: f64,
    /// Captions of the scene, each with its first frame.
    pub captions: Vec<(usize, String)>,
    /// Fixed lines of the scene, as lists of points.
    pub guides: Vec<Vec<Point>>,
    /// Index of a point that leaves a trail, and the length of the trail in frames.
    pub trail: Option<(usize, usize)>,
    /// Viewpoint of the scene.
    pub view: View,
}

/// Shape that is drawn between points.
pub enum Part {
    /// Cylinder between two points with its radius, m.
    Rod(usize, usize, f64, Tone),
    /// Sphere about a point with its radius, m.
    Ball(usize, f64, Tone),
    /// Polygon with these points as corners.
    Face(Vec<usize>, Tone),
    /// Arrow from one point to another.
    Arrow(usize, usize, Tone),
}

/// Colour of a part, whose appearance the page defines.
#[derive(Clone, Copy)]
pub enum Tone {
    /// Colour of the main body of the mechanism.
    Body,
    /// Colour of joints and other small parts.
    Dark,
    /// Colour of highlighted parts.
    Accent,
    /// Colour of a contrasting part.
    Second,
}

/// Viewpoint from which a scene is drawn.
pub struct View {
    /// Point at the centre of the view, m.
    pub target: Point,
    /// Width and height of the visible region, m.
    pub size: [f64; 2],
    /// Direction of view about the vertical, degrees.
    pub yaw: f64,
    /// Elevation of the viewpoint, degrees.
    pub pitch: f64,
    /// Rate of rotation of the view during playback, degrees per second.
    pub turning: f64,
    /// Height and half width of the floor's grid, m.
    pub floor: Option<[f64; 2]>,
}

impl Scene {
    /// Returns the scene as JSON for `player.js`. Points are in hundredths of millimetres.
    pub fn scene_json(&self) -> String {
        let mut out = format!(
            "{{\"rate\":{},\"speed\":{},\"still\":{},\"target\":{:?},\"size\":{:?},\"yaw\":{},\"pitch\":{},\"turning\":{},",
            self.rate,
            self.speed,
            self.still,
            self.view.target,
            self.view.size,
            self.view.yaw,
            self.view.pitch,
            self.view.turning
        );
        if let Some(floor) = self.view.floor {
            let _ = write!(out, "\"floor\":{floor:?},");
        }
        if let Some((point, length)) = self.trail {
            let _ = write!(out, "\"trail\":[{point},{length}],");
        }
        let parts: Vec<String> = self.parts.iter().map(Part::part_json).collect();
        let captions: Vec<String> =
            self.captions.iter().map(|(k, words)| format!("[{k},{words:?}]")).collect();
        let _ = write!(
            out,
            "\"parts\":[{}],\"captions\":[{}],\"guides\":[{}],\"frames\":[{}]}}",
            parts.join(","),
            captions.join(","),
            point_lists_json(&self.guides),
            point_lists_json(&self.frames)
        );
        out
    }
}

impl Part {
    fn part_json(&self) -> String {
        match self {
            Self::Rod(a, b, radius, tone) => format!("[\"rod\",{a},{b},{radius},{}]", *tone as u8),
            Self::Ball(a, radius, tone) => format!("[\"ball\",{a},{radius},{}]", *tone as u8),
            Self::Face(points, tone) => format!("[\"face\",{points:?},{}]", *tone as u8),
            Self::Arrow(a, b, tone) => format!("[\"arrow\",{a},{b},{}]", *tone as u8),
        }
    }
}

fn point_lists_json(lists: &[Vec<Point>]) -> String {
    let points_json = |points: &Vec<Point>| {
        let numbers: Vec<String> =
            points.iter().flatten().map(|x| format!("{}", (x * 1e5).round() as i64)).collect();
        format!("[{}]", numbers.join(","))
    };
    lists.iter().map(points_json).collect::<Vec<_>>().join(",")
}

/// Returns a point of a body, given in body axes, in ground coordinates.
pub fn point_in_ground(body: &IsometryMatrix3<f64>, at: Point) -> Point {
    (body * Point3::from(at)).coords.into()
}

/// Returns the eight corners of a box with the given half sizes about a point of a body.
pub fn corners_of_box(body: &IsometryMatrix3<f64>, at: Point, half: Point) -> [Point; 8] {
    let signs_of_corner = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 2.0 * bit as f64 - 1.0);
    std::array::from_fn(|k| {
        let s = signs_of_corner(k);
        point_in_ground(body, [0, 1, 2].map(|i| at[i] + s[i] * half[i]))
    })
}

/// Returns the six faces of a box whose corners start with the point `first`.
pub fn faces_of_box(first: usize, tone: Tone) -> impl Iterator<Item = Part> {
    let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    sides.into_iter().map(move |side| Part::Face(side.map(|k| first + k).to_vec(), tone))
}
