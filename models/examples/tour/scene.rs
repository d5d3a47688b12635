//! Moving pictures in space, as data for `player.js`: points that move, and the parts that are drawn between
//! them.

use linkwork::nalgebra::{IsometryMatrix3, Point3};
use std::fmt::Write;

/// A point in space: x to the right, y away, z up, m.
pub type Point = [f64; 3];

/// A moving picture.
pub struct Scene {
    /// What it shows.
    pub title: &'static str,
    /// Pictures per second of simulated time.
    pub rate: f64,
    /// Seconds shown per second watched.
    pub speed: f64,
    /// What is drawn, by the indices of points.
    pub parts: Vec<Part>,
    /// Where the points are, picture by picture.
    pub frames: Vec<Vec<Point>>,
    /// The instant, s, that a picture that does not move shows.
    pub still: f64,
    /// Words from a picture on.
    pub captions: Vec<(usize, String)>,
    /// Lines that do not move.
    pub guides: Vec<Vec<Point>>,
    /// A point that leaves a trail, and for how many pictures.
    pub trail: Option<(usize, usize)>,
    /// From where it is seen.
    pub view: View,
}

/// Something drawn between points.
pub enum Part {
    /// A round bar with its radius, m.
    Rod(usize, usize, f64, Tone),
    /// A ball with its radius, m.
    Ball(usize, f64, Tone),
    /// A flat face.
    Face(Vec<usize>, Tone),
    /// An arrow from one point to another.
    Arrow(usize, usize, Tone),
}

/// Colour of a part; the page says what it looks like.
#[derive(Clone, Copy)]
pub enum Tone {
    /// The main body.
    Body,
    /// Joints and other ironware.
    Dark,
    /// What is to be watched.
    Accent,
    /// The other side.
    Second,
}

/// From where a scene is seen.
pub struct View {
    /// The point in the middle.
    pub target: Point,
    /// What has to fit, m: width and height.
    pub size: [f64; 2],
    /// Direction of sight about the vertical, degrees.
    pub yaw: f64,
    /// Degrees from above.
    pub pitch: f64,
    /// Turning while it plays, degrees per second watched.
    pub turning: f64,
    /// Height and half width of the floor's grid, m.
    pub floor: Option<[f64; 2]>,
}

impl Scene {
    /// The scene for `player.js`. Points are in hundredths of millimetres.
    pub fn json(&self) -> String {
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
        let parts: Vec<String> = self.parts.iter().map(Part::json).collect();
        let captions: Vec<String> =
            self.captions.iter().map(|(k, words)| format!("[{k},{words:?}]")).collect();
        let _ = write!(
            out,
            "\"parts\":[{}],\"captions\":[{}],\"guides\":[{}],\"frames\":[{}]}}",
            parts.join(","),
            captions.join(","),
            join(&self.guides),
            join(&self.frames)
        );
        out
    }
}

impl Part {
    fn json(&self) -> String {
        match self {
            Self::Rod(a, b, radius, tone) => format!("[\"rod\",{a},{b},{radius},{}]", *tone as u8),
            Self::Ball(a, radius, tone) => format!("[\"ball\",{a},{radius},{}]", *tone as u8),
            Self::Face(points, tone) => format!("[\"face\",{points:?},{}]", *tone as u8),
            Self::Arrow(a, b, tone) => format!("[\"arrow\",{a},{b},{}]", *tone as u8),
        }
    }
}

fn join(lists: &[Vec<Point>]) -> String {
    let list = |points: &Vec<Point>| {
        let numbers: Vec<String> =
            points.iter().flatten().map(|x| format!("{}", (x * 1e5).round() as i64)).collect();
        format!("[{}]", numbers.join(","))
    };
    lists.iter().map(list).collect::<Vec<_>>().join(",")
}

/// A point of a body in space.
pub fn point(body: &IsometryMatrix3<f64>, at: Point) -> Point {
    (body * Point3::from(at)).coords.into()
}

/// The eight corners of a box with the given half sizes about a point of a body.
pub fn corners(body: &IsometryMatrix3<f64>, at: Point, half: Point) -> [Point; 8] {
    let signs = |k: usize| [k & 1, k >> 1 & 1, k >> 2 & 1].map(|bit| 2.0 * bit as f64 - 1.0);
    std::array::from_fn(|k| {
        let s = signs(k);
        point(body, [0, 1, 2].map(|i| at[i] + s[i] * half[i]))
    })
}

/// The six faces of a box whose corners start with the point `first`.
pub fn faces(first: usize, tone: Tone) -> impl Iterator<Item = Part> {
    let sides = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]];
    sides.into_iter().map(move |side| Part::Face(side.map(|k| first + k).to_vec(), tone))
}
