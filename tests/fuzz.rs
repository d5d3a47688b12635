//! Mistreated mechanisms: whatever the tokens are, the compiler does not panic, its output is Rust, and neither time
//! nor stack are without bound. Seeded, so that a failure comes again.

use linkwork_compiler::expand;
use proc_macro2::{Delimiter, Group, TokenStream, TokenTree};
use std::path::Path;
use std::time::{Duration, Instant};

/// Stack of the thread that expands: a fourth of what rustc has.
const STACK: usize = 2 << 20;
/// Longest time that one expansion may take in a debug build, on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Mechanisms to begin with: the whole language, and what is yet to come.
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

/// Words to put where they do not belong.
const WORDS: &str = "f64 f32 T self crate super Self ground x y z t pi q v 0 1 2 1e999 1e-999 -1 0.5 99999999999999999999 \
    1u8 2.5f32 'a' \"text\" b\"x\" Body Particle Pin Sleeve Screw Collar Slot Universal Ball Planar Stage Free Weld Spring \
    Dashpot Force Torque Inerter Coordinate Vec mass com inertia about along on at rotated pitch lead damping stiffness \
    massive between value urdf lock + - * / = -> <- => , ; : :: . .. ..= < > ! ? & | ^ % # @ $ ~ == <= && << += 'a \
    r#type größe sin cos sqrt ln acos pow atan2 dot cross norm unit rod sphere diagonal box pub struct enum fn where impl dyn for \
    if match loop _ __link0 () [] {} (x) [1,2,3] {a}";

/// SplitMix64.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.next() % n.max(1) as u64) as usize
    }
}

/// Arguments and item of a mechanism of the list.
fn split(text: &str) -> (TokenStream, TokenStream) {
    let (arguments, item) = text.split_once(';').unwrap();
    (arguments.parse().unwrap(), item.parse().unwrap())
}

/// One small change somewhere in a stream.
fn mutate(tokens: TokenStream, words: &[TokenTree], random: &mut Random) -> TokenStream {
    let mut list: Vec<TokenTree> = tokens.into_iter().collect();
    let groups: Vec<usize> = (0..list.len()).filter(|k| matches!(list[*k], TokenTree::Group(_))).collect();
    // Most of the words are inside groups.
    if !groups.is_empty() && random.below(5) > 0 {
        let at = groups[random.below(groups.len())];
        if let TokenTree::Group(group) = &list[at] {
            let mut inside = Group::new(group.delimiter(), mutate(group.stream(), words, random));
            inside.set_span(group.span());
            list[at] = inside.into();
        }
        return list.into_iter().collect();
    }
    let (at, other) = (random.below(list.len()), random.below(list.len()));
    let word = words[random.below(words.len())].clone();
    match random.below(8) {
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
            list.insert(first, Group::new(delimiter[random.below(4)], part).into());
        }
        _ => {
            let end = (at + 1 + random.below(8)).min(list.len());
            let part: Vec<TokenTree> = list[at..end].to_vec();
            list.splice(at..at, part);
        }
    }
    list.into_iter().collect()
}

/// Expands and looks at the output. The text is what a failure is reported with.
fn try_expand(arguments: TokenStream, item: TokenStream, text: &str) {
    let start = Instant::now();
    let output = expand(arguments, item, Path::new("ui"));
    let output = format!("{} {}", output.tokens, output.text);
    let time = start.elapsed();
    assert!(time < PATIENCE, "{time:?} for {text}");
    let file = output.parse::<TokenStream>().map_err(|e| e.to_string());
    let file = file.and_then(|tokens| syn::parse2::<syn::File>(tokens).map_err(|e| e.to_string()));
    assert!(file.is_ok(), "{} of {text}\ngave {output}", file.err().unwrap_or_default());
    if !output.contains("compile_error") {
        let odd = |word: &str| matches!(word.trim_matches(['(', ')', ',', '-']), "inf" | "NaN");
        assert!(!output.split_whitespace().any(odd), "a number that is none, of {text}");
    }
}

/// Runs with little stack.
fn with_little_stack(run: impl FnOnce() + Send + 'static) {
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(run).unwrap();
    if let Err(panic) = thread.join() {
        std::panic::resume_unwind(panic);
    }
}

#[test]
fn mutations_neither_panic_nor_break_the_output() {
    with_little_stack(|| {
        let words: Vec<TokenTree> =
            WORDS.split(' ').flat_map(|w| w.parse::<TokenStream>().ok()).flatten().collect();
        let mut random = Random(1);
        for round in 0..1500 {
            let (mut arguments, mut item) = split(MECHANISMS[round % MECHANISMS.len()]);
            for _ in 0..=random.below(4) {
                if random.below(8) == 0 {
                    arguments = mutate(arguments, &words, &mut random);
                } else {
                    item = mutate(item, &words, &mut random);
                }
            }
            let text = format!("round {round}: #[mechanism({arguments})] {item}");
            try_expand(arguments, item, &text);
        }
    });
}

#[test]
fn words_at_random_are_refused() {
    with_little_stack(|| {
        let words: Vec<&str> = WORDS.split(' ').collect();
        let mut random = Random(2);
        for _ in 0..3000 {
            let count = random.below(24);
            let inside: String =
                (0..count).map(|_| words[random.below(words.len())].to_string() + " ").collect();
            let item = match random.below(4) {
                0 => inside.clone(),
                1 => format!("struct S {{ {inside} }}"),
                2 => format!(
                    "struct S {{ m: f64, #[body({inside})] b: Body, #[joint(ground -> b, about = z)] j: Pin }}"
                ),
                _ => format!("struct S {{ #[body(mass = {inside})] b: Body, #[joint({inside})] j: Pin }}"),
            };
            if let (Ok(arguments), Ok(item)) = (inside.parse(), item.parse()) {
                try_expand(arguments, item, &inside);
            }
        }
    });
}

/// Fields for a chain of bodies on pins.
fn chain(n: usize, kind: &str) -> String {
    let mut text = String::new();
    for k in 0..n {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(0.5 * x)", k - 1) };
        let axis = match kind {
            "Pin" => [", about = z", ", about = y", ", about = x"][k % 3],
            "Sleeve" => [", along = x", ", along = y", ", along = z"][k % 3],
            _ => "",
        };
        text += &format!(
            "#[body(mass = 1, com = 0.1 * y, inertia = sphere(1, 1))] b{k}: Body, #[joint({parent} -> b{k}{axis})] j{k}: {kind},\n"
        );
    }
    text
}

fn list(n: usize, item: impl Fn(usize) -> String) -> String {
    (0..n).map(item).collect()
}

/// A planar chain of pins that is tied to the ground by others, so many of each.
fn tied_chain(pins: usize, ties: usize) -> String {
    let bodies = list(pins, |k| {
        let parent = if k == 0 { "ground".to_string() } else { format!("b{}.at(x)", k - 1) };
        format!(
            "#[body(mass = 1, inertia = rod(1, 1, x))] b{k}: Body, #[joint({parent} -> b{k}, about = z)] j{k}: Pin,\n"
        )
    });
    let ends = list(ties, |k| {
        let (body, x, y) = ((2 * k + 3) % pins, (2 * k) % 7, k % 3);
        format!("#[joint(b{body}.at(x) -> ground.at({x} * x + {y} * y), about = z)] tie{k}: Pin,\n")
    });
    format!("struct S {{ {bodies} {ends} }}")
}

/// A mechanism with an expression somewhere.
fn with_mass(e: &str) -> String {
    format!("struct S {{ m: f64, #[body(mass = {e})] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}")
}

fn with_com(e: &str) -> String {
    format!(
        "struct S {{ m: f64, #[body(mass = 1, com = {e})] b: Body, #[joint(ground -> b, about = unit(x + y + z))] j: Pin }}"
    )
}

fn with_inertia(e: &str) -> String {
    format!(
        "struct S {{ m: f64, #[body(mass = 1, inertia = {e})] b: Body, #[joint(ground -> b, about = z)] j: Pin }}"
    )
}

#[test]
fn great_numbers_of_things_end() {
    let cases: Vec<(&str, String)> = vec![
        ("deep parentheses", with_mass(&("(".repeat(100_000) + "m" + &")".repeat(100_000)))),
        ("deep brackets", with_mass(&("[".repeat(10_000) + "m" + &"]".repeat(10_000)))),
        ("deep braces", "{".repeat(10_000) + &"}".repeat(10_000)),
        ("deep calls", with_mass(&("sin(".repeat(10_000) + "m" + &")".repeat(10_000)))),
        ("parentheses just below the limit", with_mass(&("(".repeat(40) + "m" + &")".repeat(40)))),
        ("minus signs", with_mass(&("-".repeat(100_000) + "m"))),
        ("minus signs with spaces", with_mass(&("- ".repeat(40) + "m"))),
        ("a sum", with_mass(&vec!["m"; 10_000].join(" + "))),
        ("a sum just below the limit", with_mass(&vec!["m"; 390].join(" + "))),
        ("a product", with_mass(&vec!["m"; 10_000].join(" * "))),
        ("a product just below the limit", with_mass(&vec!["m"; 390].join(" * "))),
        ("quotients", with_mass(&vec!["m"; 390].join(" / "))),
        ("members", with_mass(&("m".to_string() + &".m".repeat(10_000)))),
        ("members just below the limit", with_mass(&("m".to_string() + &".m".repeat(390)))),
        ("rotations", with_inertia(&("rod(1, 1, x)".to_string() + &".rotated(z(m))".repeat(390)))),
        ("rotations of an end", {
            let end = "ground".to_string() + &".rotated(x(m), y(m))".repeat(190);
            format!(
                "struct S {{ m: f64, #[body(mass = 1)] b: Body, #[joint({end} -> b, along = x)] j: Sleeve }}"
            )
        }),
        ("inertias", with_inertia(&vec!["sphere(m, 1)"; 390].join(" + "))),
        ("parameters", format!("struct S {{ {} }}", list(10_000, |k| format!("p{k}: f64,")))),
        ("parameters in use", {
            let sum = list(190, |k| format!("+ p{k}"));
            format!(
                "struct S {{ {} #[body(mass = 1 {sum})] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}",
                list(190, |k| format!("p{k}: f64,"))
            )
        }),
        ("parameters of one name", format!("struct S {{ {} }}", "p: f64,".repeat(10_000))),
        ("unknown things", format!("struct S {{ {} }}", list(10_000, |k| format!("p{k}: Thing,")))),
        ("bodies", format!("struct S {{ {} }}", list(10_000, |k| format!("#[body(mass = 1)] b{k}: Body,")))),
        ("particles", {
            let all = list(200, |k| format!("#[particle(mass = 1, at = b.at({k} * x))] p{k}: Particle,"));
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("joints of one body", {
            let all = list(5_000, |k| format!("#[joint(ground -> b, along = x)] j{k}: Sleeve,"));
            format!("struct S {{ #[body(mass = 1)] b: Body, {all} }}")
        }),
        ("force elements", {
            let all = list(2_000, |k| format!("#[acts(on = j, damping = {k})] d{k}: Dashpot,"));
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("inputs", {
            let all = list(500, |k| format!("#[acts(on = b.at({k} * y), along = x)] f{k}: Force,"));
            format!(
                "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve, {all} }}"
            )
        }),
        ("arguments", with_mass(&list(10_000, |k| format!("1, a{k} = 1,")))),
        ("attributes", format!("struct S {{ {} b: Body }}", "#[body(mass = 1)]".repeat(10_000))),
        ("a long chain", format!("struct S {{ {} }}", chain(2_000, "Pin"))),
        ("a long chain of welds", format!("struct S {{ {} }}", chain(1_000, "Weld"))),
        (
            "a chain of welds on a pin",
            format!(
                "struct S {{ {} {} }}",
                chain(1, "Pin"),
                chain(900, "Weld").replace("b0: Body", "c0: Body").replace("ground ->", "b0 ->")
            ),
        ),
        ("a chain tied to the ground", tied_chain(85, 41)),
        ("a chain tied to the ground a few times", tied_chain(40, 4)),
        ("a chain tied to the ground everywhere", tied_chain(100, 50)),
        ("a chain tied to the ground too often", tied_chain(20, 100)),
        ("a chain of sleeves", format!("struct S {{ {} }}", chain(40, "Sleeve"))),
        ("long generics", format!("struct S<{}> {{}}", list(10_000, |k| format!("T{k},")))),
        ("deep types", format!("struct S {{ a: {}f64{} }}", "Vec<".repeat(10_000), ">".repeat(10_000))),
        ("references", format!("struct S {{ a: {}f64 }}", "&".repeat(10_000))),
        ("long names", with_mass(&"m".repeat(100_000))),
        ("a long number", with_mass(&"9".repeat(100_000))),
    ];
    run_cases(cases);
}

#[test]
fn too_many_loops_are_refused_with_a_reason() {
    for (pins, ties, reason) in [
        (20, 100, "500 scalar constraints, more than 256"),
        (85, 41, "the constraints of this mechanism depend on each other too much"),
    ] {
        let output = expand(TokenStream::new(), tied_chain(pins, ties).parse().unwrap(), Path::new("ui"));
        let output = format!("{} {}", output.tokens, output.text);
        assert!(output.contains(reason), "{pins} pins with {ties} ties: {:.2000}", output);
    }
}

#[test]
fn sharing_does_not_explode() {
    let nest =
        |f: &dyn Fn(String) -> String, start: &str, n: usize| (0..n).fold(start.to_string(), |e, _| f(e));
    let cases: Vec<(&str, String)> = vec![
        ("cross products on the left", with_com(&nest(&|e| format!("cross({e}, [1, m, 2])"), "[m, 1, 2]", 38))),
        ("cross products on the right", with_com(&nest(&|e| format!("cross([1, m, 2], {e})"), "[m, 1, 2]", 38))),
        ("cross products of two", with_com(&nest(&|e| format!("cross({e}, {e} + [1, m, 2])"), "[m, 1, 2]", 9))),
        ("powers of powers", with_mass(&nest(&|e| format!("pow({e}, 8)"), "(1 + m)", 40))),
        ("powers of sums", with_mass(&nest(&|e| format!("pow(1 + {e}, 4)"), "m", 40))),
        ("powers of numbers", with_mass(&nest(&|e| format!("pow({e}, 8)"), "2", 40))),
        ("sines of sines", with_mass(&nest(&|e| format!("(2 + sin({e}))"), "m", 22))),
        ("lengths of lengths", with_mass(&nest(&|e| format!("norm([{e}, m, 1])"), "m", 22))),
        ("quotients of quotients", with_mass(&nest(&|e| format!("(1 / (1 + {e}))"), "m", 22))),
        ("extremes of extremes", with_mass(&nest(&|e| format!("max(min({e}, m), {e})"), "m", 9))),
        ("unit vectors of unit vectors", with_com(&nest(&|e| format!("unit({e} + [1, m, 2])"), "[m, 1, 2]", 40))),
        ("large numbers", with_mass("1e308 * m * 1e308")),
        ("small numbers", with_mass("1e-308 * m * 1e-308")),
        ("a number that is zero", with_mass("m + 1e-999")),
        ("large figures", "struct S { #[body(mass = 1e300, com = 1e300 * y)] b: Body, #[joint(ground -> b, about = z)] j: Pin }".into()),
        ("large figures of parameters", with_com("1e200 * m * x + 1e200 * y")),
        ("large springs", "struct S { #[body(mass = 1)] a: Body, #[joint(ground -> a, along = x)] i: Sleeve, #[acts(on = i, stiffness = 1e300, free_length = 1e300)] s: Spring }".into()),
        ("large inertias", with_inertia("diagonal(1e308, 1e308, 1e308) + diagonal(1e308, 1e308, 1e308)")),
        ("large solids", with_inertia("sphere(1e200, 1e200)")),
        ("large axes", "struct S { m: f64, #[body(mass = m, com = x)] b: Body, #[joint(ground -> b, about = unit(1e200 * x + 1e200 * y))] j: Pin }".into()),
        ("small axes", "struct S { m: f64, #[body(mass = m, com = x)] b: Body, #[joint(ground -> b, about = unit(1e-200 * x + 1e-200 * y))] j: Pin }".into()),
        ("large leads", "struct S { m: f64, #[body(mass = m, com = x)] b: Body, #[joint(ground -> b, about = z, pitch = 1e300)] j: Screw }".into()),
        ("large gravity", with_mass("m").replace("j: Sleeve", "j: Sleeve, #[joint(b -> c, along = 1e-300 * x)] k: Pin")),
        ("a sum of many parameters", sum_of_parameters(40, 250)),
    ];
    run_cases(cases);
}

/// A mass that is a sum of sums of parameters.
fn sum_of_parameters(sums: usize, terms: usize) -> String {
    let name = |k: usize, i: usize| format!("m{k}_{i}");
    let sum = |k: usize| (0..terms).map(|i| name(k, i)).collect::<Vec<_>>().join(" + ");
    let declared = |k: usize| (0..terms).map(|i| name(k, i) + ": f64, ").collect::<String>();
    let defined = |k: usize| format!("{} #[define({})] sum{k}: Scalar, ", declared(k), sum(k));
    let all = (0..sums).map(|k| format!("sum{k}")).collect::<Vec<_>>().join(" + ");
    let fields: String = (0..sums).map(defined).collect();
    with_mass(&all).replace("m: f64, ", &fields)
}

fn run_cases(cases: Vec<(&'static str, String)>) {
    for (name, item) in cases {
        let run = move || {
            let start = Instant::now();
            let tokens = item.parse().unwrap_or_else(|_| panic!("{name} are no tokens"));
            try_expand(TokenStream::new(), tokens, name);
            println!("{:>8.2?} {name}", start.elapsed());
        };
        with_little_stack(run);
    }
}

#[test]
fn arguments_of_any_kind_are_read() {
    with_little_stack(|| {
        let item = with_mass("m");
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
            try_expand(arguments.parse().unwrap(), item.parse().unwrap(), arguments);
        }
        let long = format!("urdf = \"{}\"", "a/".repeat(100_000));
        try_expand(long.parse().unwrap(), item.parse().unwrap(), "a long path");
    });
}

#[test]
fn names_of_any_kind_are_kept() {
    with_little_stack(|| {
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
                    "struct S {{ {name}: f64, #[body(mass = {name})] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct S {{ #[body(mass = 1)] {name}: Body, #[joint(ground -> {name}, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct S {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] {name}: Sleeve, #[acts(on = {name})] f: Force }}"
                ),
                format!(
                    "struct S<{name}> {{ m: {name}, #[body(mass = m)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}"
                ),
                format!(
                    "struct {name} {{ #[body(mass = 1)] b: Body, #[joint(ground -> b, along = x)] j: Sleeve }}"
                ),
            ] {
                if let Ok(tokens) = item.parse() {
                    try_expand(TokenStream::new(), tokens, &item);
                }
            }
        }
    });
}
