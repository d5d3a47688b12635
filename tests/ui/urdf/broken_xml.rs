use linkwork::prelude::*;

#[mechanism(urdf = "urdf/broken_xml.urdf")]
struct Robot;

fn main() {}
