//! Randomly modified mechanisms. For any tokens, the compiler does not panic, its output is valid Rust, and
//! its time and stack are bounded. The random numbers are seeded, so failures are reproducible.

mod sizes;

use linkwork_compiler::expand;
use linkwork_compiler::syntax::guard::MAX_STACK;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use sizes::mechanism_with_mass;
use std::path::Path;
use std::time::{Duration, Instant};

/// Maximum time of one macro expansion in a debug build on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Initial mechanisms, which cover the whole language and planned extensions.
const MECHANISMS: [&str; 12] = [
    "gravity = -g * y; pub struct DoublePendulum {
        pub g: f64, pub m1: f64, pub m2: f64, pub l1: f64, pub l2: f64,
        #[body(mass = m1, com = -l1 / 2 * y, inertia = rod(m1, l1, y))] upper: Body,
        #[body(mass = m2, com = -l2 / 2 * y, inertia = rod(m2, l2, y))] lower: Body,
        #[joint(ground -> upper, about = z)] shoulder: Pin,
        #[joint(upper.at(-l1 * y) -> lower, about = z)] elbow: Pin,
    }",
    "gravity = -g * z; pub struct BeadOnSpinningHoop {
        pub g: f64, pub m: f64, pub radius: f64, pub spin: f64,
        theta: Coordinate,
        #[frame(ground, z(spin * t))] hoop: Frame,
        #[particle(mass = m, at = radius * (sin(theta) * hoop.x - cos(theta) * hoop.z))] bead: Particle,
    }",
    "; pub struct TunedSuspension<T> {
        pub m1: T, pub m2: T, pub k1: T, pub c: T, pub b: T,
        #[body(mass = m1)] first: Body,
        #[body(mass = m2)] second: Body,
        #[joint(ground -> first, along = x)] rail: Sleeve,
        #[joint(first -> second, along = x)] rail2: Sleeve,
        #[acts(on = rail, stiffness = k1, free_length = b)] anchor: Spring,
        #[acts(on = rail2, damping = c)] damper: Dashpot,
    }",
    "; pub struct Inerters {
        pub m1: f64, pub k2: f64, pub b: f64,
        #[body(mass = m1)] first: Body,
        #[joint(ground -> first, along = x)] rail: Sleeve,
        #[acts(between = (ground, first), stiffness = k2, free_length = 0)] coil: Spring,
        #[acts(between = (ground, first), inertance = b)] inerter: Inerter,
    }",
    "gravity = -9.81 * z; pub struct Gyroscope {
        pub mass: f64, pub axial: f64, pub transverse: f64,
        #[body(mass = 0, inertia = 0)] outer: Body,
        #[body(mass = 0, inertia = 0)] inner: Body,
        #[body(mass = mass, inertia = diagonal(transverse, transverse, axial))] rotor: Body,
        #[joint(ground -> outer, about = z)] precession: Pin,
        #[joint(outer -> inner, about = x)] nutation: Pin,
        #[joint(inner -> rotor, about = z)] spin: Pin,
        #[acts(on = rotor, about = inner.x + ground.z)] motor: Torque,
    }",
    "gravity = -9.81 * y; pub struct SliderCrank {
        pub r: f64, pub l: f64,
        #[body(mass = 1, com = r / 2 * x, inertia = rod(1, r, x))] crank: Body,
        #[body(mass = 2, com = l / 2 * x, inertia = rod(2, l, x))] rod: Body,
        #[body(mass = 3)] piston: Body,
        #[joint(ground -> crank, about = z)] main: Pin,
        #[joint(crank.at(r * x) -> rod, about = z)] big_end: Pin,
        #[joint(ground -> piston, along = x)] cylinder: Sleeve,
        #[joint(rod.at(l * x) -> piston, about = z)] small_end: Pin,
        #[acts(on = main)] motor: Torque,
    }",
    "gravity = -9.81 * z; pub struct RollingDisk {
        pub m: f64, pub radius: f64,
        #[body(mass = m, inertia = disk(m, radius, y))] disk: Body,
        #[joint(ground -> disk)] pose: Free,
        #[constraint(rolls(disk.circle(radius, y), ground.plane(z)))] contact: Rolling,
        #[constraint(slips(disk.at(m * y).sphere(radius), ground.plane(z)), friction = m, speed = radius)] rub: Slipping,
    }",
    "gravity = 9.81 * z, friction_speed = 0.1; pub struct Aircraft {
        pub m: f64, pub ixx: f64, pub izz: f64, pub ixz: f64,
        #[body(mass = m, inertia = [[ixx, 0, ixz], [0, 1, 0], [ixz, 0, izz]])] airframe: Body,
        #[joint(ground -> airframe)] flight: Free,
        #[acts(on = airframe.at(m * x), along = sin(m) * airframe.x - cos(m) * airframe.z)] lift: Force,
    }",
    "scalar = f32; struct Joints {
        #[body(mass = 1, inertia = sphere(1, 0.5))] a: Body,
        #[body(mass = 1, inertia = cuboid(1, 0.5, 1, 2).rotated(z(1), eigenaxis(unit(x + y), 0.5)))] b: Body,
        #[body(mass = 1, inertia = capsule(1, 0.5, 1, unit([1, 2, 2])))] c: Body,
        #[particle(mass = 1, at = b.at([1, 2, 3]))] p: Particle,
        #[joint(ground -> a, along = x, about = y)] slot: Slot,
        #[joint(a.at(x).rotated(x(pi / 2)) -> b.at(y), about = (x, y))] cross: Universal,
        #[joint(b -> c, about = z, lead = 0.01)] thread: Screw,
        #[acts(on = slot.slide, stiffness = 2, free_length = 1)] spring: Spring,
    }",
    "; struct Planes {
        #[body(mass = 1, inertia = tube(1, 0.1, 0.2, 1, x))] a: Body,
        #[body(mass = 1, inertia = cone(1, 0.5, 1, z) + shell(1, 2))] b: Body,
        #[joint(ground -> a, about = y)] table: Planar,
        #[joint(a -> b)] socket: Ball,
        #[acts(on = table.angle)] turn: Torque,
    }",
    "urdf = \"urdf/arm.urdf\", base = free, lock = [\"elbow\"], inputs = none; pub struct Arm { m: f64,
        #[body(mass = m)] tool: Body,
        #[joint(lower.at(z) -> tool)] flange: Weld,
        #[acts(on = shoulder, damping = 1)] friction: Dashpot,
    }",
    "gravity = [0, -9.81, 0]; struct Stages<Scalar: Copy> where Scalar: Copy { m: Scalar, _n: Scalar,
        #[body(mass = m, com = cross([0, 1, m], z) + dot(x, y) * z)] stage: Body,
        #[joint(ground.at(min(m, 2) * x) -> stage, along = (x, unit(x + y)))] table: Stage,
        #[acts(on = table.y)] push: Force,
    }",
];

/// Words that the fuzzer inserts at random places of a mechanism.
const WORDS: &str = "f64 f32 T self crate super Self ground x y z t pi q v 0 1 2 1e999 1e-999 -1 0.5 99999999999999999999 \
    1u8 2.5f32 'a' \"text\" b\"x\" Body Particle Pin Sleeve Screw Collar Slot Universal Ball Planar Stage Free Weld Spring \
    Dashpot Force Torque Inerter Coordinate Vec mass com inertia about along on at rotated pitch lead damping stiffness \
    massive between value urdf lock + - * / = -> <- => , ; : :: . .. ..= < > ! ? & | ^ % # @ $ ~ == <= && << += 'a \
    r#type größe sin cos sqrt ln acos pow atan2 dot cross norm unit rod sphere diagonal box pub struct enum fn where impl dyn for \
    if match loop _ __link0 () [] {} (x) [1,2,3] {a}";

/// Random number generator (SplitMix64).
struct Random(u64);

impl Random {
    fn next_random_integer(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn index_below(&mut self, n: usize) -> usize {
        (self.next_random_integer() % n.max(1) as u64) as usize
    }
}

/// Returns the arguments and the item of a mechanism in the list.
fn split_listed_mechanism(text: &str) -> (TokenStream, TokenStream) {
    let (arguments, item) = text.split_once(';').unwrap();
    (arguments.parse().unwrap(), item.parse().unwrap())
}

/// Applies one random mutation to a token stream.
fn mutate_tokens(tokens: TokenStream, words: &[TokenTree], random: &mut Random) -> TokenStream {
    let mut list: Vec<TokenTree> = tokens.into_iter().collect();
    let groups: Vec<usize> = (0..list.len()).filter(|k| matches!(list[*k], TokenTree::Group(_))).collect();
    // Most of the tokens are inside groups.
    if !groups.is_empty() && random.index_below(5) > 0 {
        let at = groups[random.index_below(groups.len())];
        if let TokenTree::Group(group) = &list[at] {
            let mut inside = Group::new(group.delimiter(), mutate_tokens(group.stream(), words, random));
            inside.set_span(group.span());
            list[at] = inside.into();
        }
        return list.into_iter().collect();
    }
    let (at, other) = (random.index_below(list.len()), random.index_below(list.len()));
    let word = words[random.index_below(words.len())].clone();
    match random.index_below(8) {
        _ if list.is_empty() => list.push(word),
        0 => drop(list.remove(at)),
        1 => list.insert(at, list[other].clone()),
        2 => list.swap(at, other),
        3 => list[at] = word,
        4 => list.insert(at, word),
        5 => list.truncate(at),
        6 => {
            let (first, last) = (at.min(other), at.max(other));
            let part: TokenStream = list.drain(first..=last).collect();
            let delimiter = [Delimiter::Parenthesis, Delimiter::Bracket, Delimiter::Brace, Delimiter::None];
            list.insert(first, Group::new(delimiter[random.index_below(4)], part).into());
        }
        _ => {
            let end = (at + 1 + random.index_below(8)).min(list.len());
            let part: Vec<TokenTree> = list[at..end].to_vec();
            list.splice(at..at, part);
        }
    }
    list.into_iter().collect()
}

/// Expands a mechanism and checks the output. `text` is shown in failures.
fn expand_and_check(arguments: TokenStream, item: TokenStream, text: &str) {
    let start = Instant::now();
    let output = expand(arguments, item, Path::new("../../tests/ui"));
    let output = format!("{} {}", output.tokens, output.text);
    let time = start.elapsed();
    assert!(time < PATIENCE, "{time:?} for {text}");
    let file = output.parse::<TokenStream>().map_err(|e| e.to_string());
    let file = file.and_then(|tokens| syn::parse2::<syn::File>(tokens).map_err(|e| e.to_string()));
    assert!(file.is_ok(), "{} of {text}\ngave {output}", file.err().unwrap_or_default());
    if !output.contains("compile_error") {
        let is_infinite_or_nan =
            |word: &str| matches!(word.trim_matches(['(', ')', ',', '-']), "inf" | "NaN");
        assert!(!output.split_whitespace().any(is_infinite_or_nan), "a number that is none, of {text}");
    }
}

/// Runs on a thread with the maximum stack that the compiler may use.
fn run_with_little_stack(run: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(MAX_STACK).spawn(run).unwrap();
    if let Err(panic) = thread.join() {
        std::panic::resume_unwind(panic);
    }
}

#[test]
fn mutated_source_neither_panics_nor_yields_invalid_output() {
    run_with_little_stack(|| {
        let words: Vec<TokenTree> =
            WORDS.split(' ').flat_map(|w| w.parse::<TokenStream>().ok()).flatten().collect();
        let mut random = Random(1);
        for round in 0..600 {
            let (mut arguments, mut item) = split_listed_mechanism(MECHANISMS[round % MECHANISMS.len()]);
            for _ in 0..=random.index_below(4) {
                if random.index_below(8) == 0 {
                    arguments = mutate_tokens(arguments, &words, &mut random);
                } else {
                    item = mutate_tokens(item, &words, &mut random);
                }
            }
            let text = format!("round {round}: #[mechanism({arguments})] {item}");
            expand_and_check(arguments, item, &text);
        }
    });
}

#[test]
fn random_tokens_are_rejected() {
    run_with_little_stack(|| {
        let words: Vec<&str> = WORDS.split(' ').collect();
        let mut random = Random(2);
        for _ in 0..800 {
            let count = random.index_below(24);
            let inside: String =
                (0..count).map(|_| words[random.index_below(words.len())].to_string() + " ").collect();
            let item = match random.index_below(4) {
                0 => inside.clone(),
                1 => format!("struct S {{ {inside} }}"),
                2 => format!(
                    "struct S {{ m: f64, #[body({inside})] b: Body, #[joint(ground -> b, about = z)] j: Pin \
                     }}"
                ),
                _ => format!("struct S {{ #[body(mass = {inside})] b: Body, #[joint({inside})] j: Pin }}"),
            };
            if let (Ok(arguments), Ok(item)) = (inside.parse(), item.parse()) {
                expand_and_check(arguments, item, &inside);
            }
        }
    });
}

#[test]
fn arguments_of_all_kinds_are_parsed() {
    run_with_little_stack(|| {
        let item = mechanism_with_mass("m");
        for arguments in [
            "urdf = \"\"",
            "urdf = \".\"",
            "urdf = \"..\"",
            "urdf = \"/\"",
            "urdf = \"/dev/zero\"",
            "urdf = \"\\0\"",
            "urdf = \"ui/../../../..\"",
            "urdf = \"größe\\u{202e}\"",
            "urdf = r##\"a\"##",
            "urdf = b\"a\"",
            "urdf = c\"a\"",
            "urdf = [\"a\"]",
            "lock = [\"a\", 1]",
            "lock = [\"a\", ]",
            "lock = []",
            "gravity",
            "gravity = ",
            "gravity = = 1",
            ", ,",
            "gravity = -9.81 * z,,",
            "-> a",
            "a ->",
            "a -> b -> c",
            "scalar = \"f64\"",
            "scalar = r#f64",
            "friction_speed = 1e999",
            "friction_speed = 0 / 0",
        ] {
            expand_and_check(arguments.parse().unwrap(), item.parse().unwrap(), arguments);
        }
        let long = format!("urdf = \"{}\"", "a/".repeat(100_000));
        expand_and_check(long.parse().unwrap(), item.parse().unwrap(), "a long path");
    });
}

#[test]
fn unusual_field_names_are_preserved() {
    run_with_little_stack(|| {
        for name in [
            "r#type",
            "r#match",
            "größe",
            "ħ",
            "变量",
            "q",
            "q0",
            "t0",
            "t1",
            "v",
            "u",
            "tau",
            "a",
            "constant",
            "zero",
            "mul_add",
            "NQ",
            "neutral",
            "missing",
            "_",
            "__link0",
            "e1",
            "f64",
            "Self_",
            "union",
            "auto",
            "macro_rules",
        ] {
            for item in [
                format!(
                    "struct S {{ {name}: f64, #[body(mass = {name})] b: Body, \
                     #[joint(ground -> b, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct S {{ #[body(mass = 1)] {name}: Body, \
                     #[joint(ground -> {name}, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] {name}: Sleeve, \
                     #[acts(on = {name})] f: Force }}"
                ),
                format!(
                    "struct S<{name}> {{ m: {name}, #[body(mass = m)] b: Body, \
                     #[joint(ground -> b, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct {name} {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve \
                     }}"
                ),
            ] {
                if let Ok(tokens) = item.parse() {
                    expand_and_check(TokenStream::new(), tokens, &item);
                }
            }
        }
    });
}
