//! Checks scenes with more contact points than one mechanism has, whose pairs of surfaces are evaluated
//! separately.

use linkwork_jit::{Error, Loader, Method, Overlaps, Robot};

const FLOOR: &str = "<geom name='floor' type='plane'/>";

/// Loads a scene from a temporary file. `test` names the file.
fn load_scene(test: &str, bodies: &str) -> Result<Robot, Error> {
    let path = std::env::temp_dir().join(format!("linkwork-many-{test}-{}.xml", std::process::id()));
    std::fs::write(&path, format!("<mujoco><worldbody>{FLOOR}{bodies}</worldbody></mujoco>"))
        .expect("a temporary file");
    let robot = Loader::file(&path).options("contacts = file").load();
    std::fs::remove_file(&path).expect("the file is there");
    robot
}

/// Returns a floating body of the file at a position, with shapes.
fn body(name: &str, position: [f64; 3], shapes: &str) -> String {
    let [x, y, z] = position;
    format!("<body name='{name}' pos='{x} {y} {z}' euler='20 -15 10'><freejoint/>{shapes}</body>")
}

/// Returns bricks whose edges are along the axes: half lengths, and positions.
fn bricks(half: [f64; 3], positions: &[[f64; 3]]) -> String {
    let [a, b, c] = half;
    let bricks = positions.iter().enumerate().map(|(k, [x, y, z])| {
        format!(
            "<body name='brick{k}' pos='{x} {y} {z}'><freejoint/><geom type='box' size='{a} {b} {c}' \
             mass='2'/></body>"
        )
    });
    bricks.collect()
}

/// Bodies of several shapes, some of them rotated on their bodies, tumble onto the floor and onto each other.
/// Bricks at rest far away make the contacts of the scene separate; the motion is the same without them.
#[test]
fn distant_bricks_do_not_change_a_motion() -> Result<(), Error> {
    let tumbling = [
        body("box", [0.0, 0.0, 0.2], "<geom type='box' size='.1 .06 .04' pos='.01 0 .02' euler='0 0 30'/>"),
        body("capsule", [0.05, 0.02, 0.4], "<geom type='capsule' size='.04 .08' euler='0 60 0'/>"),
        body("ball", [-0.06, 0.03, 0.5], "<geom size='.05' condim='6'/>"),
    ]
    .concat();
    let places: Vec<[f64; 3]> = (0..7).map(|k| [5.0 + f64::from(k), 0.0, 0.1]).collect();
    let alone = load_scene("alone", &tumbling)?;
    let many = load_scene("beside", &format!("{tumbling}{}", bricks([0.2, 0.15, 0.1], &places)))?;
    assert!(alone.contacts() <= 128 && many.contacts() > 400, "{} {}", alone.contacts(), many.contacts());
    let end_of_motion =
        |robot: &Robot| robot.simulate().method(Method::TimeStepping(1e-3)).duration(0.3).finish();
    let (one, other) = (end_of_motion(&alone)?, end_of_motion(&many)?);
    // The bodies have hit the floor and each other.
    assert!(one.q[2] < 0.13 && one.q[16] < 0.3, "{:?}", one.q);
    for (k, (a, b)) in one.q.iter().zip(&other.q).enumerate() {
        assert!((a - b).abs() < 1e-7, "q[{k}]: {a} and {b}");
    }
    for k in 0..7 {
        let [x, z] = [other.q[21 + 7 * k], other.q[23 + 7 * k]];
        assert!((x - 5.0 - k as f64).abs() < 1e-9 && (z - 0.1).abs() < 1e-9, "brick {k} at {x}, {z}");
    }
    Ok(())
}

/// A wall of twelve bricks stays where it is, although its contact forces are not unique.
#[test]
fn wall_of_bricks_stays_where_it_is() -> Result<(), Error> {
    let places: Vec<[f64; 3]> = (0..12)
        .map(|k| {
            let (row, column) = (k / 4, k % 4);
            [0.402 * f64::from(column) + 0.2 * f64::from(row % 2), 0.0, 0.1 + 0.2 * f64::from(row)]
        })
        .collect();
    let robot = load_scene("wall", &bricks([0.2, 0.1, 0.1], &places))?;
    let end = robot.simulate().method(Method::TimeStepping(1e-3)).duration(0.02).finish()?;
    for (k, [x, y, z]) in places.iter().enumerate() {
        let distance = (end.q[7 * k] - x).abs() + (end.q[7 * k + 1] - y).abs() + (end.q[7 * k + 2] - z).abs();
        assert!(distance < 1e-8, "brick {k} moved by {distance:e} m");
    }
    assert!(end.v.iter().all(|v| v.abs() < 1e-8), "{:?}", end.v);
    Ok(())
}

/// Overlapping surfaces are named at the start, and can be moved apart; events of more than 128 contacts are
/// refused.
#[test]
fn overlaps_and_events_of_many_contacts() -> Result<(), Error> {
    let mut places: Vec<[f64; 3]> = (0..10).map(|k| [f64::from(k), 0.0, 0.1]).collect();
    places[4] = [3.3, 0.0, 0.1];
    let robot = load_scene("overlap", &bricks([0.2, 0.15, 0.1], &places))?;
    let refused = robot.simulate().method(Method::TimeStepping(1e-3)).duration(0.01).finish().unwrap_err();
    let message = refused.to_string();
    assert!(message.contains("brick3") && message.contains("brick4") && message.contains("0.1"), "{message}");
    let parted = robot.simulate().overlaps(Overlaps::Part).method(Method::TimeStepping(1e-3));
    let end = parted.duration(0.01).finish()?;
    // Both have the same mass.
    assert!((end.q[21] - 2.95).abs() < 1e-6 && (end.q[28] - 3.35).abs() < 1e-6, "{:?}", &end.q[21..35]);
    let message = robot.simulate().method(Method::EventDriven(1e-9)).duration(0.01).finish().unwrap_err();
    assert!(message.to_string().contains("time_stepping"), "{message}");
    let message = robot.padded_contacts::<72, 72, 72, 128, 384>().unwrap_err().to_string();
    assert!(message.contains("simulate"), "{message}");
    Ok(())
}

/// A contact of many whose surfaces are not supported is an error that names it.
#[test]
fn errors_of_separate_contacts_name_them() {
    let contacts: String = (0..10)
        .map(|k| {
            let height = if k == 7 { 0 } else { 1 };
            format!(
                "#[body(mass = 1, inertia = sphere(1, 0.1))] b{k}: Body,
                #[joint(ground -> b{k})] j{k}: Free,
                #[contact(b{k}.cuboid(1, 2, 3), ground.plane(z))] floor{k}: Contact,
                #[contact(
                    b{k}.cuboid(1, 2, 3),
                    b0.at([0, 0, {k}]).hull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, {height}]])
                )]
                pair{k}: Contact,"
            )
        })
        .collect();
    let contacts = contacts.replacen("b0.at([0, 0, 0])", "ground.at([0, 0, 0])", 1);
    let text = format!("#[mechanism(gravity = -9.81 * z)] struct Many {{ {contacts} }}");
    let message = linkwork_jit::declare(&text).unwrap_err().to_string();
    assert!(message.contains("`pair7`") && !message.contains("pair6"), "{message}");
}
